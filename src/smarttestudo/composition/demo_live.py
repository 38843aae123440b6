# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The demo in real time: robot and runtime are processes of their own, and this one records both."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from smarttestudo.adapters.rosbag.messages import RobotMessages
from smarttestudo.composition.child_process import ChildProcess, child_process
from smarttestudo.composition.demo_mission import DECLARED_BYTES
from smarttestudo.composition.live_decisions import DECISIONS_TOPIC
from smarttestudo.composition.live_recorder import recorded
from smarttestudo.composition.monitored_topics import DEFAULT_OUTPUT_TOPIC
from smarttestudo.composition.replay_topics import output_name
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.units import NS_PER_S, ns_from_s
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.simulation.readings import Topic

_LOOK_S = 0.1
_START_TIMEOUT_S = 40.0


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveDemoRequest:
    """How long a mission, with which noise, under which rules, and where everything goes.

    Without ``full_images`` the robot has no raw camera.
    """

    baseline: Path
    adaptive: Path
    rules: Path
    decisions: Path
    logs: Path
    seconds: float
    seed: int
    full_images: bool
    when_slow: WhenSlow


def record_live(request: LiveDemoRequest, robot: Robot, report: Callable[[float], None]) -> tuple[str, ...]:
    """Let the robot drive under the runtime, and record both. What was left out, a line for each topic.

    Raises:
        TestudoError: one of the processes failed.
        RecordingError: a recording cannot be written.
    """
    channels, left_out = _channels(robot, full_images=request.full_images)
    declared_bytes = {} if request.full_images else DECLARED_BYTES
    with (
        recorded(robot, request.baseline, channels, declared_bytes),
        recorded(robot, request.adaptive, channels, declared_bytes, _monitored),
        child_process("runtime", _run_arguments(request), request.logs / "runtime.log") as runtime,
    ):
        _await_publisher(robot, DECISIONS_TOPIC, runtime)
        robot_log = request.logs / "robot.log"
        with child_process("simulated robot", _simulate_arguments(request), robot_log) as driver:
            _await_publisher(robot, Topic.ODOM.value, driver)
            end_ns = robot.now_ns() + ns_from_s(request.seconds)
            while (left_ns := end_ns - robot.now_ns()) > 0 and runtime.is_running() and driver.is_running():
                robot.wait(end_ns, _LOOK_S)
                report(1 - left_ns / NS_PER_S / request.seconds)
            # It ends before the robot does, which would be a change of plans of its own.
            runtime.end()
    return left_out


def _channels(robot: Robot, *, full_images: bool) -> tuple[list[Channel], tuple[str, ...]]:
    """The topics that the robot will publish, and why it will not publish the others."""
    channels, left_out = [], []
    for topic, channel in RobotMessages().channels.items():
        if topic is Topic.IMAGE and not full_images:
            left_out.append(f"{topic.value}: off without --full-images")
        elif not robot.data_path.knows(channel.type_name):
            left_out.append(f"{topic.value}: the message type {channel.type_name} is not installed")
        else:
            channels.append(channel)
    return channels, tuple(left_out)


def _await_publisher(robot: Robot, topic: str, process: ChildProcess) -> None:
    deadline_ns = robot.now_ns() + ns_from_s(_START_TIMEOUT_S)
    while not robot.publishers(topic):
        if not process.is_running() or robot.now_ns() > deadline_ns:
            raise RosError(f"nobody published {topic}", remedy="try again with another ROS_DOMAIN_ID")
        robot.wait(None, _LOOK_S)


def _monitored(topic: str) -> str:
    return output_name(topic, DEFAULT_OUTPUT_TOPIC)


def _run_arguments(request: LiveDemoRequest) -> list[str]:
    return [
        "run",
        *("--rules", str(request.rules)),
        *("--decisions", str(request.decisions)),
        *("--when-slow", request.when_slow.value),
    ]


def _simulate_arguments(request: LiveDemoRequest) -> list[str]:
    arguments = ["simulate", "--seed", str(request.seed)]
    return [*arguments, "--full-images"] if request.full_images else arguments
