# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Loss of a topic at each rate, from a bag."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from msgspec import Struct

from smarttestudo.accuracy import curve as loss
from smarttestudo.accuracy.curve import measure_curves
from smarttestudo.ruler.topics.profile_table import SixLevels, six_levels


class CurveRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/curve`` → ``Curve``: the loss of ``topic`` at each rate, from a bag.

    ``POST /api/profile/accuracy`` → ``AccuracyNeeds``: what the accuracies of ``topic`` need.
    ``run`` names the work in ``Progress`` messages of ``/ws``.
    """

    bag: str
    topic: str
    run: str = ""


class LossPoint(Struct, frozen=True, kw_only=True):
    """The topic at one rate: what it carries, and the RMSE of its worst field in percent of that's range.

    ``error_percent`` and ``worst_field`` are null where nothing known passed, ``age_mean_s`` where nothing.
    """

    rate_hz: float
    kb_per_s: float
    error_percent: float | None
    worst_field: str | None
    age_mean_s: float | None


class Curve(Struct, frozen=True, kw_only=True):
    """The curve at rising rates up to the source's, and the six levels where it bends.

    Without points, no field of the topic ever changed; without ``tiers_hz``, none can be proposed.
    """

    source_hz: float | None = None
    points: tuple[LossPoint, ...] = ()
    tiers_hz: SixLevels | None = None
    notices: tuple[str, ...] = ()


def measured_curve(bag: Path, topic: str, report: Callable[[float], None]) -> Curve:
    """The curve of ``topic``; ``report`` gets the share done. Raises ``RecordingError``."""
    curves = measure_curves(bag, topics=[topic], report=report)
    notices = tuple(curves.notices)
    curve = next(iter(curves.curves), None)
    if curve is None:
        return Curve(notices=notices)
    proposal = curve.breakpoints
    return Curve(
        source_hz=curve.source_hz,
        points=tuple(_point(point, curve) for point in curve.points),
        tiers_hz=six_levels(proposal.tiers_hz) if proposal else None,
        notices=notices,
    )


def _point(point: loss.CurvePoint, curve: loss.LossCurve) -> LossPoint:
    _, relative, field = loss.worst_loss(point, curve.fields)
    is_known = any(point.errors)
    return LossPoint(
        rate_hz=point.rate_hz,
        kb_per_s=point.kb_per_s,
        error_percent=100 * relative if is_known else None,
        worst_field=field if is_known else None,
        age_mean_s=point.age.mean_s if point.age else None,
    )
