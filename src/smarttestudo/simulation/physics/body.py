# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot that moves by forces as time goes on, and its battery."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from smarttestudo.domain.floor_plan import Point
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import BodyVelocity, FrameTransform, Lens, Pose, Vector
from smarttestudo.simulation.messages import RobotTopic
from smarttestudo.simulation.physics.engine import LIDAR_COVER, Engine, Floats
from smarttestudo.simulation.physics.world import WalkingPerson
from smarttestudo.simulation.schedule import Device
from smarttestudo.simulation.steering import Steer

_FULL_V_SHARE = 1.13
_EMPTY_V_SHARE = 0.90


@dataclass(frozen=True, slots=True, kw_only=True)
class BatteryType:
    """A battery: its nominal voltage, and its charge when it is full."""

    nominal_v: float
    capacity_ah: float


class BatteryCharge:
    """Charge left in a battery, whose voltage falls in proportion to that."""

    __slots__ = ("current_a", "share", "type")

    def __init__(self, battery: BatteryType, percent: float) -> None:
        self.type = battery
        self.share = percent / 100
        self.current_a = 0.0

    @property
    def voltage_v(self) -> float:
        sagging = _FULL_V_SHARE - _EMPTY_V_SHARE
        return self.type.nominal_v * (_EMPTY_V_SHARE + sagging * self.share)

    @property
    def is_empty(self) -> bool:
        return self.share <= 0.0

    def draw(self, power_w: float, dt_s: float) -> None:
        self.current_a = 0.0 if self.is_empty else power_w / self.voltage_v
        self.share = max(0.0, self.share - self.current_a * dt_s / 3600 / self.type.capacity_ah)


_WALK_STEPS = 10
"""People and battery move on after so many steps of the engine."""


class Machine(ABC):
    """The parts of a robot, what drives them, and the sensors that only this robot has."""

    most: BodyVelocity
    """As fast as it goes."""
    actuator_count: int
    battery: BatteryType
    own_topics: tuple[RobotTopic, ...]
    fixed_frames: tuple[FrameTransform, ...]

    @abstractmethod
    def devices(self, noises: Sequence[np.random.Generator]) -> list[Device[PhysicalBody]]:
        """Sensors of its own, each with noise of its own."""

    @abstractmethod
    def keeping_height(self, steer: Steer[PhysicalBody]) -> Steer[PhysicalBody]:
        """``steer``, which knows the floor only, for this robot."""

    @abstractmethod
    def body(self, lens: Lens) -> str:
        """The robot at its start as MJCF."""

    @abstractmethod
    def actuators(self) -> str:
        """The motors as MJCF."""

    @abstractmethod
    def command(self, velocity: BodyVelocity) -> None:
        """Make for ``velocity`` from now on."""

    @abstractmethod
    def rest(self) -> None:
        """Come to rest: the battery is empty."""

    @abstractmethod
    def controls(self, engine: Engine) -> Sequence[float]:
        """Controls of the motors for the next step."""

    @abstractmethod
    def power_w(self, engine: Engine) -> float:
        """Power that it takes from its battery now."""


class PhysicalBody:
    """The true motion of a robot in its world, with its battery and the people around it.

    ``now_ns`` is the time of the robot, from 0 on; it may skip what the physics missed. Something covers the
    LiDAR after ``cover_s`` seconds of physics.
    """

    def __init__(
        self,
        engine: Engine,
        machine: Machine,
        walkers: Sequence[WalkingPerson],
        battery: BatteryCharge,
        *,
        cover_s: float | None,
    ) -> None:
        self.engine = engine
        self.machine = machine
        self.battery = battery
        self.now_ns = 0
        self._walkers = walkers
        self._epoch_ns = 0
        self._cover_ns = None if cover_s is None else round(cover_s * NS_PER_S)
        self._inertial_sum: Floats = np.zeros(6)
        self._inertial_count = 0

    @property
    def pose(self) -> Pose:
        """Where the robot truly is on the floor, and its heading within half a turn either way."""
        position = self.engine.position
        return Pose(position.x, position.y, self.engine.orientation.yaw_rad)

    def command(self, velocity: BodyVelocity) -> None:
        """Make for ``velocity`` from now on; an empty battery hears nothing."""
        if not self.battery.is_empty:
            self.machine.command(velocity)

    def advance_to(self, now_ns: int) -> None:
        """Step on to ``now_ns``, or up to one step beyond it."""
        while self.engine.time_ns < now_ns - self._epoch_ns:
            self._step()
        self.now_ns = now_ns

    def skip(self, lost_ns: int) -> None:
        self._epoch_ns += lost_ns
        self.now_ns += lost_ns

    def mean_inertial(self) -> tuple[Vector, Vector]:
        """Angular velocity and specific force, as the mean since the last call."""
        count, self._inertial_count = self._inertial_count, 0
        values = (self._inertial_sum / count if count else self.engine.inertial).tolist()
        self._inertial_sum[:] = 0
        return Vector(*values[:3]), Vector(*values[3:])

    def _step(self) -> None:
        engine = self.engine
        engine.step(self.machine.controls(engine))
        self._inertial_sum += engine.inertial
        self._inertial_count += 1
        if engine.time_ns % (_WALK_STEPS * engine.step_ns) == 0:
            self._live_on(_WALK_STEPS * engine.step_ns / NS_PER_S)

    def _live_on(self, dt_s: float) -> None:
        """Advance what is slower than the physics."""
        position = self.engine.position
        for number, person in enumerate(self._walkers):
            person.walk(dt_s, Point(position.x, position.y))
            self.engine.place(number, person.pose)
        self.battery.draw(self.machine.power_w(self.engine), dt_s)
        if self.battery.is_empty:
            self.machine.rest()
        if self._cover_ns is not None and self.engine.time_ns >= self._cover_ns:
            self.engine.reveal(LIDAR_COVER)
            self._cover_ns = None
