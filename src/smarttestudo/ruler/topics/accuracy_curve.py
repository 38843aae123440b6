# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates that the accuracies of a topic need, from a bag."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from pathlib import Path

from msgspec import Struct

from smarttestudo.accuracy import accuracy_curve as loss
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.profile import LevelledProperty, Profile
from smarttestudo.domain.recording import types_of_topics
from smarttestudo.optimizer.profiling import PROPOSED_BOUNDS, bounds_need_hz, levelled_properties


class BoundNeed(Struct, frozen=True, kw_only=True):
    """How many messages per s keep within ``bound``, with hold and with dead reckoning.

    ``reckoned_hz`` is null where nothing can be reckoned. A wider bound may need a message more by chance: it
    counts as the tighter one does.
    """

    bound: float
    hold_hz: float
    reckoned_hz: float | None


class PropertyNeeds(Struct, frozen=True, kw_only=True):
    """A property at the six bounds that are usual for it, the widest first, in ``unit``: m, deg or rad."""

    property: LevelledProperty
    unit: str
    points: tuple[BoundNeed, ...]


class AccuracyNeeds(Struct, frozen=True, kw_only=True):
    """The properties of a topic that changed, beside the rate of its source."""

    source_hz: float | None
    properties: tuple[PropertyNeeds, ...]
    notices: tuple[str, ...] = ()


def measured_needs(bag: Path, topic: str, report: Callable[[float], None]) -> AccuracyNeeds:
    """Measure what ``topic`` needs; ``report`` gets the share done. Raises ``RecordingError``."""
    with open_recording(bag) as recording:
        types = types_of_topics(recording.channels)
    if topic not in types:
        raise RecordingError(
            f"the recording has no topic {topic}", place=str(bag), remedy="choose another one"
        )
    wanted = [
        loss.WantedProperty(name=one.value, unit=one.unit, bounds=PROPOSED_BOUNDS[one])
        for one in levelled_properties(types[topic])
    ]
    curves, notices = loss.measure_accuracy(bag, {topic: wanted}, Profile(), report)
    source_hz = next((one.source_hz for one in curves), None)
    return AccuracyNeeds(
        source_hz=source_hz,
        properties=tuple(_needs(one, one.source_hz) for one in curves if one.source_hz),
        notices=notices,
    )


def _needs(curve: loss.AccuracyCurve, source_hz: float) -> PropertyNeeds:
    def rates_hz(prices: Sequence[loss.BoundCost]) -> tuple[float, ...]:
        return bounds_need_hz([one.within.messages for one in prices], curve.messages, source_hz)

    reckoned = [one.reckoned for one in curve.points if one.reckoned]
    points = itertools.zip_longest(
        curve.points, rates_hz([one.hold for one in curve.points]), rates_hz(reckoned)
    )
    levelled = LevelledProperty(curve.property_name)
    return PropertyNeeds(
        property=levelled,
        unit=levelled.unit,
        points=tuple(
            BoundNeed(bound=point.bound, hold_hz=hold_hz, reckoned_hz=reckoned_hz)
            for point, hold_hz, reckoned_hz in points
        ),
    )
