# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loss of topics at each rate, the rates where it changes most, and what accuracies need."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve, accuracies, accuracy_wanted, geometry_of
from smarttestudo.accuracy.loss_report import Age, ErrorSize, FieldError
from smarttestudo.accuracy.measure import age_of
from smarttestudo.accuracy.reconstruction import field_error
from smarttestudo.accuracy.recorded_samples import TopicReading, joined, read_samples, require_numbers
from smarttestudo.accuracy.samples import BULK_TYPES, Field, TopicSamples, fields_of
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.topic_selection import select_topics
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.rate import RATE_STEP_HZ
from smarttestudo.domain.record import JsonEntry, derived, to_columns
from smarttestudo.domain.recording import robots_own, types_of_topics
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.optimizer.profiling import TierProposal, rounded

LEVELS = (0.2, 0.1, 0.05, 0.02, 0.01)
"""Error relative to the field's range at τ0 … τ4."""

_SLOWEST_SOURCE_HZ = (len(LEVELS) + 1) * RATE_STEP_HZ

Loss = tuple[float, float, str]
"""A rate in Hz, the relative hold RMSE of the worst field there, and that field."""


def proposed_breakpoints(losses: Sequence[Loss], source_hz: float) -> TierProposal | None:
    """Six thresholds from a loss curve.

    τ0 … τ4 are the rates from which on who holds the last value errs by at most 20, 10, 5, 2, 1 % of the
    field's range (RMSE, the worst field counts); τ5 is the source's rate, at which nothing is lost.

    ``losses`` are those at some rates below ``source_hz``, in any order.
    Between two rates, and below the lowest, the error counts as linear in the period 1/f, which it is for
    a signal that changes slowly. The thresholds rise by 0.001 Hz or more and do not exceed the source.
    ``None`` where nothing is lost at any rate, or the source is too slow for six thresholds.
    """
    source_hz = rounded(source_hz)
    curve = _rising_curve(losses, source_hz)
    if source_hz < _SLOWEST_SOURCE_HZ or curve[-1][1] <= 0:
        return None
    found = [_period_at(level, curve) for level in LEVELS]
    tiers_hz = _strictly_rising([*(rounded(1 / period_s) for period_s, _ in found), source_hz])
    worst = ", ".join(dict.fromkeys(field for _, field in found))
    levels = ", ".join(f"{100 * level:g}" for level in LEVELS)
    return TierProposal(
        tiers_hz=tiers_hz, origin=f"RMSE of holding: {levels} % of the range (worst: {worst}), 0 at source_hz"
    )


def _rising_curve(losses: Sequence[Loss], source_hz: float) -> list[Loss]:
    """Period in s, error and field, with both rising: an error that falls again at a lower rate is luck."""
    curve: list[Loss] = [(1 / source_hz, 0.0, "")]
    for rate_hz, error, field in sorted(losses, reverse=True):
        if rate_hz < source_hz:
            _, before, worst_before = curve[-1]
            curve.append(
                (1 / rate_hz, error, field) if error > before else (1 / rate_hz, before, worst_before)
            )
    return curve


def _period_at(level: float, curve: Sequence[Loss]) -> tuple[float, str]:
    """The period at which the error reaches ``level``, and the field that does."""
    for (short_s, below, _), (long_s, above, field) in itertools.pairwise(curve):
        if above > level:
            return short_s + (level - below) / (above - below) * (long_s - short_s), field
    longest_s, error, field = curve[-1]
    return longest_s * level / error, field


def _strictly_rising(rates_hz: Sequence[float]) -> tuple[float, ...]:
    """``rates_hz``, which do not fall, with 0.001 Hz between those that would be nearer."""
    apart: list[float] = []
    for rate_hz in reversed(rates_hz):
        below = apart[-1] - RATE_STEP_HZ if apart else rate_hz
        apart.append(round(min(rate_hz, below), 9))
    lowest = [(index + 1) * RATE_STEP_HZ for index in range(len(apart))]
    return tuple(round(max(rate, least), 9) for rate, least in zip(reversed(apart), lowest, strict=True))


_LOWEST_HZ = 0.1
_SLOW_SHARE = 0.02
_FEWEST_MESSAGES = 4
_BELOW_SOURCE = 0.95


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldAtRate:
    """The error of a field, in ``unit``."""

    unit: str
    error: Annotated[FieldError, JsonEntry(is_merged=True)]


@dataclass(frozen=True, slots=True, kw_only=True)
class CurvePoint:
    """A topic at one rate: what it carries, its age, and the error of each of the curve's fields.

    An error is ``None`` where nothing known of the field passed.
    """

    rate_hz: Annotated[float, JsonEntry(name="hz")]
    kb_per_s: float
    age: Age | None
    fields: Annotated[tuple[Field, ...], JsonEntry(is_absent=True)]
    errors: Annotated[tuple[FieldError | None, ...], JsonEntry(is_absent=True)]

    @property
    @derived("fields")
    def known_errors(self) -> dict[str, FieldAtRate]:
        """The errors that are known, by the field's name."""
        pairs = zip(self.fields, self.errors, strict=True)
        return {one.name: FieldAtRate(unit=one.unit, error=error) for one, error in pairs if error}


