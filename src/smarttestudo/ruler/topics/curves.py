# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Loss of a topic at each rate, and the rates that its accuracies need, from a recording."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from msgspec import Struct

from smarttestudo.accuracy import accuracy_curve
from smarttestudo.accuracy.curve import CurvePoint, LossCurve, measure_curves, worst_loss
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.names import is_topic_name, resolve_topic
from smarttestudo.domain.profile import LevelledProperty, Profile
from smarttestudo.domain.recording import types_of_topics
from smarttestudo.optimizer.profiling import PROPOSED_BOUNDS, bounds_need_hz, levelled_properties
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.files.recordings import READING
from smarttestudo.ruler.job import Report, RequestError, job
from smarttestudo.ruler.topics.profiles import SixLevels, six_levels


class CurveRequest(Struct, frozen=True, kw_only=True):
    """A topic of a bag; ``run`` names the job in ``Progress`` messages of ``/ws``."""

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


@job("POST /api/profile/curve", reads=True, limit=READING)
def measured_curve(request: CurveRequest, folder: ProjectFolder, report: Report) -> Curve:
    """The curve of a topic. Raises ``RecordingError``."""
    bag, topic = folder.bag(request.bag), _topic(request)
    curves = measure_curves(bag, topics=[topic], report=report)
    notices = tuple(map(folder.shown, curves.notices))
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


def _topic(request: CurveRequest) -> str:
    if not is_topic_name(request.topic):
        raise RequestError(f"{request.topic!r} is not a valid ROS 2 topic name", 400)
    return resolve_topic(request.topic)


def _point(point: CurvePoint, curve: LossCurve) -> LossPoint:
    _, relative, field = worst_loss(point, curve.fields)
    is_known = any(point.errors)
    return LossPoint(
        rate_hz=point.rate_hz,
        kb_per_s=point.kb_per_s,
        error_percent=100 * relative if is_known else None,
        worst_field=field if is_known else None,
        age_mean_s=point.age.mean_s if point.age else None,
    )


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


@job("POST /api/profile/accuracy", reads=True, limit=READING)
def measured_needs(request: CurveRequest, folder: ProjectFolder, report: Report) -> AccuracyNeeds:
    """Measure what a topic needs. Raises ``RecordingError``."""
    bag, topic = folder.bag(request.bag), _topic(request)
    with open_recording(bag) as recording:
        types = types_of_topics(recording.channels)
    if topic not in types:
        raise RecordingError(
            f"the recording has no topic {topic}", place=str(bag), remedy="choose another one"
        )
    wanted = [
        accuracy_curve.WantedProperty(name=one.value, unit=one.unit, bounds=PROPOSED_BOUNDS[one])
        for one in levelled_properties(types[topic])
    ]
    curves, notices = accuracy_curve.measure_accuracy(bag, {topic: wanted}, Profile(), report)
    source_hz = next((one.source_hz for one in curves), None)
    return AccuracyNeeds(
        source_hz=source_hz,
        properties=tuple(_needs(one, one.source_hz) for one in curves if one.source_hz),
        notices=tuple(map(folder.shown, notices)),
    )


def _needs(measured: accuracy_curve.AccuracyCurve, source_hz: float) -> PropertyNeeds:
    def rates_hz(prices: Sequence[accuracy_curve.BoundCost]) -> tuple[float, ...]:
        return bounds_need_hz([one.within.messages for one in prices], measured.messages, source_hz)

    reckoned = [one.reckoned for one in measured.points if one.reckoned]
    points = itertools.zip_longest(
        measured.points, rates_hz([one.hold for one in measured.points]), rates_hz(reckoned)
    )
    levelled = LevelledProperty(measured.property_name)
    return PropertyNeeds(
        property=levelled,
        unit=levelled.unit,
        points=tuple(
            BoundNeed(bound=point.bound, hold_hz=hold_hz, reckoned_hz=reckoned_hz)
            for point, hold_hz, reckoned_hz in points
        ),
    )
