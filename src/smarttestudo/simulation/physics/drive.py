# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot with physics on its mission."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum

import numpy as np

from smarttestudo.domain.floor_plan import FloorPlan
from smarttestudo.simulation.camera import Camera, FrameSize, raspberry_pi_lens
from smarttestudo.simulation.geometry import BodyVelocity, Lens, Pose
from smarttestudo.simulation.messages import CAMERA_TOPICS, Topic
from smarttestudo.simulation.physics.body import Machine, PhysicalBody
from smarttestudo.simulation.physics.engine import Engine, PhysicsError
from smarttestudo.simulation.physics.people import people
from smarttestudo.simulation.physics.power import BatteryCharge
from smarttestudo.simulation.physics.quadrotor import Quadrotor
from smarttestudo.simulation.physics.sensors import BatteryGauge, InertialSensor, camera_view
from smarttestudo.simulation.physics.teleop import Teleop
from smarttestudo.simulation.physics.waffle import Waffle
from smarttestudo.simulation.physics.world_model import world_model
from smarttestudo.simulation.robot import DriveModel
from smarttestudo.simulation.route import Navigator, Route, Steer
from smarttestudo.simulation.schedule import Device, DeviceSchedule
from smarttestudo.simulation.tour import Tour, steering


class RobotKind(Enum):
    """The robots with physics."""

    WAFFLE = "waffle"
    QUADROTOR = "quadrotor"


_COMMON_TOPICS = (
    Topic.CMD_VEL,
    Topic.ODOM,
    Topic.IMU,
    Topic.TF,
    Topic.TF_STATIC,
    Topic.BATTERY_STATE,
    Topic.AMCL_POSE,
)
_SETTLING_STEPS = 300


@dataclass(frozen=True, slots=True, kw_only=True)
class PhysicsRequest:
    """Request for a drive: where, and by which robot.

    ``seed`` fixes every noise. ``battery_percent`` is left at the start. After ``cover_s`` seconds something
    covers the LiDAR. ``steer`` drives instead of the route. Without ``has_camera`` none is tried.
    """

    plan: FloorPlan
    route: Route | Tour
    kind: RobotKind
    seed: int
    frames: FrameSize = FrameSize.SMALL
    battery_percent: float = 100.0
    cover_s: float | None = None
    steer: Steer[PhysicalBody] | None = None
    has_camera: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class PhysicalRobot:
    """A robot that is ready to drive.

    ``camera_problem`` says why it has no camera, if so; ``topics`` are those that it has.
    """

    body: PhysicalBody
    topics: tuple[Topic, ...]
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


def teleop_of(kind: RobotKind) -> Teleop:
    """Keys for that robot, up to its speed."""
    if kind is RobotKind.QUADROTOR:
        return Teleop(can_fly=True, most=Quadrotor.most)
    model = DriveModel()
    return Teleop(can_fly=False, most=BodyVelocity(model.max_linear_m_per_s, model.max_angular_rad_per_s))


@contextmanager
def physical_robot(request: PhysicsRequest) -> Iterator[PhysicalRobot]:
    """The robot of ``request``, ready to start, until the block ends.

    Raises:
        MissingPackageError: MuJoCo is not installed.
        PhysicsError: it does not load.
    """
    lens = raspberry_pi_lens(request.frames)
    machine: Machine = Waffle() if request.kind is RobotKind.WAFFLE else Quadrotor()
    start, walkers = request.route.start, people()
    poses = [person.pose for person in walkers]
    robot = machine.body(start, lens)
    engine = Engine(world_model(request.plan, robot, machine.actuators(), poses, lens.image_size))
    try:
        problem = _open_camera(engine, lens) if request.has_camera else "not asked for"
        engine.settle([0.0] * machine.actuator_count, _SETTLING_STEPS)
        battery = BatteryCharge(machine.battery, request.battery_percent)
        noises = [np.random.default_rng([request.seed, index, 2]) for index in range(6)]
        devices = [*machine.devices(start, noises[2:]), InertialSensor(noises[0]), BatteryGauge()]
        if not problem:
            devices.append(Camera(camera_view(noises[1]), request.frames))
        steer = request.steer or machine.keeping_height(steering(request.route, DriveModel()))
        yield PhysicalRobot(
            body=PhysicalBody(engine, machine, walkers, battery, cover_s=request.cover_s),
            topics=(*_COMMON_TOPICS, *machine.own_topics, *(() if problem else CAMERA_TOPICS)),
            camera_problem=problem,
            machine=machine,
            navigator=Navigator(steer),
            devices=devices,
            seed=request.seed,
        )
    finally:
        engine.close()


def camera_problem() -> str | None:
    """Why robots have no camera on this machine, if so. Raises as ``physical_robot`` does."""
    lens, machine = raspberry_pi_lens(FrameSize.SMALL), Waffle()
    robot = machine.body(Pose(0.0, 0.0, 0.0), lens)
    engine = Engine(world_model(FloorPlan(), robot, machine.actuators(), [], lens.image_size))
    try:
        return _open_camera(engine, lens)
    finally:
        engine.close()


def _open_camera(engine: Engine, lens: Lens) -> str | None:
    """Why it has no camera, if so."""
    try:
        engine.open_camera(*lens.image_size)
    except PhysicsError as error:
        return f"{error.cause}; {error.remedy}"
    return None
