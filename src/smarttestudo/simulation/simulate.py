# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The simulated robot on a real ROS graph, in real time."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from smarttestudo.domain.robot import Payload, Publisher, Robot
from smarttestudo.domain.units import NS_PER_S, ns_from_s
from smarttestudo.simulation.camera import FrameSize
from smarttestudo.simulation.geometry import BodyVelocity
from smarttestudo.simulation.messages import RobotMessages, RobotTopic, TimedMessage, qos_of
from smarttestudo.simulation.mission import drive_mission, route_of
from smarttestudo.simulation.schedule import DeviceSchedule

if TYPE_CHECKING:
    from smarttestudo.simulation.physics.drive import RobotKind, Teleop

_LONGEST_WAIT_S = 0.05
_REMEMBERED = 50
_RANGE = "sensor_msgs/msg/Range"
_CDR_HEADER = 4
_MOST_BEHIND_NS = NS_PER_S
_WARNING_NS = 10 * NS_PER_S


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulateRequest:
    """How long the robot drives (``None``: until stopped), and with which noise.

    Only with full ``frames`` it has a raw camera. ``mission`` is the file of a tour, ``None`` the patrol.
    """

    seconds: float | None
    seed: int
    frames: FrameSize
    mission: Path | None = None

    @property
    def way(self) -> str:
        """The way that it drives, in words."""
        return "the patrol" if self.mission is None else "the mission"


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatePhysicsRequest(SimulateRequest):
    """Which robot with physics drives.

    With a ``teleop`` the keys that ``keys`` returns drive instead of the mission. After ``cover_s`` seconds
    something covers the LiDAR.
    """

    kind: RobotKind
    battery_percent: float
    cover_s: float | None = None
    teleop: Teleop | None = None
    keys: Callable[[], str] = str


def simulate(request: SimulateRequest, robot: Robot, stopped: Callable[[], bool]) -> None:
    """Publish what the robot's devices say, each message when its time comes, until it drove or ``stopped``.

    Topics whose message type is not installed are left out and named in the log. What is late by less than a
    second is caught up with, with the stamps of its time. More than that is lost: the robot stands still
    meanwhile, stamps go on with the node's clock, and the log says how much it was.

    Raises:
        MissionError: the mission cannot be read or driven.
    """
    route = route_of(request.mission)
    node = _RobotNode(robot, RobotMessages(), request, "this machine slept, or is too slow for the camera")
    node.greet(request.way)

    node.drive(
        lambda start_ns: drive_mission(route, seed=request.seed, start_ns=start_ns, frames=request.frames),
        stopped,
    )


def simulate_physics(request: SimulatePhysicsRequest, robot: Robot, stopped: Callable[[], bool]) -> None:
    """As ``simulate``, by a robot with physics, which obeys /cmd_vel.

    Raises:
        MissingPackageError: MuJoCo is not installed.
        PhysicsError: it does not load.
        MissionError: the mission cannot be read or driven.
    """
    # This needs the extra physics.
    from smarttestudo.simulation.physics.drive import physical_robot  # noqa: PLC0415

    driven = physical_robot(
        request.kind,
        route_of(request.mission),
        seed=request.seed,
        frames=request.frames,
        battery_percent=request.battery_percent,
        cover_s=request.cover_s,
        steer=None if request.teleop is None else request.teleop.command,
    )
    with driven as physical:
        has_range_variance = RobotTopic.RANGE in physical.topics and "variance" in robot.definition(_RANGE)
        messages = RobotMessages(physical.topics, has_range_variance=has_range_variance)
        why = "this machine is too slow for its physics or its camera"
        node = _RobotNode(robot, messages, request, why)
        camera = f"; no camera: {physical.camera_problem}" if physical.camera_problem else ""
        node.greet(
            "by keys" if request.teleop else request.way,
            f"; {request.kind.value} with physics (MuJoCo {physical.body.engine.version}){camera}",
        )

        def stopped_or_pressed() -> bool:
            if request.teleop is not None and (keys := request.keys()):
                request.teleop.press(keys)
                robot.log.info(request.teleop.description)
            return stopped()

        with node.passing_commands(physical.obey):
            node.drive(physical.start, stopped_or_pressed)


