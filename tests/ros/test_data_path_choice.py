# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""librcl where it works, rclpy where it does not, and the log says why."""

from __future__ import annotations

import ctypes
import importlib.util
import struct

import pytest

from ros.ros_processes import SmallRobot
from smarttestudo.adapters.ros import open_robot
from smarttestudo.adapters.ros.message_info import InfoLayout
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import DataPathKind

# An old lark, which rclpy imports, uses a module of Python that is deprecated.
pytestmark = pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning")

GID = bytes(range(1, 17))
IMU = {"type": "sensor_msgs/msg/Imu"}


@pytest.fixture
def without_librcl(domain: int, monkeypatch: pytest.MonkeyPatch) -> None:
    if importlib.util.find_spec("rclpy") is None:
        pytest.skip("ROS 2 (rclpy) is not installed")
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")

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
        assert not path.tells_publishers
        assert not path.can_rest


@pytest.mark.usefixtures("without_librcl")
def test_librcl_is_an_error_where_it_was_asked_for_and_cannot_be_used() -> None:
    with (
        open_robot(data_path=DataPathKind.RCL) as robot,
        pytest.raises(RosError, match="librcl cannot be used directly"),
    ):
        _ = robot.data_path


def test_a_run_through_rclpy_relays_too(robot: SmallRobot) -> None:
    operator = robot.operator(imu=IMU)
    runtime = robot.runtime("begin SetFrequency /imu 10 end", "--data-path", "rclpy")
    robot.source(imu={**IMU, "hz": 100})
    runtime.line_with("Data path: rclpy, as asked for")
    operator.line_with("heard")


def raw_info(number: int, gid: bytes) -> bytes:
    return struct.pack("=qqQQQ", 1, 2, number, 2**64 - 1, 0) + gid + bytes(100)


def test_the_info_of_a_message_is_used_only_where_it_holds_what_it_should() -> None:
    assert InfoLayout.found_in(raw_info(1, GID), GID) == InfoLayout(gid_bytes=16, is_numbered=True)
    unnumbered = InfoLayout(gid_bytes=16, is_numbered=False)
    assert InfoLayout.found_in(raw_info(2**64 - 1, GID), GID) == unnumbered
    nothing = InfoLayout(gid_bytes=0, is_numbered=False)
    assert InfoLayout.found_in(raw_info(1, GID[::-1]), GID) == nothing
    assert InfoLayout.found_in(bytes(256), b"") == nothing
