# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Sources in virtual time, and what a pacer relays of them."""

from __future__ import annotations

import random
from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass

from hypothesis import strategies as st

from smarttestudo.pacing.sample import Pacer, Pass, Sample

S = 1_000_000_000
EPOCH_NS = 1_795_230_365 * S

seeds = st.integers(0, 2**32 - 1)
source_rates = st.floats(0, 3).map(lambda exponent: 10**exponent)
"""1 … 1000 Hz, as many slow ones as fast ones."""
shares = st.one_of(st.floats(0.01, 1), st.floats(0.9, 1), st.floats(-4, -1).map(lambda e: 1 - 10**e))
"""Targets as shares of their source, many of them close to it."""


@dataclass(frozen=True, slots=True)
class Relayed:
    """What left a relay, and when."""

    at_ns: int
    sample: Sample
    repeated: bool


def sample(publisher: Hashable = None, frames: tuple[str, ...] = (), stamp: bytes | None = None) -> Sample:
    return Sample(payload=b"", size_bytes=0, publisher=publisher, frames=frames, stamp=stamp)


def samples_at(times_ns: Iterable[int]) -> list[tuple[int, Sample]]:
    return [(at_ns, sample()) for at_ns in times_ns]


def jittered(source_hz: float, seconds: float, rng: random.Random) -> list[int]:
    """Arrival i at (i + u) / source_hz with |u| <= 0.2."""
    count = int(seconds * source_hz) + 1
    return [EPOCH_NS + round(S * (i + rng.uniform(-0.2, 0.2)) / source_hz) for i in range(count)]


def relay(
    pacer: Pacer,
    arrivals: Sequence[tuple[int, Sample]],
    changes: Sequence[tuple[int, float]] = (),
    *,
    drain: bool = True,
) -> list[Relayed]:
    """Offer every arrival, set every rate, wake the pacer when it asks, and drain it at the end."""
    relayed: list[Relayed] = []
    pending = list(changes)
    for at_ns, offered in arrivals:
        while pending and pending[0][0] <= at_ns:
            changed_ns, rate_hz = pending.pop(0)
            relayed += woken(pacer, changed_ns)
            pacer.set_rate(rate_hz, changed_ns)
        relayed += woken(pacer, at_ns)
        relayed += _at(at_ns, pacer.offer(offered, at_ns))
    if drain:
        pacer.finish()
        relayed += woken(pacer, None)
    return relayed


def woken(pacer: Pacer, until_ns: int | None) -> list[Relayed]:
    """What the pacer relays of its own accord up to ``until_ns``, or until nothing waits."""
    relayed: list[Relayed] = []
    while (wake_ns := pacer.wake_ns) is not None and (until_ns is None or wake_ns <= until_ns):
        relayed += _at(wake_ns, pacer.wake(wake_ns))
        assert pacer.wake_ns is None or pacer.wake_ns > wake_ns
    return relayed


def _at(at_ns: int, passes: Sequence[Pass]) -> list[Relayed]:
    return [Relayed(at_ns, passed.sample, passed.repeated) for passed in passes]