class _RobotNode:
    """Publishes the messages of a robot when their time comes.

    Time that is lost is given up, so that what comes has the stamps of its time; ``why`` ends the warning.
    """

    def __init__(self, robot: Robot, messages: RobotMessages, request: SimulateRequest, why: str) -> None:
        self._robot = robot
        self._messages = messages
        self._seconds = request.seconds
        self._why = why
        self._lost_ns = 0
        self._warned_ns: int | None = None
        self._own_commands: deque[Payload] = deque(maxlen=_REMEMBERED)
        self._missing: dict[str, str] = {}
        self._publishers: dict[RobotTopic, Publisher] = {}
        for topic, channel in messages.channels.items():
            if not robot.data_path.knows(channel.type_name):
                self._missing[topic.value] = channel.type_name
            elif topic is not RobotTopic.IMAGE or request.frames is FrameSize.FULL:
                self._publishers[topic] = robot.data_path.advertise(
                    topic.value, channel.type_name, qos_of(topic)
                )

    def greet(self, way: str, robot: str = "") -> None:
        """Say what drives, with which topics, and which lack their type.

        Nobody who asks for a robot asked for every one of its topics, so this is no warning.
        """
        types = ", ".join(sorted(set(self._missing.values())))
        without = f", without {', '.join(self._missing)} ({types} is not installed)" if types else ""
        self._robot.log.info(f"Driving {way} with {len(self._publishers)} topics{without}{robot}")

    def drive(self, start: Callable[[int], DeviceSchedule[Any]], stopped: Callable[[], bool]) -> None:
        """Publish each message of the schedule that starts now, until it drove or ``stopped``."""
        start_ns = self._robot.now_ns()
        end_ns = None if self._seconds is None else start_ns + ns_from_s(self._seconds)
        schedule = start(start_ns)
        for timed in schedule:
            self._give_up_lost_time(timed, schedule)
            if end_ns is not None and timed.time_ns >= end_ns:
                return
            while self._robot.now_ns() < timed.time_ns and not stopped():
                self._robot.wait(timed.time_ns, _LONGEST_WAIT_S)
            if stopped():
                return
            publisher = self._publishers.get(timed.topic)
            if publisher is not None:
                payload = self._messages.payload(timed.topic, timed.message)
                if timed.topic is RobotTopic.CMD_VEL:
                    self._own_commands.append(payload[_CDR_HEADER:])
                publisher.publish(payload)

    def _give_up_lost_time(self, timed: TimedMessage, schedule: DeviceSchedule[Any]) -> None:
        now_ns = self._robot.now_ns()
        behind_ns = now_ns - timed.time_ns
        if behind_ns <= _MOST_BEHIND_NS:
            return
        schedule.skip(behind_ns)
        self._lost_ns += behind_ns
        if self._warned_ns is None or now_ns - self._warned_ns >= _WARNING_NS:
            self._warned_ns = now_ns
            self._robot.log.warning(
                f"Lost {self._lost_ns / NS_PER_S:.1f} s of real time so far, in which the robot stood still: "
                f"{self._why}"
            )

    @contextmanager
    def passing_commands(self, obey: Callable[[BodyVelocity], None]) -> Iterator[None]:
        """Pass on what others publish on /cmd_vel while the block lasts."""
        channel = self._messages.channels[RobotTopic.CMD_VEL]

        def receive(payload: Payload, _publisher: Hashable) -> None:
            said = payload[_CDR_HEADER:]
            if said in self._own_commands:
                self._own_commands.remove(said)
                return
            try:
                obey(self._messages.velocity(payload))
            except ValueError as error:
                self._robot.log.warning(f"A command on {channel.topic} is ignored: {error}")

        subscription = self._robot.data_path.subscribe(
            channel.topic, channel.type_name, qos_of(RobotTopic.CMD_VEL), receive
        )
        try:
            yield
        finally:
            subscription.close()
