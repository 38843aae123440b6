# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Both ends in virtual time over a radio: rate, a short queue, jitter, loss in runs, copies, outages."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial

from link.protocol.simulated_link import MS, Ends, Link, Source
from smarttestudo.link.protocol.messages import REPORTS, Announcement, Report

HEAD_BYTES = 60
"""The heads of IP and UDP, and the seal."""
RUN = 3.0
"""How many datagrams in a row are lost, on average."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """One way of a radio; where it ``reorders``, what has less jitter goes before what has more."""

    delay_ms: float
    jitter_ms: float
    lost_percent: float
    mbit_per_s: float
    queue_bytes: int = 64_000
    copied_percent: float = 0.0
    reorders: bool = False


PROFILES = {
    "starlink": Profile(delay_ms=30, jitter_ms=10, lost_percent=2, mbit_per_s=15),
    "4g": Profile(delay_ms=50, jitter_ms=15, lost_percent=3, mbit_per_s=10),
    "wifi-walls": Profile(delay_ms=15, jitter_ms=10, lost_percent=8, mbit_per_s=2),
    "severe": Profile(delay_ms=100, jitter_ms=30, lost_percent=5, mbit_per_s=2),
    "clean": Profile(delay_ms=1, jitter_ms=0, lost_percent=0, mbit_per_s=2),
}


@dataclass
class Radio:
    """One way: when copies of a datagram arrive, if any does. ``outages`` are in ns."""

    profile: Profile
    seed: int = 1
    outages: Sequence[tuple[int, int]] = ()
    free_ns: float = 0.0
    last_ns: int = 0
    is_in_run: bool = False
    sent: int = 0
    lost: int = 0
    overflowed: int = 0
    carried_bytes: int = 0

    def __post_init__(self) -> None:
        self.random = random.Random(self.seed)

    def arrivals_ns(self, size_bytes: int, now_ns: int) -> list[int]:
        one, size_bytes = self.profile, size_bytes + HEAD_BYTES
        share = one.lost_percent / 100
        ends = self.random.random() < 1 / RUN
        begins = self.random.random() < share / (1 - share) / RUN
        self.is_in_run = not ends if self.is_in_run else begins
        bytes_per_ns = one.mbit_per_s / 8_000
        self.sent += 1
        if (max(self.free_ns, now_ns) - now_ns) * bytes_per_ns + size_bytes > one.queue_bytes:
            self.overflowed += 1
            return []
        self.free_ns = max(self.free_ns, now_ns) + size_bytes / bytes_per_ns
        if self.is_in_run or any(from_ns <= now_ns < to_ns for from_ns, to_ns in self.outages):
            self.lost += 1
            return []
        self.carried_bytes += size_bytes
        copies = 1 + (self.random.random() < one.copied_percent / 100)
        return [self._arrival_ns() for _ in range(copies)]

    def _arrival_ns(self) -> int:
        one = self.profile
        jitter_ms = self.random.uniform(-one.jitter_ms, one.jitter_ms)
        at_ns = int(self.free_ns + max(one.delay_ms + jitter_ms, 0) * MS)
        if not one.reorders:
            at_ns = self.last_ns = max(at_ns, self.last_ns)
        return at_ns


@dataclass
class LossyEnds(Ends):
    """Both ends: what goes as a datagram goes over the radios, the rest over ``link``."""

    up: Radio = field(default_factory=lambda: Radio(PROFILES["clean"]))
    down: Radio = field(default_factory=lambda: Radio(PROFILES["clean"], seed=2))
    has_datagrams: bool = True
    wake_ns: int = 2**62

    def run(self, seconds: float) -> None:
        if self.has_datagrams:
            self.sender.allow_datagrams(frozenset({7}))
        super().run(seconds)

    def _pump(self, now_ns: int) -> None:
        scheduler = self.sender.scheduler
        while (data := scheduler.next_chunk(now_ns)) is not None:
            if scheduler.is_by_datagrams:
                for at_ns in self.up.arrivals_ns(len(data), now_ns):
                    self.at(at_ns, partial(self._arrive_datagram, data))
            else:
                self.at(self.link.arrival_ns(len(data), now_ns), partial(self._arrive, data))
        wake_ns = scheduler.wake_ns(now_ns)
        if wake_ns is not None and (wake_ns < self.wake_ns or self.wake_ns <= now_ns):
            self.wake_ns = max(wake_ns, now_ns + 1)
            self.at(self.wake_ns, lambda _now_ns: None)

    def _arrive_datagram(self, data: bytes, now_ns: int) -> None:
        for got in self.receiver.receive_datagram(data, now_ns):
            if not isinstance(got, Announcement):
                self.arrived[got.stream.topic].append((now_ns, got))
        self._report_soon(now_ns)

    def _report(self, now_ns: int) -> None:
        if not self.receiver.is_by_datagrams:
            super()._report(now_ns)
            return
        if now_ns < self.receiver.wake_ns or now_ns != self._report_ns:
            return
        data = self.receiver.next_report(now_ns)
        report: Report = REPORTS.from_bytes(data)
        for at_ns in self.down.arrivals_ns(len(data), now_ns):
            self.at(at_ns, partial(self._take_report, report))
        self._report_ns = 2**62
        self._report_soon(now_ns)


def lossy_ends(profile: Profile, sources: Sequence[Source], seed: int = 1) -> LossyEnds:
    """Both ends over a radio that is alike either way; the reliable link beside it loses nothing."""
    link = Link(((0.0, profile.mbit_per_s * 125_000),), profile.delay_ms / 1_000)
    return LossyEnds(link, sources, up=Radio(profile, seed), down=Radio(profile, seed + 1))
