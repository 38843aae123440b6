# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's mission: everything that its topics carry, in the order in which it arrives."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from smarttestudo.domain.floor_plan import FloorPlan
from smarttestudo.simulation.body_sensors import (
    InertialUnit,
    Odometer,
    OdometryFrame,
    WheelEncoders,
    WheelFrames,
)
from smarttestudo.simulation.camera import Camera, FrameSize, drawn_view, raspberry_pi_lens
from smarttestudo.simulation.geometry import BodyVelocity
from smarttestudo.simulation.lidar import Lidar, RayCaster
from smarttestudo.simulation.readings import TimedReading
from smarttestudo.simulation.robot import DifferentialDrive, DriveModel, fixed_frames
from smarttestudo.simulation.route import Navigator, PurePursuit, Route
from smarttestudo.simulation.schedule import Device, DeviceSchedule
from smarttestudo.simulation.tour import Tour, WaypointFollower


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionRequest:
    """Request for a mission: where to drive, along a route without a stop, or on a tour.

    ``start_ns`` is the time at which the mission starts, ``seed`` fixes every noise.
    """

    plan: FloorPlan
    route: Route | Tour
    seed: int
    start_ns: int
    frames: FrameSize = FrameSize.SMALL


class DrivenMission:
    """Everything a robot publishes, by arrival time, without end: it drives round after round.

    Nothing is computed ahead of what is taken, so that a live run can take readings as their time comes.
    """

    def __init__(self, drive: DifferentialDrive, schedule: DeviceSchedule[DifferentialDrive]) -> None:
        self._drive = drive
        self._schedule = schedule

    def __iter__(self) -> Iterator[TimedReading]:
        """All readings."""
        return self

    def __next__(self) -> TimedReading:
        """The reading that arrives next."""
        return next(self._schedule)

    def skip(self, lost_ns: int) -> None:
        """Let ``lost_ns`` pass in which the robot stands still."""
        self._drive.now_ns += lost_ns
        self._schedule.skip(lost_ns)


def drive_mission(request: MissionRequest) -> DrivenMission:
    """The mission of a robot that starts now."""
    model = DriveModel()
    drive = DifferentialDrive(model, pose=request.route.start, now_ns=request.start_ns)
    schedule = DeviceSchedule(
        drive,
        _devices(request, model),
        seed=request.seed,
        fixed_frames=fixed_frames(model),
        # A frame is sampled when its sensor is, and so has its stamp.
        together=((OdometryFrame, Odometer), (WheelFrames, WheelEncoders)),
    )
    return DrivenMission(drive, schedule)


def _devices(request: MissionRequest, model: DriveModel) -> Sequence[Device[DifferentialDrive]]:
    """Devices that the robot carries; each has noise of its own, so that none depends on another."""
    noises = [np.random.default_rng([request.seed, index, 0]) for index in range(4)]
    caster = RayCaster(request.plan)
    lens = raspberry_pi_lens(request.frames)
    return (
        Navigator(_steering(request.route, model)),
        Odometer(noises[0]),
        InertialUnit(noises[1]),
        WheelEncoders(),
        Lidar(caster, noises[2]),
        OdometryFrame(),
        Camera(drawn_view(request.plan, caster, lens, noises[3]), lens),
        WheelFrames(),
    )


def _steering(route: Route | Tour, model: DriveModel) -> Callable[[DifferentialDrive], BodyVelocity]:
    if isinstance(route, Tour):
        return WaypointFollower(route, model).command
    pursuit = PurePursuit(route, model)
    return lambda drive: pursuit.command(drive.pose)
