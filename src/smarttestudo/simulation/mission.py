# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's mission: everything that its topics carry, in the order in which it arrives."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from smarttestudo.domain.floor_plan import FloorPlan
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.body_sensors import (
    InertialUnit,
    Odometer,
    OdometryFrame,
    WheelEncoders,
    WheelFrames,
)
from smarttestudo.simulation.camera import Camera, FrameSize, raspberry_pi_lens
from smarttestudo.simulation.geometry import BodyVelocity
from smarttestudo.simulation.lidar import Lidar, RayCaster
from smarttestudo.simulation.readings import Device, TimedReading, Topic, Transforms
from smarttestudo.simulation.robot import DifferentialDrive, DriveModel, fixed_frames
from smarttestudo.simulation.route import Navigator, PurePursuit, Route
from smarttestudo.simulation.tour import Tour, WaypointFollower

_TRANSPORT_NS = 500_000
_DISCOVERY_NS = 20_000_000
"""After which a latched message arrives: its publisher must be found first."""
_JITTER = 0.02
_MAX_JITTER = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionRequest:
    """What is to be driven where: along a route without a stop, or on a tour.

    ``start_ns`` is the time at which the mission starts, ``seed`` fixes every noise.
    """

    plan: FloorPlan
    route: Route | Tour
    seed: int
    start_ns: int
    frames: FrameSize = FrameSize.SMALL


def drive_mission(request: MissionRequest) -> Iterator[TimedReading]:
    """Everything the robot publishes, by arrival time, without end: the robot drives round after round.

    Nothing is computed ahead of what is taken, so that a live run can take readings as their time comes.
    """
    model = DriveModel()
    drive = DifferentialDrive(model, pose=request.route.start, now_ns=request.start_ns)
    clocks = _clocks(request, model)
    due = [(clock.next_ns, order) for order, clock in enumerate(clocks)]
    heapq.heapify(due)
    latched = Transforms(stamp_ns=request.start_ns, frames=fixed_frames(model))
    found_ns = request.start_ns + _DISCOVERY_NS
    static = TimedReading(time_ns=found_ns, topic=Topic.TF_STATIC, reading=latched)
    under_way: list[tuple[int, int, TimedReading]] = [(found_ns, 0, static)]
    serial = 0
    while True:
        now_ns, order = due[0]
        while under_way and under_way[0][0] <= now_ns:
            yield heapq.heappop(under_way)[2]
        drive.advance_to(now_ns)
        for reading in clocks[order].publish(drive):
            serial += 1
            heapq.heappush(under_way, (reading.time_ns, serial, reading))
        heapq.heapreplace(due, (clocks[order].next_ns, order))


class _DeviceClock:
    """When a device is sampled, and when what it says arrives.

    Sample i is taken at (i + phase) / rate; each message arrives a transport time later, plus the
    absolute value of Gaussian noise of 2 % of the period.
    """

    __slots__ = ("_count", "_device", "_first_ns", "_noise", "_period_ns", "next_ns")

    def __init__(self, device: Device, start_ns: int, phase: float, noise: np.random.Generator) -> None:
        self._device = device
        self._noise = noise
        self._period_ns = NS_PER_S / device.rate_hz
        self._first_ns = start_ns + round(phase * self._period_ns)
        self._count = 0
        self.next_ns = self._first_ns

    def publish(self, drive: DifferentialDrive) -> Iterator[TimedReading]:
        """Sample the device, and set the time of the next sample."""
        now_ns = self.next_ns
        self._count += 1
        self.next_ns = self._first_ns + round(self._count * self._period_ns)
        for topic, reading in self._device.sample(drive):
            share = min(abs(self._noise.standard_normal()) * _JITTER, _MAX_JITTER)
            arrival_ns = now_ns + _TRANSPORT_NS + round(share * self._period_ns)
            yield TimedReading(time_ns=arrival_ns, topic=topic, reading=reading)


def _clocks(request: MissionRequest, model: DriveModel) -> Sequence[_DeviceClock]:
    """What the robot carries; each has noise of its own, so that none depends on another.

    A frame is sampled when its sensor is, and so has its stamp.
    """
    noises = [np.random.default_rng([request.seed, index, 0]) for index in range(4)]
    caster = RayCaster(request.plan)
    devices: Sequence[Device] = (
        Navigator(_steering(request.route, model)),
        Odometer(noises[0]),
        InertialUnit(noises[1]),
        WheelEncoders(),
        Lidar(caster, noises[2]),
        OdometryFrame(),
        Camera(request.plan, caster, raspberry_pi_lens(request.frames), noises[3]),
        WheelFrames(),
    )
    timing = [np.random.default_rng([request.seed, order, 1]) for order in range(len(devices))]
    phases = [noise.random() for noise in timing]
    kinds = [type(device) for device in devices]
    for frame, sensor in ((OdometryFrame, Odometer), (WheelFrames, WheelEncoders)):
        phases[kinds.index(frame)] = phases[kinds.index(sensor)]
    return [
        _DeviceClock(device, request.start_ns, phase, noise)
        for device, phase, noise in zip(devices, phases, timing, strict=True)
    ]


def _steering(route: Route | Tour, model: DriveModel) -> Callable[[DifferentialDrive], BodyVelocity]:
    if isinstance(route, Tour):
        return WaypointFollower(route, model).command
    pursuit = PurePursuit(route, model)
    return lambda drive: pursuit.command(drive.pose)
