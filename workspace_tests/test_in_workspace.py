# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The package as a workspace has it, by `colcon test`: with rclpy, pytest and the standard library only."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

# rclpy is imported with warnings of its own.
pytestmark = pytest.mark.filterwarnings("default")
PACKAGE = "smarttestudo"
RULES = "begin SetFrequency /chatter 5 end\n"
RELAYED = 10
WITHIN_S = 60.0
DOMAIN = 1 + os.getpid() % 100


def prefix() -> Path:
    """Where the workspace has installed the package."""
    prefixes = map(Path, os.environ["AMENT_PREFIX_PATH"].split(os.pathsep))
    marker = Path("share", "ament_index", "resource_index", "packages", PACKAGE)
    return next(one for one in prefixes if (one / marker).is_file())


def executable(name: str) -> str:
    """What `ros2 run smarttestudo NAME` starts."""
    return str(prefix() / "lib" / PACKAGE / name)


@pytest.fixture
def ros(monkeypatch: pytest.MonkeyPatch) -> Iterator[Node]:
    """A node in a domain of this run, which no other machine hears."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    if os.environ.get("ROS_DISTRO") == "humble":
        monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    context = Context()
    rclpy.init(context=context)
    node = Node("workspace_tests", context=context)
    yield node
    node.destroy_node()
    rclpy.try_shutdown(context=context)


def test_a_shared_example_is_checked_without_an_error() -> None:
    rules = prefix() / "share" / PACKAGE / "examples" / "warehouse.adirf"
    done = subprocess.run(
        [executable("testudo"), "check", str(rules)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_topic_is_relayed_at_the_rate_of_its_rule(ros: Node, tmp_path: Path) -> None:
    rules = tmp_path / "rules.adirf"
    rules.write_text(RULES, encoding="utf-8")
    came_s: list[float] = []
    publisher = ros.create_publisher(String, "/chatter", 10)
    ros.create_timer(0.02, lambda: publisher.publish(String(data="hello")))
    ros.create_subscription(String, "/testudo/chatter", lambda _: came_s.append(time.monotonic()), 10)
    executor = SingleThreadedExecutor(context=ros.context)
    executor.add_node(ros)
    with subprocess.Popen([executable("smart_testudo"), "--rules", str(rules)]) as runtime:
        try:
            end_s = time.monotonic() + WITHIN_S
            while len(came_s) < RELAYED and time.monotonic() < end_s:
                executor.spin_once(timeout_sec=0.1)
        finally:
            runtime.terminate()
    assert len(came_s) == RELAYED
    # Of 50 a second; what the machine delays comes together.
    assert came_s[-1] - came_s[0] > (RELAYED - 1) / 5 / 2
