# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The mission of the thesis's robot, and recordings of it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.units import NS_PER_S, ns_from_s
from smarttestudo.simulation.camera import FULL_JPEG_BYTES, Camera, FrameSize, drawn_view, raspberry_pi_lens
from smarttestudo.simulation.messages import RobotMessages, RobotTopic
from smarttestudo.simulation.robot import DifferentialDrive, DriveModel, fixed_frames
from smarttestudo.simulation.route import Route, Tour, load_mission
from smarttestudo.simulation.schedule import Device, DeviceSchedule
from smarttestudo.simulation.sensors import (
    InertialUnit,
    Lidar,
    Odometer,
    OdometryFrame,
    RayCaster,
    WheelEncoders,
    WheelFrames,
    level_cast,
)
from smarttestudo.simulation.steering import Navigator, steering
from smarttestudo.simulation.warehouse import patrol, warehouse


def drive_mission(
    route: Route | Tour, *, seed: int, start_ns: int, frames: FrameSize = FrameSize.SMALL
) -> DeviceSchedule[DifferentialDrive]:
    """All messages of a robot that starts at ``start_ns``, by arrival time: it drives round after round.

    ``seed`` fixes every noise; each device has its own, so that none depends on another.
    """
    model, plan = DriveModel(), warehouse()
    noises = [np.random.default_rng([seed, index, 0]) for index in range(4)]
    caster = RayCaster(plan)
    devices: list[Device[DifferentialDrive]] = [
        Navigator(steering(route, model)),
        Odometer(noises[0]),
        InertialUnit(noises[1]),
        WheelEncoders(),
        Lidar(level_cast(caster), noises[2]),
        OdometryFrame(),
        Camera(drawn_view(caster, raspberry_pi_lens(frames), noises[3]), frames),
        WheelFrames(),
    ]
    return DeviceSchedule(
        DifferentialDrive(model, pose=route.start, now_ns=start_ns),
        devices,
        seed=seed,
        fixed_frames=fixed_frames(model),
        # A frame is sampled when its sensor is, and so has its stamp.
        together=((OdometryFrame, Odometer), (WheelFrames, WheelEncoders)),
    )


START_NS = 1_767_600_000 * NS_PER_S
DECLARED_BYTES = {RobotTopic.IMAGE.value: 6_220_872, RobotTopic.COMPRESSED_IMAGE.value: FULL_JPEG_BYTES}
_MESSAGES_PER_REPORT = 1000
_SMALL_BYTES_PER_S = 500_000
_FULL_BYTES_PER_S = 216_000_000


def route_of(mission: Path | None) -> Route | Tour:
    """The tour in the mission file, without one the patrol of the thesis; raises ``MissionError``."""
    return patrol() if mission is None else load_mission(mission, warehouse())


def bytes_per_second(*, full_images: bool) -> int:
    """About how much disk both recordings of a mission take for each of its seconds."""
    return _FULL_BYTES_PER_S if full_images else _SMALL_BYTES_PER_S


def record_mission(
    path: Path,
    *,
    route: Route | Tour,
    seconds: float,
    seed: int,
    full_images: bool,
    report: Callable[[float], None],
) -> None:
    """Write ``seconds`` of the drive to a new recording at ``path``; ``report`` gets the share done.

    Unless ``full_images``, camera frames are small, and the recording declares the size of whole ones.

    Raises:
        RecordingError: the recording cannot be written.
    """
    frames = FrameSize.FULL if full_images else FrameSize.SMALL
    mission = drive_mission(route, seed=seed, start_ns=START_NS, frames=frames)
    messages = RobotMessages()
    duration_ns = ns_from_s(seconds)
    declared_bytes = {} if full_images else DECLARED_BYTES
    with create_recording(path, declared_bytes=declared_bytes) as recording:
        for channel in messages.channels.values():
            recording.add(channel)
        for count, timed in enumerate(mission):
            elapsed_ns = timed.time_ns - START_NS
            if elapsed_ns >= duration_ns:
                break
            recording.write(
                messages.channels[timed.topic], timed.time_ns, messages.payload(timed.topic, timed.message)
            )
            if count % _MESSAGES_PER_REPORT == 0:
                report(elapsed_ns / duration_ns)
