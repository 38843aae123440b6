# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot with physics on a real ROS graph, in real time."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from smarttestudo.domain.robot import Payload, Publisher, Robot
from smarttestudo.domain.units import ns_from_s
from smarttestudo.simulation.camera import FrameSize
from smarttestudo.simulation.demo.lost_time import LostTime
from smarttestudo.simulation.demo.mission import JPEG_BYTES, route_of
from smarttestudo.simulation.demo.simulate import advertise, left_out
from smarttestudo.simulation.messages.messages import RobotMessages, qos_of
from smarttestudo.simulation.physics.drive import PhysicalRobot, PhysicsRequest, RobotKind, physical_robot
from smarttestudo.simulation.physics.teleop import Teleop
from smarttestudo.simulation.readings import TimedReading, Topic
from smarttestudo.simulation.warehouse import warehouse

_LONGEST_WAIT_S = 0.05
_REMEMBERED = 50
_RANGE = "sensor_msgs/msg/Range"
_CDR_HEADER = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatePhysicsRequest:
    """Which robot drives for how long (``None``: until stopped), and with which noise.

    ``mission`` is the file of a tour, ``None`` the patrol. With a ``teleop`` the keys that ``keys`` returns
    drive instead. After ``cover_s`` seconds something covers the LiDAR.
    """

    kind: RobotKind
    seconds: float | None
    seed: int
    frames: FrameSize
    battery_percent: float
    cover_s: float | None = None
    mission: Path | None = None
    teleop: Teleop | None = None
    keys: Callable[[], str] = str


def simulate_physics(request: SimulatePhysicsRequest, robot: Robot, stopped: Callable[[], bool]) -> None:
    """Publish what the robot's devices say in real time, and obey /cmd_vel, until it drove or ``stopped``.

    What is late by less than a second is caught up with, with the stamps of its time. More than that is lost:
    the robot stands still meanwhile, stamps go on with the node's clock, and the log says how much it was.

    Raises:
        MissingPackageError: MuJoCo is not installed.
        PhysicsError: it does not load.
        MissionError: the mission cannot be read or driven.
    """
    physics = PhysicsRequest(
        plan=warehouse(),
        route=route_of(request.mission),
        kind=request.kind,
        seed=request.seed,
        frames=request.frames,
        battery_percent=request.battery_percent,
        cover_s=request.cover_s,
        steer=None if request.teleop is None else request.teleop.command,
    )
    with physical_robot(physics) as physical:
        messages = RobotMessages(
            jpeg_bytes=JPEG_BYTES[request.frames],
            topics=physical.topics,
            has_range_variance=Topic.RANGE in physical.topics and "variance" in robot.definition(_RANGE),
        )
        publishers = advertise(robot, messages, request.frames)
        robot.log.info(_greeting(request, physical, robot, messages, publishers))
        with _heard_commands(robot, messages, physical) as published:
            drive = _RealTimeDrive(request, robot, physical, stopped)
            for timed in drive.due_readings():
                publisher = publishers.get(timed.topic)
                if publisher is not None:
                    payload = messages.payload(timed.topic, timed.reading)
                    if timed.topic is Topic.CMD_VEL:
                        published.append(payload[_CDR_HEADER:])
                    publisher.publish(payload)


class _RealTimeDrive:
    """Readings as their time comes."""

    def __init__(
        self,
        request: SimulatePhysicsRequest,
        robot: Robot,
        physical: PhysicalRobot,
        stopped: Callable[[], bool],
    ) -> None:
        self._request = request
        self._robot = robot
        self._physical = physical
        self._stopped = stopped
        self._lost = LostTime(robot, physical.skip, "this machine is too slow for its physics or its camera")

    def due_readings(self) -> Iterator[TimedReading]:
        """Yield each reading when it arrives, until the end."""
        seconds = self._request.seconds
        start_ns = self._robot.now_ns()
        end_ns = None if seconds is None else start_ns + ns_from_s(seconds)
        for timed in self._physical.readings(start_ns):
            self._lost.give_up(timed)
            if (end_ns is not None and timed.time_ns >= end_ns) or not self._await(timed):
                return
            yield timed

    def _await(self, timed: TimedReading) -> bool:
        """Wait for the reading's time; whether to go on."""
        while self._robot.now_ns() < timed.time_ns and not self._stopped():
            self._robot.wait(timed.time_ns, _LONGEST_WAIT_S)
        teleop = self._request.teleop
        if teleop is not None and (keys := self._request.keys()):
            teleop.press(keys)
            self._robot.log.info(teleop.description)
        return not self._stopped()


@contextmanager
def _heard_commands(
    robot: Robot, messages: RobotMessages, physical: PhysicalRobot
) -> Iterator[deque[Payload]]:
    """Have the robot obey what others publish on /cmd_vel; what it published itself goes into the deque."""
    channel = messages.channels[Topic.CMD_VEL]
    published: deque[Payload] = deque(maxlen=_REMEMBERED)

    def receive(payload: Payload, _publisher: Hashable) -> None:
        said = payload[_CDR_HEADER:]
        if said in published:
            published.remove(said)
            return
        try:
            velocity = messages.velocity(payload)
        except ValueError as error:
            robot.log.warning(f"A command on {channel.topic} is ignored: {error}")
            return
        physical.hear(velocity)

    subscription = robot.data_path.subscribe(channel.topic, channel.type_name, qos_of(Topic.CMD_VEL), receive)
    try:
        yield published
    finally:
        subscription.close()


def _greeting(
    request: SimulatePhysicsRequest,
    physical: PhysicalRobot,
    robot: Robot,
    messages: RobotMessages,
    publishers: Mapping[Topic, Publisher],
) -> str:
    ways = "by keys" if request.teleop else "the patrol" if request.mission is None else "the mission"
    camera = f"; no camera: {physical.camera_problem}" if physical.camera_problem else ""
    return (
        f"Driving {ways} with {len(publishers)} topics{left_out(robot, messages)}; "
        f"{request.kind.value} with physics (MuJoCo {physical.body.engine.version}){camera}"
    )