@dataclass(frozen=True, slots=True, kw_only=True)
class LossCurve:
    """The loss at rising rates, up to ``source_hz``, where every message passes and nothing is lost.

    ``fields`` are those that ever changed; ``breakpoints`` is ``None`` where none can be proposed.
    """

    topic: str
    source_hz: float
    fields: Annotated[tuple[Field, ...], JsonEntry(is_absent=True)]
    points: tuple[CurvePoint, ...]
    breakpoints: Annotated[TierProposal | None, JsonEntry(is_absent=True)]

    @property
    @derived()
    def tiers_hz(self) -> tuple[float, ...] | None:
        """Levels that are proposed."""
        return self.breakpoints.tiers_hz if self.breakpoints else None

    @property
    @derived()
    def tiers_from(self) -> str | None:
        """Origin of these."""
        return self.breakpoints.origin if self.breakpoints else None

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each rate and field, for ``--csv``."""
        for point in self.points:
            for field, error in zip(self.fields, point.errors, strict=True):
                row = CurveRow(
                    topic=self.topic,
                    field=field.name,
                    unit=field.unit,
                    rate_hz=point.rate_hz,
                    kb_per_s=point.kb_per_s,
                    hold=error.hold if error else None,
                    interpolated=error.interpolated if error else None,
                )
                yield to_columns(row)


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveRow:
    """A field at one rate as a row."""

    topic: str
    field: str
    unit: str
    rate_hz: Annotated[float, JsonEntry(name="hz")]
    kb_per_s: float
    hold: ErrorSize | None
    interpolated: ErrorSize | None


def loss_curve(samples: TopicSamples, end_ns: int) -> LossCurve | None:
    """The curve of a topic; ``None`` where no field ever changed, or there is no rate."""
    fields = tuple(field for field in samples.fields if samples.series(field).value_range)
    source_hz = samples.mean_hz
    if not fields or source_hz is None:
        return None
    duration_s = (end_ns - samples.stamps_ns[0]) / NS_PER_S
    points = tuple(
        _point(samples, fields, rate_hz, end_ns) for rate_hz in curve_rates_hz(source_hz, duration_s)
    )
    losses = [worst_loss(point, fields) for point in points[:-1]]
    return LossCurve(
        topic=samples.channel.topic,
        source_hz=source_hz,
        fields=fields,
        points=points,
        breakpoints=proposed_breakpoints(losses, source_hz),
    )


def curve_rates_hz(source_hz: float, duration_s: float) -> tuple[float, ...]:
    """0.1, 0.2, 0.5, 1, 2, 5 … Hz below the source, and the source's own rate.

    Slow sources start at 2 % of their rate. The lowest rate has four messages in ``duration_s``.
    """
    lowest_hz = max(min(_LOWEST_HZ, _SLOW_SHARE * source_hz), _FEWEST_MESSAGES / duration_s, RATE_STEP_HZ)
    steps = (digit * 10.0**power for power in itertools.count(-3) for digit in (1, 2, 5))
    below = itertools.takewhile(lambda rate_hz: rate_hz < _BELOW_SOURCE * source_hz, steps)
    return (*(round(rate_hz, 3) for rate_hz in below if rate_hz >= lowest_hz), source_hz)


def _point(samples: TopicSamples, fields: tuple[Field, ...], rate_hz: float, end_ns: int) -> CurvePoint:
    passed = samples.at_rate(math.inf if rate_hz == samples.mean_hz else rate_hz, end_ns)
    errors = (field_error(samples.series(field), passed.series(field), end_ns) for field in fields)
    duration_s = (end_ns - samples.stamps_ns[0]) / NS_PER_S
    return CurvePoint(
        rate_hz=rate_hz,
        kb_per_s=passed.size_bytes / BYTES_PER_KB / duration_s,
        age=age_of(passed.stamps_ns, sent_from_ns=samples.stamps_ns[0], end_ns=end_ns),
        fields=fields,
        errors=tuple(errors),
    )


def worst_loss(point: CurvePoint, fields: tuple[Field, ...]) -> Loss:
    """The relative hold RMSE of the worst of ``fields`` at the rate of ``point``."""
    relative, field = max(
        ((error.hold.relative_rmse or 0.0) if error else 0.0, field.name)
        for error, field in zip(point.errors, fields, strict=True)
    )
    return point.rate_hz, relative, field


_SHARE_OF_READING = 0.6
_SHARE_OF_RATES = 0.4


@dataclass(frozen=True, slots=True, kw_only=True)
class LossCurves:
    """The curves of a recording called ``name``, by topic name; ``without`` are topics that have none.

    ``accuracies`` are those of messages against accuracy, empty where they were not asked for.
    """

    name: Annotated[str, JsonEntry(name="bag")]
    curves: Annotated[tuple[LossCurve, ...], JsonEntry(name="topics", keyed_by="topic")]
    without: tuple[str, ...]
    notices: tuple[str, ...]
    accuracies: Annotated[tuple[AccuracyCurve, ...], JsonEntry(name="accuracy")] = ()

    def accuracies_of(self, topic: str) -> tuple[AccuracyCurve, ...]:
        """The accuracy curves of one topic."""
        return tuple(curve for curve in self.accuracies if curve.topic == topic)

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each topic, rate and field, for ``--csv``."""
        for curve in self.curves:
            yield from curve.rows()


