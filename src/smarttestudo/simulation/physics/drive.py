# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot with physics on its mission: everything that its topics carry, in the order in which it arrives."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum

import numpy as np

from smarttestudo.domain.floor_plan import FloorPlan
from smarttestudo.simulation.camera import Camera, FrameSize, raspberry_pi_lens
from smarttestudo.simulation.geometry import BodyVelocity, FrameTransform, Pose
from smarttestudo.simulation.physics.body import Machine, PhysicalBody
from smarttestudo.simulation.physics.engine import Engine, PhysicsError
from smarttestudo.simulation.physics.odometry import DriftWalk, WheelOdometry
from smarttestudo.simulation.physics.people import people
from smarttestudo.simulation.physics.power import QUADROTOR_BATTERY, WAFFLE_BATTERY, BatteryCharge
from smarttestudo.simulation.physics.quadrotor import Quadrotor
from smarttestudo.simulation.physics.quadrotor_sensors import RangeFinder, VisualOdometer, quadrotor_frames
from smarttestudo.simulation.physics.sensors import BatteryGauge, InertialSensor, Localizer, camera_view
from smarttestudo.simulation.physics.steering import SharedNavigator, Steer, at_height
from smarttestudo.simulation.physics.teleop import Teleop
from smarttestudo.simulation.physics.waffle import Waffle
from smarttestudo.simulation.physics.waffle_sensors import TiltingLidar, WheelOdometer, WheelSensors
from smarttestudo.simulation.physics.world_model import world_model
from smarttestudo.simulation.readings import CAMERA_TOPICS, Lens, TimedReading, Topic
from smarttestudo.simulation.robot import DriveModel, fixed_frames
from smarttestudo.simulation.route import PurePursuit, Route
from smarttestudo.simulation.schedule import Device, DeviceSchedule
from smarttestudo.simulation.tour import Tour, WaypointFollower


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
_OWN_TOPICS = {
    RobotKind.WAFFLE: (Topic.SCAN, Topic.JOINT_STATES),
    RobotKind.QUADROTOR: (Topic.RANGE,),
}


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
    steer: Steer | None = None
    has_camera: bool = True


class PhysicalRobot:
    """A robot that drives round after round.

    ``camera_problem`` says why it has no camera, if so; ``topics`` are those that it has.
    """

    def __init__(
        self,
        *,
        request: PhysicsRequest,
        body: PhysicalBody,
        devices: Sequence[Device[PhysicalBody]],
        navigator: SharedNavigator,
        frames: tuple[FrameTransform, ...],
        camera_problem: str | None,
    ) -> None:
        self.body = body
        self.camera_problem = camera_problem
        cameras = () if camera_problem else CAMERA_TOPICS
        self.topics: tuple[Topic, ...] = (*_COMMON_TOPICS, *_OWN_TOPICS[request.kind], *cameras)
        self._navigator = navigator
        self._devices = [navigator, *devices]
        self._seed = request.seed
        self._frames = frames
        self._schedule: DeviceSchedule[PhysicalBody] | None = None

    def readings(self, start_ns: int) -> Iterator[TimedReading]:
        """Readings on its topics from ``start_ns`` on, in order and without end; to be asked once."""
        self.body.skip(start_ns)
        self._schedule = DeviceSchedule(
            self.body, self._devices, seed=self._seed, fixed_frames=self._frames, together=()
        )
        return self._schedule

    def hear(self, velocity: BodyVelocity) -> None:
        """Obey somebody else for two seconds."""
        self._navigator.hear(velocity, self.body)

    def skip(self, lost_ns: int) -> None:
        """Let ``lost_ns`` pass without physics."""
        self.body.skip(lost_ns)
        if self._schedule is not None:
            self._schedule.skip(lost_ns)


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
    machine: Waffle | Quadrotor = Waffle() if request.kind is RobotKind.WAFFLE else Quadrotor()
    walkers = people()
    start = request.route.start
    model = world_model(
        request.plan,
        machine.body(start, lens),
        machine.actuators(),
        [person.pose for person in walkers],
        lens.image_size,
    )
    engine = Engine(model)
    try:
        problem = _open_camera(engine, lens) if request.has_camera else "not asked for"
        engine.settle([0.0] * machine.actuator_count, _SETTLING_STEPS)
        battery = WAFFLE_BATTERY if isinstance(machine, Waffle) else QUADROTOR_BATTERY
        body = PhysicalBody(
            engine,
            machine,
            walkers,
            BatteryCharge(battery, request.battery_percent),
            cover_s=request.cover_s,
        )
        yield _assembled(request, body, machine, None if problem else lens, problem)
    finally:
        engine.close()


def camera_problem() -> str | None:
    """Why robots have no camera on this machine, if so. Raises as ``physical_robot`` does."""
    lens = raspberry_pi_lens(FrameSize.SMALL)
    machine, start = Waffle(), Pose(0.0, 0.0, 0.0)
    engine = Engine(
        world_model(FloorPlan(), machine.body(start, lens), machine.actuators(), [], lens.image_size)
    )
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


def _assembled(
    request: PhysicsRequest,
    body: PhysicalBody,
    machine: Machine,
    lens: Lens | None,
    camera_problem: str | None,
) -> PhysicalRobot:
    noises = [np.random.default_rng([request.seed, index, 2]) for index in range(6)]
    shared: list[Device[PhysicalBody]] = [InertialSensor(noises[0]), BatteryGauge()]
    if lens is not None:
        shared.append(Camera(camera_view(noises[1]), lens))
    own: list[Device[PhysicalBody]]
    steer = request.steer or _route_steer(request.route)
    if isinstance(machine, Waffle):
        odometry = WheelOdometry(machine.model, request.route.start, noises[2])
        own = [
            WheelOdometer(odometry),
            WheelSensors(machine.model),
            TiltingLidar(machine.model, noises[3]),
            Localizer(lambda: odometry.pose, noises[4]),
        ]
        frames = fixed_frames(machine.model)
    else:
        odometer = VisualOdometer(DriftWalk(noises[2]), noises[3])
        own = [odometer, RangeFinder(noises[4]), Localizer(lambda: odometer.pose, noises[5])]
        frames = quadrotor_frames(Quadrotor.camera_x_m)
        steer = steer if request.steer else at_height(steer)
    navigator = SharedNavigator(steer)
    return PhysicalRobot(
        request=request,
        body=body,
        devices=[*own, *shared],
        navigator=navigator,
        frames=frames,
        camera_problem=camera_problem,
    )


def _route_steer(route: Route | Tour) -> Callable[[PhysicalBody], BodyVelocity]:
    """Along the route by the true pose: odometry drifts, and a real robot has AMCL for that."""
    model = DriveModel()
    if isinstance(route, Tour):
        return WaypointFollower(route, model).command
    pursuit = PurePursuit(route, model)
    return lambda body: pursuit.command(body.pose)
