# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks about the quality levels of one topic, in JSON."""

from __future__ import annotations

from msgspec import Struct

SixRates = tuple[float, float, float, float, float, float]


class CurveRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/curve`` → ``CurveAnswer``: the loss of ``topic`` at each rate, from a bag.

    ``run`` names the work in ``Progress`` messages of ``/ws``.
    """

    bag: str
    topic: str
    run: str = ""


class CurvePointModel(Struct, frozen=True, kw_only=True):
    """The topic at one rate: what it carries, and the RMSE of its worst field in percent of that's range.

    ``error_percent`` and ``worst_field`` are null where nothing known passed, ``age_mean_s`` where nothing.
    """

    rate_hz: float
    kb_per_s: float
    error_percent: float | None
    worst_field: str | None
    age_mean_s: float | None


class CurveAnswer(Struct, frozen=True, kw_only=True):
    """The curve at rising rates up to the source's, and the six levels where it bends.

    Without points, no field of the topic ever changed; without ``tiers_hz``, none can be proposed.
    """

    source_hz: float | None = None
    points: tuple[CurvePointModel, ...] = ()
    tiers_hz: SixRates | None = None
    notices: tuple[str, ...] = ()


class ProfileCheckAnswer(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/check`` (a ``ProfileWriteRequest``): why it cannot be written; empty if it can."""

    problem: str


class LevelsRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/levels`` → ``LevelsAnswer``: six levels for a source of ``source_hz``."""

    source_hz: float


class LevelsAnswer(Struct, frozen=True, kw_only=True):
    """A first guess from the rate alone."""

    tiers_hz: SixRates