def measure_curves(
    bag: Path,
    *,
    topics: Sequence[str] = (),
    fields: Mapping[str, Sequence[str]] | None = None,
    profile: Profile | None = None,
    with_accuracy: bool = False,
    report: Callable[[float], None] = lambda _: None,
) -> LossCurves:
    """The loss at rates up to the source's, of ``topics`` (names or patterns, all if empty).

    ``fields`` are the only ones looked at of the topics in it. ``with_accuracy`` adds what bounds cost.
    ``report`` gets the share done.

    Raises:
        RecordingError: the recording cannot be read; a topic or field does not exist.
    """
    fields, profile = fields or {}, profile or Profile()
    share = _SHARE_OF_RATES if with_accuracy else 1.0
    with open_recording(bag) as recording:
        types = types_of_topics(robots_own(recording.channels))
        patterns = [*topics, *fields]
        chosen = sorted(select_topics(patterns, types, place=str(bag)) if patterns else types)
        readings = {topic: _reading(fields.get(topic, ()), profile.topic(topic)) for topic in chosen}
        if with_accuracy:
            readings = joined(readings, {topic: _kept(fields.get(topic), types[topic]) for topic in chosen})
        samples = read_samples(
            recording, readings, report=lambda done: report(share * _SHARE_OF_READING * done)
        )
        end_ns = recording.end_ns
    require_numbers(samples.topics, fields)
    found: dict[str, LossCurve | None] = {}
    for number, topic in enumerate(chosen):
        report(share * (_SHARE_OF_READING + (1 - _SHARE_OF_READING) * number / len(chosen)))
        found[topic] = loss_curve(samples.topics[topic], end_ns)
    wanted = {
        topic: accuracy_wanted(samples.topics[topic], fields.get(topic, ()))
        for topic in chosen
        if with_accuracy
    }
    costs, notices = accuracies(
        samples.topics, wanted, end_ns, lambda done: report(share + (1 - share) * done)
    )
    without = tuple(topic for topic, curve in found.items() if curve is None)
    bare = set(without).difference(curve.topic for curve in costs)
    return LossCurves(
        name=str(bag),
        curves=tuple(curve for curve in found.values() if curve),
        accuracies=costs,
        without=without,
        notices=(
            *samples.notices,
            *notices,
            *_notices_without([samples.topics[one] for one in sorted(bare)]),
        ),
    )


def _notices_without(topics: Sequence[TopicSamples]) -> Iterator[str]:
    """Why topics have no curve, those of one reason together."""
    named: dict[str, list[str]] = {}
    for samples in topics:
        why = _why_without(samples)
        if why is not None:
            named.setdefault(why, []).append(samples.channel.topic)
    for why, alike in named.items():
        yield f"{', '.join(alike)}: {why}, so there is no curve"


def _why_without(samples: TopicSamples) -> str | None:
    """Why a topic has no curve; ``None`` where that its messages were not decoded is said already."""
    messages = len(samples.stamps_ns)
    if not messages:
        return "no message"
    if samples.undecodable == messages or RosbagDecoder().why_undecodable(samples.channel) is not None:
        return None
    if messages == 1:
        return "only one message"
    if samples.mean_hz is None:
        return "all messages have one stamp"
    if samples.channel.type_name in BULK_TYPES and not samples.fields:
        return f"of a {samples.channel.type_name} no field is looked at unless --field names it"
    if not samples.fields:
        return "no field is a number"
    if all(samples.series(field).unknown == messages for field in samples.fields):
        return "no message has a number that is known"
    return "no field changes"


def _reading(asked: Sequence[str], entry: TopicProfile) -> TopicReading:
    def choose(type_name: str, message: object) -> Sequence[Field]:
        chosen = fields_of(type_name, message, asked=asked)
        return [field for field in chosen if field.is_asked] if asked else chosen

    return TopicReading(
        choose_fields=choose,
        undecoded_types=frozenset() if asked else BULK_TYPES,
        level_unit=entry.level_unit,
    )


def _kept(asked: Sequence[str] | None, type_name: str) -> TopicReading:
    """How a topic is read for what bounds cost."""
    return TopicReading(properties=tuple(asked or (one.name for one in geometry_of(type_name))))
