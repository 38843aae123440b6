# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Fixed rates beside other ways to send: for as many bytes, or as many messages."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from smarttestudo.accuracy.samples import TopicSamples
from smarttestudo.accuracy.track import thinned
from smarttestudo.domain.profile import TopicProfile
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.optimizer.problem import Demand, Piece, allocate, envelope_pieces, round_down
from smarttestudo.optimizer.profiling import proposed_tiers_hz
from smarttestudo.pacing.sample import StreamKind

_WHOLE = 1 - 1e-9
_TRIES = 4
_NEAR_ENOUGH = 0.01
_HALVINGS = 16


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """A topic as it was sent: all its bytes, its mean rate from first to last message, and its profile.

    ``mean_hz`` is ``None`` where one message or stamp leaves it undefined.
    """

    topic: str
    size_bytes: int
    mean_hz: float | None
    entry: TopicProfile


def best_fixed_rates(sources: Sequence[Source], budget_bytes: float) -> dict[str, float]:
    """The rates in Hz of the greatest benefit that carry ``budget_bytes`` in all; infinite passes everything.

    It is OBI's benefit model, with the tiers of the profile or those proposed from the source's rate, and
    without floors. What is left once every topic is at its τ4 raises them to their source, the smallest
    messages first. A topic without a rate is passed whole.
    """
    paced = [source for source in sources if source.mean_hz]
    rates = {source.topic: math.inf for source in sources}
    whole_bytes = sum(source.size_bytes for source in sources if source not in paced)
    limit_kb = max(0.0, budget_bytes - whole_bytes) / BYTES_PER_KB
    by_benefit = _allocated([_demand(source) for source in paced], limit_kb)
    filled = [
        _demand(source)._replace(least_hz=hz, pieces=(Piece(max(0.0, _source_hz(source) - hz), 1.0),))
        for source, hz in zip(paced, by_benefit, strict=True)
    ]
    for source, hz in zip(paced, _allocated(filled, limit_kb), strict=True):
        if hz < _WHOLE * _source_hz(source):
            rates[source.topic] = round_down(hz)
    return rates


def _demand(source: Source) -> Demand:
    """The source in the terms of OBI; what one Hz costs is counted in KB over the whole recording."""
    source_hz = _source_hz(source)
    tiers_hz = source.entry.tiers_hz or proposed_tiers_hz(source_hz)
    return Demand(
        topic=source.topic,
        size_kb=source.size_bytes / BYTES_PER_KB / source_hz,
        least_hz=0.0,
        pieces=envelope_pieces(tiers_hz, least_hz=0.0, most_hz=source_hz, priority=source.entry.priority),
    )


def _allocated(demands: Sequence[Demand], limit_kb: float) -> list[float]:
    best = allocate(demands, limit_kb)
    return [best.rates_hz[one.topic] if best else one.least_hz for one in demands]


def _source_hz(source: Source) -> float:
    return source.mean_hz or 0.0


def rate_of_bytes(samples: TopicSamples, size_bytes: int, end_ns: int) -> float:
    """The fixed rate that carries about so many bytes of a topic, infinite for all.

    Named streams, such as transforms, have the rate for each. Slow ones pass whole, so that bytes are not in
    proportion to rates: theirs, which is not above the mean rate of the topic, is found by halving.
    """
    share = size_bytes / samples.size_bytes if samples.size_bytes else 1.0
    source_hz = samples.mean_hz
    if share >= 1 or not source_hz:
        return math.inf
    if samples.kind is not StreamKind.NAMED:
        return share * source_hz
    low_hz, high_hz = 0.0, source_hz
    for _ in range(_HALVINGS):
        rate_hz = (low_hz + high_hz) / 2
        passed = thinned(samples.stamps_ns, rate_hz, end_ns=end_ns, kind=samples.kind, frames=samples.frames)
        passed_bytes = sum(samples.sizes[index] for index in passed.indices)
        low_hz, high_hz = (rate_hz, high_hz) if passed_bytes <= size_bytes else (low_hz, rate_hz)
    return low_hz


def rate_of_messages(
    messages: int,
    stamps_ns: Sequence[int],
    *,
    end_ns: int,
    kind: StreamKind,
    frames: Sequence[tuple[str, ...]],
) -> float:
    """The fixed rate at which about so many of the messages at ``stamps_ns`` pass, infinite for all.

    Named streams, such as transforms, have the rate for each: messages at a rate must be counted.
    """
    lasted_s = (end_ns - stamps_ns[0]) / NS_PER_S if stamps_ns else 0.0
    if messages >= len(stamps_ns) or not lasted_s:
        return math.inf
    rate_hz = max(messages - 1, 1) / lasted_s
    for _ in range(_TRIES):
        passed = len(thinned(stamps_ns, rate_hz, end_ns=end_ns, kind=kind, frames=frames).indices)
        if abs(passed - messages) <= max(1, _NEAR_ENOUGH * messages):
            break
        rate_hz *= messages / passed
    return rate_hz
