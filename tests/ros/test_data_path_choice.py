# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""librcl where it works, rclpy where it does not, and the log says why."""

from __future__ import annotations

import ctypes
import os
import struct
import sys
from pathlib import Path

import pytest

from ros.ros_processes import TESTUDO, SmallRobot
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import DataPathKind
from smarttestudo.robot.ros import open_robot
from smarttestudo.robot.ros.rcl import relay_library
from smarttestudo.robot.ros.rcl.bindings import InfoLayout

GID = bytes(range(1, 17))
IMU = {"type": "sensor_msgs/msg/Imu"}
IMAGE = {"type": "sensor_msgs/msg/CompressedImage"}


@pytest.fixture
def without_librcl(in_domain: None, monkeypatch: pytest.MonkeyPatch) -> None:

    def not_found(name: str, mode: int = 0) -> None:
        raise OSError(f"{name}: cannot open shared object file")

    monkeypatch.setattr(ctypes, "CDLL", not_found)


@pytest.mark.usefixtures("without_librcl")
def test_where_librcl_cannot_be_used_messages_go_through_rclpy_and_it_says_why() -> None:
    with open_robot() as robot:
        path = robot.data_path
        assert path.description.startswith(
            "rclpy, at a higher cost, because librcl cannot be used directly: librcl.so: cannot open"
        )
        assert not path.identifies_publishers
        assert not path.can_pause


@pytest.mark.usefixtures("without_librcl")
def test_librcl_is_an_error_where_it_was_asked_for_and_cannot_be_used() -> None:
    with (
        open_robot(data_path=DataPathKind.RCL) as robot,
        pytest.raises(RosError, match="librcl cannot be used directly"),
    ):
        _ = robot.data_path


