# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What stands before the Ruler while its pictures are drawn: recordings, a server, simulated robots."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path

TESTUDO = [sys.executable, "-m", "smarttestudo"]
ROS = {
    **os.environ,
    "ROS_DOMAIN_ID": "88",
    "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    "PYTHONUNBUFFERED": "1",
}
LINKED, ALONE = "tcp/127.0.0.1:7457", "tcp/127.0.0.1:7458"
"""Where an operator's end listens, and where none does."""
LISTEN = """
import contextlib, importlib, sys, rclpy, rclpy.executors
rclpy.init()
node = rclpy.create_node("operator")
for topic, kind in zip(sys.argv[1::2], sys.argv[2::2]):
    package, name = kind.split("/msg/")
    message = getattr(importlib.import_module(package + ".msg"), name)
    node.create_subscription(message, topic, lambda _: None, 10)
with contextlib.suppress(rclpy.executors.ExternalShutdownException):
    rclpy.spin(node)
"""
HEARD = {
    "/testudo/odom": "nav_msgs/msg/Odometry",
    "/testudo/cmd_vel": "geometry_msgs/msg/Twist",
    "/testudo/scan": "sensor_msgs/msg/LaserScan",
    "/testudo/camera/camera_info": "sensor_msgs/msg/CameraInfo",
    "/testudo/imu": "sensor_msgs/msg/Imu",
}


def record(folder: Path, settings: Mapping[str, str], *options: str) -> None:
    """Drive the demo's mission once."""
    demo = [*TESTUDO, "demo", "--out", str(folder), *options]
    subprocess.run(demo, check=True, stdout=subprocess.DEVNULL, env=settings)


@contextmanager
def running(command: list[str], settings: Mapping[str, str]) -> Iterator[subprocess.Popen[str]]:
    """A process that ends with the block."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=settings) as process:
        try:
            yield process
        finally:
            process.terminate()


@contextmanager
def served(project: Path, settings: Mapping[str, str]) -> Iterator[str]:
    """``testudo ruler`` on a folder; yields its address."""
    command = [*TESTUDO, "ruler", str(project), "--port", "0", "--no-browser"]
    with running(command, settings) as server:
        assert server.stdout is not None
        yield server.stdout.readline().split(": ", 1)[1].split()[0]


@contextmanager
def robot_running(rules: str, settings: Mapping[str, str]) -> Iterator[None]:
    """The simulated robot, a run that follows ``rules``, and an operator."""
    names = [word for pair in HEARD.items() for word in pair]
    with ExitStack() as stack:
        for command in (
            [*TESTUDO, "run", "--rules", rules, "--budget", "400"],
            [*TESTUDO, "simulate"],
            [sys.executable, "-c", LISTEN, *names],
        ):
            stack.enter_context(running(command, settings))
        yield


@contextmanager
def robots_running(rules: str, settings: Mapping[str, str]) -> Iterator[subprocess.Popen[str]]:
    """Three runs beside one simulated robot, of which two have a link; yields the one that has none."""
    run = [*TESTUDO, "run", "--rules", rules]
    names = [["--ros-args", "-r", f"__ns:=/{name}"] for name in ("ada", "bob", "cleo")]
    with ExitStack() as stack:
        for command in (
            [*TESTUDO, "simulate"],
            [*TESTUDO, "receive", "--no-ros", "--openmetrics", "0", "--listen", LINKED],
            [*run, "--budget", "400", "--robot", "ada", "--link", LINKED, *names[0]],
            [*run, "--robot", "bob", "--link", ALONE, *names[1]],
        ):
            stack.enter_context(running(command, settings))
        yield stack.enter_context(running([*run, "--output-topic", "/cleo{topic}", *names[2]], settings))
