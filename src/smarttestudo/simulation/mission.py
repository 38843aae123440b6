# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's mission: everything that its topics carry, in the order in which it arrives."""

from __future__ import annotations

from collections.abc import Sequence
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
from smarttestudo.simulation.lidar import Lidar, RayCaster, level_cast
from smarttestudo.simulation.robot import DifferentialDrive, DriveModel, fixed_frames
from smarttestudo.simulation.route import Navigator, Route
from smarttestudo.simulation.schedule import Device, DeviceSchedule
from smarttestudo.simulation.tour import Tour, steering


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


def drive_mission(request: MissionRequest) -> DeviceSchedule[DifferentialDrive]:
    """All messages of a robot that starts now, by arrival time: it drives round after round."""
    model = DriveModel()
    drive = DifferentialDrive(model, pose=request.route.start, now_ns=request.start_ns)
    return DeviceSchedule(
        drive,
        _devices(request, model),
        seed=request.seed,
        fixed_frames=fixed_frames(model),
        # A frame is sampled when its sensor is, and so has its stamp.
        together=((OdometryFrame, Odometer), (WheelFrames, WheelEncoders)),
    )


def _devices(request: MissionRequest, model: DriveModel) -> Sequence[Device[DifferentialDrive]]:
    """Devices that the robot carries; each has noise of its own, so that none depends on another."""
    noises = [np.random.default_rng([request.seed, index, 0]) for index in range(4)]
    caster = RayCaster(request.plan)
    return (
        Navigator(steering(request.route, model)),
        Odometer(noises[0]),
        InertialUnit(noises[1]),
        WheelEncoders(),
        Lidar(level_cast(caster), noises[2]),
        OdometryFrame(),
        Camera(
            drawn_view(request.plan, caster, raspberry_pi_lens(request.frames), noises[3]), request.frames
        ),
        WheelFrames(),
    )