@pytest.fixture
def without_compiler(in_domain: None, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(relay_library, "LIBRARY", tmp_path / "relay.so")


@pytest.mark.usefixtures("without_compiler")
def test_where_nothing_was_compiled_librcl_does_it_and_the_log_says_so_in_a_word() -> None:
    with open_robot() as robot:
        assert "no compiled relays" in robot.data_path.description
        assert robot.data_path.compiled is None


@pytest.mark.usefixtures("without_compiler")
def test_fast_is_an_error_where_nothing_was_compiled() -> None:
    with (
        open_robot(data_path=DataPathKind.FAST) as robot,
        pytest.raises(RosError, match=r"there are no compiled relays: .*relay\.so: cannot open"),
    ):
        _ = robot.data_path


@pytest.mark.contract
def test_a_run_through_rclpy_relays_too(robot: SmallRobot) -> None:
    operator = robot.operator(imu=IMU)
    runtime = robot.runtime("begin SetFrequency /imu 10 end", "--data-path", "rclpy")
    robot.source(imu={**IMU, "hz": 100})
    runtime.line_with("Data path: rclpy, as asked for")
    operator.line_with("heard")


@pytest.mark.parametrize(
    ("lack", "arguments", "path"),
    [
        ("event_handler", (), "librcl, publishers "),
        ("event_handler", ("--data-path", "rclpy"), "rclpy, as asked for"),
        ("pointer", (), "rclpy, at a higher cost, because this version of rclpy has a different interface: "),
        (
            "service_pointer",
            (),
            "rclpy, at a higher cost, because this version of rclpy has a different interface: ",
        ),
    ],
)
def test_an_rclpy_that_lacks_what_another_distribution_has_relays_too(
    robot: SmallRobot, lack: str, arguments: tuple[str, ...], path: str
) -> None:
    operator = robot.operator(imu=IMU)
    runtime = robot.runtime_lacking(lack, "begin SetFrequency /imu 10 end", *arguments)
    robot.source(imu={**IMU, "hz": 100})
    runtime.line_with(f"Data path: {path}")
    operator.line_with("heard")


@pytest.mark.parametrize("path", ["fast", "librcl", "rclpy"])
def test_images_that_cannot_be_taken_serialized_are_relayed_and_the_log_says_once_what_that_costs(
    robot: SmallRobot, path: str
) -> None:
    operator = robot.operator(camera=IMAGE, thumbnail=IMAGE, imu=IMU)
    rules = "begin SetFrequency /camera 10 SetFrequency /thumbnail 10 SetFrequency /imu 10 end"
    runtime = robot.runtime_lacking("serialized_bytes", rules, "--data-path", path)
    robot.source(camera={**IMAGE, "hz": 30}, thumbnail={**IMAGE, "hz": 30}, imu={**IMU, "hz": 30})
    operator.line_with("heard")
    warnings = [line for line in runtime.output if "decoded and serialized again" in line]
    assert len(warnings) == 1
    assert "their publishers not told apart, their losses not counted" in warnings[0]


def test_where_images_can_be_taken_serialized_they_are(robot: SmallRobot) -> None:
    operator = robot.operator(camera=IMAGE)
    runtime = robot.runtime("begin SetFrequency /camera 10 end")
    robot.source(camera={**IMAGE, "hz": 30})
    operator.line_with("heard")
    assert "decoded" not in "".join(runtime.output)


@pytest.mark.parametrize(
    ("type_name", "has_bytes"),
    [
        ("sensor_msgs/msg/CompressedImage", True),
        ("sensor_msgs/msg/PointCloud2", True),
        ("std_msgs/msg/UInt8MultiArray", True),
        ("sensor_msgs/msg/Imu", False),
        ("sensor_msgs/msg/JointState", False),
        ("no_msgs/msg/Such", False),
    ],
)
def test_types_with_a_sequence_of_bytes_are_known_by_their_fields(type_name: str, *, has_bytes: bool) -> None:
    from smarttestudo.robot.ros.message_types import has_byte_sequence  # noqa: PLC0415  needs rclpy

    assert has_byte_sequence(type_name) is has_bytes


def test_librcl_is_one_line_of_error_where_this_rclpy_does_not_lead_to_it(robot: SmallRobot) -> None:
    runtime = robot.runtime_lacking("pointer", "begin SetFrequency /imu 10 end", "--data-path", "librcl")
    assert runtime.exit_code() == 1
    assert runtime.output[-1].startswith("error: this version of rclpy has a different interface: ")
    assert "Traceback" not in "".join(runtime.output)


def a_prefix_with_fast_dds(folder: Path, version: str) -> Path:
    share = folder / "share" / "rmw_fastrtps_shared_cpp"
    share.mkdir(parents=True)
    (share / "package.xml").write_text(f"<package><version>{version}</version></package>", encoding="utf-8")
    return folder


@pytest.mark.parametrize(
    ("version", "path"),
    [("6.2.3", "rclpy, at a higher cost, because rmw_fastrtps 6.2.3 may block"), ("6.2.4", "librcl, ")],
)
def test_a_middleware_that_may_block_for_ever_is_not_asked_to_wake(
    robot: SmallRobot, tmp_path: Path, version: str, path: str
) -> None:
    if not os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").startswith("rmw_fastrtps"):
        pytest.skip("this is about Fast DDS")
    prefix = a_prefix_with_fast_dds(tmp_path / "installed", version)
    prefixes = os.pathsep.join(filter(None, (str(prefix), os.environ.get("AMENT_PREFIX_PATH"))))
    (tmp_path / "rules.adirf").write_text("begin SetFrequency /imu 10 end", encoding="utf-8")
    arguments = (sys.executable, "-c", TESTUDO, "run", "--rules", str(tmp_path / "rules.adirf"))
    runtime = robot.command(*arguments, AMENT_PREFIX_PATH=prefixes)
    runtime.line_with(f"Data path: {path}")


def raw_info(number: int, gid: bytes) -> bytes:
    return struct.pack("=qqQQQ", 1, 2, number, 2**64 - 1, 0) + gid + bytes(100)


def test_the_info_of_a_message_is_used_only_where_it_holds_what_it_should() -> None:
    assert InfoLayout.found_in(raw_info(1, GID), GID) == InfoLayout(gid_bytes=16, is_numbered=True)
    unnumbered = InfoLayout(gid_bytes=16, is_numbered=False)
    assert InfoLayout.found_in(raw_info(2**64 - 1, GID), GID) == unnumbered
    nothing = InfoLayout(gid_bytes=0, is_numbered=False)
    assert InfoLayout.found_in(raw_info(1, GID[::-1]), GID) == nothing
    assert InfoLayout.found_in(bytes(256), b"") == nothing
