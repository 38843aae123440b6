# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot with physics on its mission, and the keys that drive it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from smarttestudo.domain.floor_plan import FloorPlan
from smarttestudo.simulation.camera import Camera, FrameSize, raspberry_pi_lens
from smarttestudo.simulation.geometry import BodyVelocity, Lens, Pose, clamped
from smarttestudo.simulation.messages import CAMERA_TOPICS, RobotTopic
from smarttestudo.simulation.physics.body import BatteryCharge, Machine, PhysicalBody
from smarttestudo.simulation.physics.engine import Engine, PhysicsError
from smarttestudo.simulation.physics.quadrotor import Quadrotor
from smarttestudo.simulation.physics.sensors import BatteryGauge, InertialSensor, camera_view
from smarttestudo.simulation.physics.waffle import Waffle
from smarttestudo.simulation.physics.world import people, world_model
from smarttestudo.simulation.robot import DriveModel
from smarttestudo.simulation.route import Route, Tour
from smarttestudo.simulation.schedule import Device, DeviceSchedule
from smarttestudo.simulation.steering import Navigator, Steer, steering
from smarttestudo.simulation.warehouse import warehouse


class RobotKind(Enum):
    """The robots with physics."""

    WAFFLE = "waffle"
    QUADROTOR = "quadrotor"


_MACHINES: Mapping[RobotKind, type[Waffle | Quadrotor]] = {
    RobotKind.WAFFLE: Waffle,
    RobotKind.QUADROTOR: Quadrotor,
}
DRIVING_KEYS = "w/x: faster, slower or back; a/d: turn left, right; s or space: stop; Ctrl-C: end"
FLYING_KEYS = f"r/f: climb, sink; {DRIVING_KEYS}"
_STEPS = {
    "w": ("linear_m_per_s", 0.05),
    "x": ("linear_m_per_s", -0.05),
    "a": ("angular_rad_per_s", 0.2),
    "d": ("angular_rad_per_s", -0.2),
    "r": ("climb_m_per_s", 0.1),
    "f": ("climb_m_per_s", -0.1),
}


class Teleop:
    """The velocity that keys ask for, up to the speed of the robot; each press is a step."""

    def __init__(self, kind: RobotKind) -> None:
        self._most = _MACHINES[kind].most
        self._can_fly = self._most.climb_m_per_s > 0
        self.keys = FLYING_KEYS if self._can_fly else DRIVING_KEYS
        self.velocity = BodyVelocity(0.0, 0.0)

    def press(self, keys: str) -> None:
        """Take ``keys`` in order; unknown ones mean nothing."""
        for key in keys.lower():
            if key in "s ":
                self.velocity = BodyVelocity(0.0, 0.0)
            elif key in _STEPS:
                field, step = _STEPS[key]
                value = clamped(getattr(self.velocity, field) + step, getattr(self._most, field))
                self.velocity = replace(self.velocity, **{field: round(value, 6)})

    @property
    def description(self) -> str:
        now = self.velocity
        climb = f", {now.climb_m_per_s:+.2f} m/s up" if self._can_fly else ""
        return f"{now.linear_m_per_s:+.2f} m/s, {now.angular_rad_per_s:+.2f} rad/s{climb}"

    def command(self, _body: PhysicalBody) -> BodyVelocity:
        return self.velocity


_COMMON_TOPICS = (
    RobotTopic.CMD_VEL,
    RobotTopic.ODOM,
    RobotTopic.IMU,
    RobotTopic.TF,
    RobotTopic.TF_STATIC,
    RobotTopic.BATTERY_STATE,
    RobotTopic.AMCL_POSE,
)
_SETTLING_STEPS = 300


@dataclass(frozen=True, slots=True, kw_only=True)
class PhysicalRobot:
    """A robot that is ready to drive.

    ``camera_problem`` says why it has no camera, if so; ``topics`` are those that it has.
    """

    body: PhysicalBody
    topics: tuple[RobotTopic, ...]
    camera_problem: str | None
    machine: Machine
    navigator: Navigator[PhysicalBody]
    devices: Sequence[Device[PhysicalBody]]
    seed: int

    def start(self, start_ns: int) -> DeviceSchedule[PhysicalBody]:
        """All messages from ``start_ns`` on, by arrival time; to be called once."""
        self.body.skip(start_ns)
        return DeviceSchedule(
            self.body,
            [self.navigator, *self.devices],
            seed=self.seed,
            fixed_frames=self.machine.fixed_frames,
            together=(),
        )

    def obey(self, velocity: BodyVelocity) -> None:
        """Follow the command of another publisher for two seconds."""
        self.navigator.obey(velocity, self.body)


@contextmanager
def physical_robot(
    kind: RobotKind,
    route: Route | Tour,
    *,
    seed: int,
    frames: FrameSize = FrameSize.SMALL,
    battery_percent: float = 100.0,
    cover_s: float | None = None,
    steer: Steer[PhysicalBody] | None = None,
    has_camera: bool = True,
) -> Iterator[PhysicalRobot]:
    """A robot in the warehouse, ready to drive, until the block ends.

    ``seed`` fixes every noise. ``battery_percent`` is left at the start. After ``cover_s`` seconds something
    covers the LiDAR. ``steer`` drives instead of the route. Without ``has_camera`` none is tried.

    Raises:
        MissingPackageError: MuJoCo is not installed.
        PhysicsError: it does not load.
    """
    lens = raspberry_pi_lens(frames)
    machine = _MACHINES[kind](route.start)
    walkers = people()
    robot = machine.body(lens)
    poses = [person.pose for person in walkers]
    engine = Engine(world_model(warehouse(), robot, machine.actuators(), poses, lens.image_size))
    try:
        problem = _open_camera(engine, lens) if has_camera else "not asked for"
        engine.settle([0.0] * machine.actuator_count, _SETTLING_STEPS)
        battery = BatteryCharge(machine.battery, battery_percent)
        noises = [np.random.default_rng([seed, index, 2]) for index in range(6)]
        devices = [*machine.devices(noises[2:]), InertialSensor(noises[0]), BatteryGauge()]
        if not problem:
            devices.append(Camera(camera_view(noises[1]), frames))
        steer = steer or machine.keeping_height(steering(route, DriveModel()))
        yield PhysicalRobot(
            body=PhysicalBody(engine, machine, walkers, battery, cover_s=cover_s),
            topics=(*_COMMON_TOPICS, *machine.own_topics, *(() if problem else CAMERA_TOPICS)),
            camera_problem=problem,
            machine=machine,
            navigator=Navigator(steer),
            devices=devices,
            seed=seed,
        )
    finally:
        engine.close()


def camera_problem() -> str | None:
    """Why robots have no camera on this machine, if so. Raises as ``physical_robot`` does."""
    lens, machine = raspberry_pi_lens(FrameSize.SMALL), Waffle(Pose(0.0, 0.0, 0.0))
    robot = machine.body(lens)
    engine = Engine(world_model(FloorPlan(), robot, machine.actuators(), [], lens.image_size))
    try:
        return _open_camera(engine, lens)
    finally:
        engine.close()


def _open_camera(engine: Engine, lens: Lens) -> str | None:
    try:
        engine.open_camera(*lens.image_size)
    except PhysicsError as error:
        return f"{error.cause}; {error.remedy}"
    return None
