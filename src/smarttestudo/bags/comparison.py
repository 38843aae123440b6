# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Two recordings beside each other: topic by topic, and in all."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

from smarttestudo.bags.bag_summary import BagSummary, BagTotal
from smarttestudo.bags.statistics import TopicStatistics
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.record import JsonEntry, derived, to_columns
from smarttestudo.domain.units import grouped


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


def change_percent(before: float | None, after: float | None) -> float | None:
    """How much ``after`` lies above ``before``, in percent of it; ``None`` where that has no meaning."""
    if before is None or after is None or before == 0:
        return None
    return 100 * (after / before - 1)


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicComparison:
    """One topic in both runs; ``None`` where a run does not have it.

    ``after_topic`` is its name in the second run, ``target`` what was planned for it there. A topic that only
    the second run has is called ``/odom (B)`` where the first run has another ``/odom``.
    """

    topic: Annotated[str, JsonEntry(is_absent=True)]
    before: Annotated[TopicStatistics | None, JsonEntry(name="a")]
    after: Annotated[TopicStatistics | None, JsonEntry(name="b")]
    after_topic: Annotated[str | None, JsonEntry(name="b_topic")] = None
    target: Annotated[Target | None, JsonEntry(is_absent=True)] = None

    @property
    @derived()
    def change_percent(self) -> float | None:
        """The change of ``binned_hz``, in percent."""
        if self.before is None or self.after is None:
            return None
        return change_percent(self.before.binned_hz, self.after.binned_hz)

    @property
    @derived()
    def bandwidth_change_percent(self) -> float | None:
        """The change of ``kb_per_s`` (and so of kbit/s), in percent."""
        if self.before is None or self.after is None:
            return None
        return change_percent(self.before.kb_per_s, self.after.kb_per_s)

    @property
    def error_percent(self) -> float | None:
        """How far the second run's ``mean_hz`` lies from what was attainable, in percent of that."""
        if self.after is None or self.target is None:
            return None
        return change_percent(self.target.attainable_hz, self.after.mean_hz)


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """All topics of two runs, and what both runs carried in all."""

    topics: Annotated[tuple[TopicComparison, ...], JsonEntry(keyed_by="topic")]

    @property
    def before_kb_per_s(self) -> float | None:
        """KB/s of all topics of the first run; ``None`` if none is known."""
        return _total(pair.before for pair in self.topics)

    @property
    def after_kb_per_s(self) -> float | None:
        """KB/s of all topics of the second run; ``None`` if none is known."""
        return _total(pair.after for pair in self.topics)

    @property
    def bandwidth_change_percent(self) -> float | None:
        """The change of the bandwidth of all topics together, in percent."""
        return change_percent(self.before_kb_per_s, self.after_kb_per_s)


def compare(
    before: Mapping[str, TopicStatistics],
    after: Mapping[str, TopicStatistics],
    targets: Mapping[str, Target | None] | None = None,
    *,
    mapping: Mapping[str, str] | None = None,
) -> Comparison:
    """Pair the topics of two runs, in the order of the first, then what only the second has.

    With the first run's ``/odom`` pairs what ``mapping`` names for it, else the second's ``/testudo/odom`` or
    ``/odom_receive``, else its ``/odom``. ``targets`` go by the first run's topic names.
    """
    targets, mapping = targets or {}, mapping or {}
    pairs = []
    alone = dict(after)
    mapped = {name: alone.pop(name) for name in mapping.values() if name in alone}
    for topic, statistics in before.items():
        if topic in mapping:
            partner: str | None = mapping[topic]
            other = mapped.get(mapping[topic])
        else:
            partner = next((name for name in _partners(topic) if name in alone), None)
            other = alone.pop(partner) if partner else None
        pairs.append(
            TopicComparison(
                topic=topic,
                before=statistics,
                after=other,
                after_topic=None if other is None else partner,
                target=targets.get(topic),
            )
        )
    pairs += [
        TopicComparison(
            topic=f"{topic} (B)" if topic in before else topic,
            before=None,
            after=statistics,
            after_topic=topic,
        )
        for topic, statistics in alone.items()
    ]
    return Comparison(topics=tuple(pairs))


def _partners(topic: str) -> tuple[str, str, str]:
    """The names under which a topic may have been relayed, best first."""
    return f"/testudo{topic}", f"{topic}_receive", topic


