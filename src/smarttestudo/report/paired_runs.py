# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One measured recording, or two with their topics paired and on one clock."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from smarttestudo.bags.bag_comparison import compare_bags, shorter_notices
from smarttestudo.bags.comparison import Comparison, TopicComparison, compare
from smarttestudo.bags.measure import MeasuredRun
from smarttestudo.bags.statistics import RecordingSpan
from smarttestudo.bags.targets import mean_target, target_spans
from smarttestudo.bags.topic_selection import select_topics
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.loop.decision_log import with_run_starts
from smarttestudo.pacing.sample import StreamKind
from smarttestudo.report.rule_timeline import by_topic
from smarttestudo.report.run_report import TopicHistory, TopicSeries
from smarttestudo.report.series import bandwidth_series, rate_series


def with_targets(
    comparison: Comparison, decisions: Sequence[Decision], *, end_s: float, named: Collection[str]
) -> Comparison:
    """``comparison`` with what ``decisions`` planned for its topics until ``end_s``, by the first's names.

    ``named`` are topics whose planned rates are those of each stream that their messages name.
    """
    planned = by_topic(decisions)

    def targeted(pair: TopicComparison) -> TopicComparison:
        own = planned.get(pair.topic)
        if own is None or pair.before is None:
            return pair
        target = mean_target(target_spans(own, end_s), pair.before.mean_hz)
        if target is not None and pair.topic in named:
            target = replace(target, attainable_hz=None)
        return replace(pair, target=target)

    return Comparison(topics=tuple(map(targeted, comparison.topics)))


def _has_streams(type_name: str) -> bool:
    return StreamKind.of(type_name=type_name, transient_local=False) is StreamKind.NAMED


@dataclass(frozen=True, slots=True, kw_only=True)
class PairedRuns:
    """Recording ``a``, and ``b`` if there is one; ``pairs`` are the topics that are shown.

    Times count from the start of ``a``. Where the two share no time, those of ``b`` count from its own.
    """

    a: MeasuredRun
    b: MeasuredRun | None
    pairs: tuple[TopicComparison, ...]

    @staticmethod
    def of(
        a: MeasuredRun, b: MeasuredRun | None, *, mapping: Mapping[str, str], topics: Sequence[str]
    ) -> PairedRuns:
        """Pair the topics by ``mapping``, then by name, and keep those that ``topics`` name; empty for all.

        Raises:
            RecordingError: the two have no topic in common, or one of ``topics`` is in neither.
        """
        if b is None:
            compared = compare(a.summary.statistics, {}).topics
            names, place = frozenset(a.topics), a.summary.name
        else:
            both = compare_bags(a.summary, b.summary, mapping)
            compared, names = both.comparison.topics, both.names
            place = f"{a.summary.name}, {b.summary.name}"
        if topics:
            chosen = select_topics(topics, names, place=place)
            compared = tuple(pair for pair in compared if pair.topic in chosen or pair.after_topic in chosen)
        return PairedRuns(a=a, b=b, pairs=compared)

    def comparison(self, decisions: Sequence[Decision]) -> Comparison:
        """The numbers of the topics, against what ``decisions`` planned."""
        end_s = self.a.summary.span.duration_s
        named = [topic.name for topic in self.a.summary.topics if _has_streams(topic.type_name)]
        return with_targets(Comparison(topics=self.pairs), decisions, end_s=end_s, named=named)

    def series(self) -> tuple[TopicSeries, ...]:
        """The topics over time."""
        return tuple(
            TopicSeries(
                topic=pair.topic,
                before=_history(self.a, pair.topic if pair.before else None, self.a.summary.span),
                after=_history(self.b, pair.after_topic, self._span_of_b),
            )
            for pair in self.pairs
        )

    def total(self) -> TopicSeries:
        """The bandwidth of all topics that are shown."""
        return TopicSeries(
            topic="All topics",
            before=_total(self.a, [pair.topic for pair in self.pairs if pair.before], self.a.summary.span),
            after=_total(self.b, [pair.after_topic for pair in self.pairs], self._span_of_b),
        )

    def timed(self, decisions: Sequence[Decision]) -> tuple[tuple[Decision, ...], tuple[str, ...]]:
        """``decisions`` timed from the start of ``a``, and why there are none where they are of another time.

        What was planned last before the start held then already, so it is where each topic starts.
        """
        span = self.a.summary.span
        within = [one for one in decisions if span.start_ns <= one.stamp_ns <= span.end_ns]
        if decisions and not within:
            return (), ("no decision falls into the time of the recording; they are left out",)
        held = _held_at(span.start_ns, decisions)
        return (
            *(replace(one, t_s=0.0, from_rate=None, from_within={}) for one in held),
            *(replace(one, t_s=(one.stamp_ns - span.start_ns) / NS_PER_S) for one in within),
        ), ()

    def notices(self) -> tuple[str, ...]:
        """Notices of what was lost or odd, a line each."""
        if self.b is None:
            return self.a.summary.notices
        apart = "the recordings share no time; each is shown from its own start"
        return (
            *self.a.summary.notices,
            *self.b.summary.notices,
            *shorter_notices(self.a.summary, self.b.summary),
            *(() if self._share_time else (apart,)),
        )

    @property
    def _share_time(self) -> bool:
        return self.b is None or self.a.summary.span.shares_time(self.b.summary.span)

    @property
    def _span_of_b(self) -> RecordingSpan:
        return self.a.summary.span if self.b is None or self._share_time else self.b.summary.span


def _held_at(start_ns: int, decisions: Sequence[Decision]) -> list[Decision]:
    """The last decision on each topic that was relayed just before ``start_ns``, by the run of that time."""
    held: dict[str, Decision] = {}
    run_ns = None
    for began_ns, one in with_run_starts(decisions):
        if began_ns != run_ns and began_ns <= start_ns:
            run_ns = began_ns
            held.clear()
        if one.stamp_ns >= start_ns:
            break
        held.pop(one.topic, None)
        if not one.is_end:
            held[one.topic] = one
    return [*held.values()]


def _history(run: MeasuredRun | None, topic: str | None, span: RecordingSpan) -> TopicHistory:
    if run is None or topic is None:
        return TopicHistory()
    one = run.topics[topic]
    return TopicHistory(
        rate_hz=rate_series(one.trace, span),
        kb_per_s=bandwidth_series([one.trace], span),
        intervals=one.histogram.bins(),
    )


def _total(run: MeasuredRun | None, topics: Sequence[str | None], span: RecordingSpan) -> TopicHistory:
    if run is None:
        return TopicHistory()
    traces = [run.topics[topic].trace for topic in topics if topic is not None]
    return TopicHistory(kb_per_s=bandwidth_series(traces, span))
