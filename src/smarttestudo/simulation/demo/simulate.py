# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The simulated robot on a real ROS graph, in real time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from smarttestudo.domain.robot import Publisher, Robot
from smarttestudo.domain.units import ns_from_s
from smarttestudo.simulation.camera import FrameSize
from smarttestudo.simulation.demo.lost_time import LostTime
from smarttestudo.simulation.demo.mission import JPEG_BYTES, route_of
from smarttestudo.simulation.messages.messages import RobotMessages, qos_of
from smarttestudo.simulation.mission import MissionRequest, drive_mission
from smarttestudo.simulation.readings import TimedReading, Topic
from smarttestudo.simulation.warehouse import warehouse

_LONGEST_WAIT_S = 0.2


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulateRequest:
    """How long the robot drives (``None``: until stopped), and with which noise.

    Only with full ``frames`` it has a raw camera. ``mission`` is the file of a tour, ``None`` the patrol.
    """

    seconds: float | None
    seed: int
    frames: FrameSize
    mission: Path | None = None


def simulate(request: SimulateRequest, robot: Robot, stopped: Callable[[], bool]) -> None:
    """Publish what the robot's devices say, each reading when its time comes, until it drove or ``stopped``.

    Topics whose message type is not installed are left out and named in the log.

    Raises:
        MissionError: the mission cannot be read or driven.
    """
    route = route_of(request.mission)
    messages = RobotMessages(jpeg_bytes=JPEG_BYTES[request.frames])
    publishers = advertise(robot, messages, request.frames)
    start_ns = robot.now_ns()
    end_ns = None if request.seconds is None else start_ns + ns_from_s(request.seconds)
    drive = "patrol" if request.mission is None else "mission"
    robot.log.info(f"Driving the {drive} with {len(publishers)} topics{left_out(robot, messages)}")
    mission = drive_mission(
        MissionRequest(
            plan=warehouse(), route=route, seed=request.seed, start_ns=start_ns, frames=request.frames
        )
    )
    lost = LostTime(robot, mission.skip, "this machine slept, or is too slow for the camera")
    for timed in mission:
        lost.give_up(timed)
        if (end_ns is not None and timed.time_ns >= end_ns) or not _await(timed, robot, stopped):
            return
        publisher = publishers.get(timed.topic)
        if publisher is not None:
            publisher.publish(messages.payload(timed.topic, timed.reading))


def _await(timed: TimedReading, robot: Robot, stopped: Callable[[], bool]) -> bool:
    """Wait for the reading's time; whether to go on."""
    while robot.now_ns() < timed.time_ns and not stopped():
        robot.wait(timed.time_ns, _LONGEST_WAIT_S)
    return not stopped()


def advertise(robot: Robot, messages: RobotMessages, frames: FrameSize) -> Mapping[Topic, Publisher]:
    """Publishers of all topics whose type is installed; only with full ``frames`` the raw image's."""
    publishers = {}
    for topic, channel in messages.channels.items():
        if topic is Topic.IMAGE and frames is not FrameSize.FULL:
            continue
        if robot.data_path.knows(channel.type_name):
            publishers[topic] = robot.data_path.advertise(topic.value, channel.type_name, qos_of(topic))
    return publishers


def left_out(robot: Robot, messages: RobotMessages) -> str:
    """Which topics lack their type, as the end of a sentence.

    Nobody who asks for a robot asked for every one of its topics, so this is no warning.
    """
    missing = {
        topic.value: channel.type_name
        for topic, channel in messages.channels.items()
        if not robot.data_path.knows(channel.type_name)
    }
    if not missing:
        return ""
    return f", without {', '.join(missing)} ({', '.join(sorted(set(missing.values())))} is not installed)"