def _total(sides: Iterable[TopicStatistics | None]) -> float | None:
    known = [side.kb_per_s for side in sides if side is not None and side.kb_per_s is not None]
    return sum(known) if known else None


_MUCH_SHORTER = 0.9


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedTotals:
    """All topics of each recording together, of those that are compared."""

    a: BagTotal
    b: BagTotal
    bandwidth_change_percent: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class BagComparison:
    """The recordings ``a`` and ``b`` with their topics paired.

    Where ``b`` is of the time of ``a``, its bandwidths count over that: where it has nothing, nothing
    arrived.
    """

    a: Annotated[BagSummary, JsonEntry(is_absent=True)]
    b: Annotated[BagSummary, JsonEntry(is_absent=True)]
    comparison: Annotated[Comparison, JsonEntry(is_merged=True)]

    @property
    @derived("a")
    def a_name(self) -> str:
        """Name of the first recording."""
        return self.a.name

    @property
    @derived("b")
    def b_name(self) -> str:
        """Name of the second recording."""
        return self.b.name

    @property
    @derived()
    def total(self) -> ComparedTotals:
        """The sums over the topics that are compared."""
        pairs = self.comparison.topics
        return ComparedTotals(
            a=self.a.only({pair.topic for pair in pairs if pair.before}).total,
            b=self.b.only({pair.after_topic for pair in pairs}).total,
            bandwidth_change_percent=self.comparison.bandwidth_change_percent,
        )

    @property
    def names(self) -> frozenset[str]:
        """Names of the topics in either recording."""
        pairs = self.comparison.topics
        before = {pair.topic for pair in pairs if pair.before}
        return frozenset(before | {pair.after_topic for pair in pairs if pair.after_topic})

    @property
    @derived()
    def notices(self) -> tuple[str, ...]:
        """Losses and oddities of either, a line each."""
        return (*self.a.notices, *self.b.notices, *shorter_notices(self.a, self.b))

    def only(self, names: Collection[str]) -> BagComparison:
        """The same with the pairs of which one topic is in ``names``."""
        kept = tuple(
            pair for pair in self.comparison.topics if pair.topic in names or pair.after_topic in names
        )
        return replace(self, comparison=Comparison(topics=kept))

    def rows(self) -> Iterator[dict[str, object]]:
        """One row for each pair, for ``--csv``."""
        for pair in self.comparison.topics:
            row = ComparisonRow(
                topic=pair.topic,
                b_topic=pair.after_topic,
                a_hz=pair.before.binned_hz if pair.before else None,
                b_hz=pair.after.binned_hz if pair.after else None,
                change_percent=pair.change_percent,
                a_kb_per_s=pair.before.kb_per_s if pair.before else None,
                b_kb_per_s=pair.after.kb_per_s if pair.after else None,
                bandwidth_change_percent=pair.bandwidth_change_percent,
            )
            yield to_columns(row)


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparisonRow:
    """A topic of two recordings as a row."""

    topic: str
    b_topic: str | None
    a_hz: float | None
    b_hz: float | None
    change_percent: float | None
    a_kb_per_s: float | None
    b_kb_per_s: float | None
    bandwidth_change_percent: float | None


def compare_bags(a: BagSummary, b: BagSummary, mapping: Mapping[str, str]) -> BagComparison:
    """Pair the topics of ``a`` and ``b``, first by ``mapping``, then by name.

    Raises:
        RecordingError: they have no topic in common.
    """
    if a.span.shares_time(b.span):
        b = b.over(max(a.span.duration_s, b.span.duration_s))
    comparison = compare(a.statistics, b.statistics, mapping=mapping)
    is_empty = not a.total.messages or not b.total.messages
    if not is_empty and not any(pair.before and pair.after for pair in comparison.topics):
        raise RecordingError(
            f"it has no topic in common with {a.name}", place=b.name, remedy="pair two by --map /a=/b"
        )
    return BagComparison(a=a, b=b, comparison=comparison)


def shorter_notices(a: BagSummary, b: BagSummary) -> Iterator[str]:
    """Says over what the bandwidths of ``b`` count, where it is of the time of ``a`` and much shorter."""
    longer_s, shorter_s = a.span.duration_s, b.span.duration_s
    if a.span.shares_time(b.span) and shorter_s < _MUCH_SHORTER * longer_s:
        yield (
            f"{b.name}: lasts {grouped(shorter_s, 1)} s; its KB/s count over the "
            f"{grouped(longer_s, 1)} s of {a.name}"
        )
