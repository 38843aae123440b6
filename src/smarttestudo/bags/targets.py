# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Target of a topic over a run, as one number."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from smarttestudo.domain.decision import Decision
from smarttestudo.domain.rate import Rate


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetSpan:
    """From ``start_s`` to ``end_s`` a topic's planned rate was ``rate``."""

    start_s: float
    end_s: float
    rate: Rate


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """Time-weighted means of a topic's planned rate, in Hz.

    ``planned_hz`` is that of the rates as planned, Full counting as the source's; ``attainable_hz`` that of
    the lesser of planned rate and the source's mean, which is what a relay of an even source can reach. It is
    ``None`` of transforms, whose planned rate is that of each frame.
    """

    planned_hz: float
    attainable_hz: float | None


def target_spans(decisions: Iterable[Decision], end_s: float) -> tuple[TargetSpan, ...]:
    """The planned rates of the one topic that ``decisions`` are about, from the first to ``end_s``."""
    ordered = sorted(decisions, key=lambda decision: decision.t_s)
    ends_s = [*(decision.t_s for decision in ordered), end_s][1:]
    return tuple(
        TargetSpan(start_s=decision.t_s, end_s=min(until_s, end_s), rate=decision.planned.rate)
        for decision, until_s in zip(ordered, ends_s, strict=True)
        if decision.t_s < min(until_s, end_s)
    )


def mean_target(spans: Sequence[TargetSpan], source_hz: float | None) -> Target | None:
    """The means over ``spans`` of a source of ``source_hz``; ``None`` where they are not determined."""
    duration_s = sum(span.end_s - span.start_s for span in spans)
    if duration_s <= 0 or (source_hz is None and any(span.rate.is_full for span in spans)):
        return None
    planned = attainable = 0.0
    for span in spans:
        planned_hz = source_hz if span.rate.is_full and source_hz is not None else span.rate.hz
        attainable_hz = planned_hz if source_hz is None else min(planned_hz, source_hz)
        planned += planned_hz * (span.end_s - span.start_s)
        attainable += attainable_hz * (span.end_s - span.start_s)
    return Target(planned_hz=planned / duration_s, attainable_hz=attainable / duration_s)
