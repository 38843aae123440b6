# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot with physics on its mission, and the keys that drive it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from smarttestudo.domain.floor_plan import FloorPlan
from smarttestudo.simulation.camera import Camera, FrameSize, raspberry_pi_lens
from smarttestudo.simulation.geometry import BodyVelocity, Lens, Pose
from smarttestudo.simulation.messages import CAMERA_TOPICS, Topic
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

LINEAR_STEP_M_PER_S = 0.05
ANGULAR_STEP_RAD_PER_S = 0.2
CLIMB_STEP_M_PER_S = 0.1
DRIVING_KEYS = "w/x: faster, slower or back; a/d: turn left, right; s or space: stop; Ctrl-C: end"
FLYING_KEYS = f"r/f: climb, sink; {DRIVING_KEYS}"


class Teleop:
    """The velocity that the keys pressed so far ask for; each press is a step."""

    def __init__(self, *, can_fly: bool, most: BodyVelocity) -> None:
        """``most`` is as fast as the robot goes."""
        self._can_fly = can_fly
        self._most = most
        self.velocity = BodyVelocity(0.0, 0.0)

    @property
    def keys(self) -> str:
        """Keys, and what each does."""
        return FLYING_KEYS if self._can_fly else DRIVING_KEYS

    def press(self, keys: str) -> None:
        """Take ``keys`` in order; unknown ones mean nothing."""
        for key in keys:
            self._press(key.lower())

    @property
    def description(self) -> str:
        """The velocity in words."""
        now = self.velocity
        climb = f", {now.climb_m_per_s:+.2f} m/s up" if self._can_fly else ""
        return f"{now.linear_m_per_s:+.2f} m/s, {now.angular_rad_per_s:+.2f} rad/s{climb}"

    def command(self, _body: PhysicalBody) -> BodyVelocity:
        """The velocity to make for now."""
        return self.velocity

    def _press(self, key: str) -> None:
        now, most = self.velocity, self._most
        match key:
            case "w" | "x":
                step = LINEAR_STEP_M_PER_S if key == "w" else -LINEAR_STEP_M_PER_S
                linear = _stepped(now.linear_m_per_s, step, most.linear_m_per_s)
                self.velocity = replace(now, linear_m_per_s=linear)
            case "a" | "d":
                step = ANGULAR_STEP_RAD_PER_S if key == "a" else -ANGULAR_STEP_RAD_PER_S
                angular = _stepped(now.angular_rad_per_s, step, most.angular_rad_per_s)
                self.velocity = replace(now, angular_rad_per_s=angular)
            case "r" | "f" if self._can_fly:
                step = CLIMB_STEP_M_PER_S if key == "r" else -CLIMB_STEP_M_PER_S
                climb = _stepped(now.climb_m_per_s, step, most.climb_m_per_s)
                self.velocity = replace(now, climb_m_per_s=climb)
            case "s" | " ":
                self.velocity = BodyVelocity(0.0, 0.0)


def _stepped(value: float, step: float, most: float) -> float:
    return round(min(max(value + step, -most), most), 6)


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
