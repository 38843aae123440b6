# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""When the devices of a simulated robot are sampled, and when what they say arrives."""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Sequence
from typing import Generic, Protocol, TypeVar

import numpy as np

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.simulation.geometry import FrameTransform
from smarttestudo.simulation.messages import Published, RobotTopic, TimedMessage, transforms
from smarttestudo.simulation.robot import Body, BodyT

_TRANSPORT_NS = 500_000
_DISCOVERY_NS = 20_000_000
"""After which a latched message arrives: its publisher must be found first."""
_JITTER = 0.02
_MAX_JITTER = 0.1
_DRAWN_AT_ONCE = 256


BodyT_contra = TypeVar("BodyT_contra", bound=Body, contravariant=True)


class Device(Protocol[BodyT_contra]):
    """Something that looks at the robot ``rate_hz`` times a second and publishes what it saw."""

    @property
    def rate_hz(self) -> float:
        """How often it is sampled."""

    def sample(self, body: BodyT_contra, /) -> Published:
        """Messages that it publishes now; called once each period, in time order."""


class DeviceSchedule(Generic[BodyT]):
    """Everything that the devices of ``body`` publish, by arrival time, without end.

    Nothing is computed ahead of what is taken, so that a live run can take messages as their time comes.
    """

    def __init__(
        self,
        body: BodyT,
        devices: Sequence[Device[BodyT]],
        *,
        seed: int,
        fixed_frames: tuple[FrameTransform, ...],
        together: Sequence[tuple[type, type]],
    ) -> None:
        """Time starts at ``body.now_ns``; of each pair in ``together`` the first follows the second."""
        self._body = body
        self._clocks = _clocks(devices, body.now_ns, seed, together)
        self._due = [(clock.next_ns, order) for order, clock in enumerate(self._clocks)]
        heapq.heapify(self._due)
        self._lost_ns = 0
        latched = transforms(body.now_ns, fixed_frames)
        self._under_way: list[tuple[int, int, RobotTopic, object]] = [
            (body.now_ns + _DISCOVERY_NS, 0, RobotTopic.TF_STATIC, latched)
        ]
        self._serial = 0

    def __iter__(self) -> Iterator[TimedMessage]:
        return self

    def __next__(self) -> TimedMessage:
        while not (self._under_way and self._under_way[0][0] <= self._due[0][0]):
            self._sample()
        arrival_ns, _, topic, message = heapq.heappop(self._under_way)
        return TimedMessage(time_ns=arrival_ns + self._lost_ns, topic=topic, message=message)

    def skip(self, lost_ns: int) -> None:
        """Let ``lost_ns`` pass in which the body stands still: all that is to come happens later."""
        self._body.skip(lost_ns)
        self._lost_ns += lost_ns

    def _sample(self) -> None:
        now_ns, order = self._due[0]
        self._body.advance_to(now_ns + self._lost_ns)
        for arrival_ns, topic, message in self._clocks[order].publish(self._body):
            self._serial += 1
            heapq.heappush(self._under_way, (arrival_ns, self._serial, topic, message))
        heapq.heapreplace(self._due, (self._clocks[order].next_ns, order))


class _DeviceClock(Generic[BodyT]):
    """When a device is sampled, and when what it says arrives.

    Sample i is taken at (i + phase) / rate; each message arrives a transport time later, plus the
    absolute value of Gaussian noise of 2 % of the period.
    """

    __slots__ = ("_count", "_device", "_first_ns", "_noise", "_period_ns", "next_ns")

    def __init__(
        self, device: Device[BodyT], start_ns: int, phase: float, noise: np.random.Generator
    ) -> None:
        self._device = device
        self._noise = _normal(noise)
        self._period_ns = NS_PER_S / device.rate_hz
        self._first_ns = start_ns + round(phase * self._period_ns)
        self._count = 0
        self.next_ns = self._first_ns

    def publish(self, body: BodyT) -> Iterator[tuple[int, RobotTopic, object]]:
        """Sample the device, and set the time of the next sample."""
        now_ns = self.next_ns
        self._count += 1
        self.next_ns = self._first_ns + round(self._count * self._period_ns)
        for topic, message in self._device.sample(body):
            share = min(abs(next(self._noise)) * _JITTER, _MAX_JITTER)
            yield now_ns + _TRANSPORT_NS + round(share * self._period_ns), topic, message


def _normal(noise: np.random.Generator) -> Iterator[float]:
    """Gaussian numbers of ``noise``, which is asked for many at once, for that takes a tenth of the time."""
    while True:
        yield from noise.standard_normal(_DRAWN_AT_ONCE).tolist()


def _clocks(
    devices: Sequence[Device[BodyT]], start_ns: int, seed: int, together: Sequence[tuple[type, type]]
) -> Sequence[_DeviceClock[BodyT]]:
    """A clock for each device, with noise of its own, so that none depends on another."""
    timing = [np.random.default_rng([seed, order, 1]) for order in range(len(devices))]
    phases = [noise.random() for noise in timing]
    kinds = [type(device) for device in devices]
    for follower, leader in together:
        phases[kinds.index(follower)] = phases[kinds.index(leader)]
    return [
        _DeviceClock(device, start_ns, phase, noise)
        for device, phase, noise in zip(devices, phases, timing, strict=True)
    ]
