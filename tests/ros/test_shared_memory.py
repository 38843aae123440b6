# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A run has room for images in its shared memory, however nodes find each other, unless a user decides."""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy")

from ros.ros_processes import Process, SmallRobot
from smarttestudo.robot.ros.shared_memory import (
    PROFILE,
    PROFILES_FILE,
    PROFILES_FILE_BEFORE_KILTED,
    SEGMENT_BYTES,
)

pytestmark = pytest.mark.skipif(
    not os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").startswith("rmw_fastrtps"),
    reason="this is about Fast DDS",
)
TEXT = "std_msgs/msg/String"
RULES = "begin SetFrequency /text Full end"
MAPPED = re.compile(r"^([0-9a-f]+)-([0-9a-f]+) rw\S* .* /dev/shm/fast(?:dds|rtps)_[0-9a-f]+$", re.MULTILINE)
RANGES = ("LOCALHOST", "SUBNET", "SYSTEM_DEFAULT")
SERVER = """import rclpy, sys
rclpy.init()
node = rclpy.create_node("server")
print("ready", flush=True)
sys.stdin.readline()
"""
SERVER_PROFILE = """<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com">
  <participant profile_name="server" is_default_profile="true"><rtps>
    <prefix>44.53.00.5f.45.50.52.4f.53.49.4d.41</prefix>
    <builtin>
      <discovery_config><discoveryProtocol>SERVER</discoveryProtocol></discovery_config>
      <metatrafficUnicastLocatorList><locator><udpv4>
        <address>127.0.0.1</address><port>PORT</port>
      </udpv4></locator></metatrafficUnicastLocatorList>
    </builtin>
  </rtps></participant>
</profiles>
"""


def has_mapped(process: Process, size_bytes: int) -> bool:
    """Whether it maps shared memory of Fast DDS of that size, beside what tells its parts apart."""
    maps = Path(f"/proc/{process.pid}/maps").read_text(encoding="utf-8")
    sizes = [int(end, 16) - int(begin, 16) for begin, end in MAPPED.findall(maps)]
    return any(size_bytes <= one < 1.2 * size_bytes for one in sizes)


def profile_of(robot: SmallRobot, text: str) -> dict[str, str]:
    """Variables that name a profile."""
    path = robot.folder / "profile.xml"
    path.write_text(text, encoding="utf-8")
    return {PROFILES_FILE: str(path), PROFILES_FILE_BEFORE_KILTED: str(path)}


def serve_discovery(robot: SmallRobot, domain: int) -> dict[str, str]:
    """Start a server by which nodes find each other; the variables of those."""
    profile = profile_of(robot, SERVER_PROFILE.replace("PORT", str(20_000 + domain)))
    is_subnet = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}
    robot.command(sys.executable, "-c", SERVER, **is_subnet, **profile).line_with("ready")
    return {**is_subnet, "ROS_DISCOVERY_SERVER": f"127.0.0.1:{20_000 + domain}", "ROS_SUPER_CLIENT": "TRUE"}


@pytest.mark.parametrize("found_by", [*RANGES, "peers", "server"])
def test_a_run_has_room_for_images_however_nodes_find_each_other(
    robot: SmallRobot, domain: int, found_by: str
) -> None:
    variables = {"ROS_AUTOMATIC_DISCOVERY_RANGE": found_by}
    if found_by == "peers":
        variables = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET", "ROS_STATIC_PEERS": "127.0.0.1"}
    elif found_by == "server":
        variables = serve_discovery(robot, domain)
    nodes = SmallRobot(domain, robot.folder, variables=variables)
    try:
        runtime = nodes.runtime(RULES)
        nodes.source(text={"type": TEXT, "hz": 20})
        nodes.operator(text={"type": TEXT}).line_with("heard")
        assert has_mapped(runtime, SEGMENT_BYTES)
    finally:
        nodes.end()


def test_a_profile_of_the_user_s_own_is_what_a_run_has(robot: SmallRobot, domain: int) -> None:
    size_bytes = 3_000_000
    text = PROFILE.read_text(encoding="utf-8").replace(str(SEGMENT_BYTES), str(size_bytes))
    nodes = SmallRobot(domain, robot.folder, variables=profile_of(robot, text))
    try:
        runtime = nodes.runtime(RULES)
        runtime.line_with("Data path")
        assert has_mapped(runtime, size_bytes)
        assert not has_mapped(runtime, SEGMENT_BYTES)
    finally:
        nodes.end()


def test_a_camera_without_room_is_named_with_what_to_set_and_loses_nothing_with_that(
    robot: SmallRobot, domain: int
) -> None:
    image = {"type": TEXT, "hz": 15, "reliable": False, "size_bytes": 921_600}
    runtime = robot.runtime(RULES)
    robot.operator(text={"type": TEXT})
    camera = robot.source(text=image)
    said = runtime.line_with("lost ")
    setting = re.search(r"start /source with (\w+)=(\S+)", said)
    assert setting is not None, said
    losing = robot.nodes_told(lambda nodes: any("loss" in topic_of(node) for node in nodes.values()))
    ((_, told),) = losing.items()
    topic = topic_of(told)
    assert setting[0] in topic["loss"]["remedy"]
    assert topic["source_hz"] is None or topic["source_hz"] > 12
    camera.end()
    nodes = SmallRobot(domain, robot.folder, variables={setting[1]: setting[2].strip("'")})
    try:
        nodes.source(text=image)
        robot.nodes_told(lambda nodes: all(is_whole(topic_of(node)) for node in nodes.values()))
    finally:
        nodes.end()


def topic_of(node: dict[str, Any]) -> dict[str, Any]:
    topic: dict[str, Any] = node["topics"]["/text"]
    return topic


def is_whole(topic: dict[str, Any]) -> bool:
    """Whether nothing of it is lost any more, for ten seconds."""
    return "loss" not in topic and topic["actual_hz"] is not None and topic["actual_hz"] > 14
