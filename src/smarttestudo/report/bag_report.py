# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The report of one recording, or of two with their topics paired on one clock, and the same as figures."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from itertools import starmap
from pathlib import Path
from typing import Any, TypeVar

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve, accuracies, position_wanted, readings_for
from smarttestudo.accuracy.comparison import AccuracyComparison, AccuracyRequest, ComparisonMeasurement
from smarttestudo.accuracy.loss_report import LossReport
from smarttestudo.accuracy.recorded_loss import LossMeasurement, LossQuestion
from smarttestudo.accuracy.recorded_samples import RecordedSamples, TopicReading, joined, read_samples
from smarttestudo.bags.comparison import (
    Comparison,
    TopicComparison,
    compare,
    compare_bags,
    mean_target,
    shorter_notices,
    target_spans,
)
from smarttestudo.bags.incident_record import incident_mark
from smarttestudo.bags.measure import MeasuredRun, measure_run
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.robot_path import rule_zones
from smarttestudo.bags.statistics import RecordingSpan
from smarttestudo.bags.topic_selection import select_topics
from smarttestudo.domain.action import ActionDecision
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.floor_plan import FloorPlan
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.remote_robots import RuleText
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop.decision_log import with_run_starts
from smarttestudo.pacing.sample import StreamKind
from smarttestudo.report.bag_tables import bandwidth_table, rates_table
from smarttestudo.report.comparison_tables import RunNames
from smarttestudo.report.link import has_statuses, link_history
from smarttestudo.report.rule_timeline import by_topic
from smarttestudo.report.run_report import (
    Fact,
    FigureKind,
    LinkHistory,
    RunReport,
    TopicHistory,
    TopicSeries,
    bandwidth_series,
    rate_series,
)
from smarttestudo.report.table import Table


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
        a = replace(a, summary=a.summary.naming(topics))
        b = None if b is None else replace(b, summary=b.summary.naming(topics))
        if b is None:
            compared = compare(a.summary.statistics, {}).topics
            names, place = frozenset(a.summary.statistics), a.summary.name
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


def timed_from_start(
    decisions: Sequence[Decision], span: RecordingSpan
) -> tuple[tuple[Decision, ...], tuple[str, ...]]:
    """``decisions`` timed from the start of ``span``, and why there are none where they are of another time.

    What was planned last before the start held then already, so it is where each topic starts.
    """
    within = [decision for decision in decisions if span.start_ns <= decision.stamp_ns <= span.end_ns]
    if decisions and not within:
        return (), ("no decision falls into the time of the recording; they are left out",)
    held = _held_at(span.start_ns, decisions)
    return (
        *(replace(one, t_s=0.0, from_rate=None, from_within={}) for one in held),
        *(replace(one, t_s=(one.stamp_ns - span.start_ns) / NS_PER_S) for one in within),
    ), ()


def _held_at(start_ns: int, decisions: Sequence[Decision]) -> list[Decision]:
    """The last decision on each topic that was relayed just before ``start_ns``, by the run of that time."""
    held: dict[str, Decision] = {}
    run_ns = None
    for began_ns, decision in with_run_starts(decisions):
        if began_ns != run_ns and began_ns <= start_ns:
            run_ns = began_ns
            held.clear()
        if decision.stamp_ns >= start_ns:
            break
        held.pop(decision.topic, None)
        if not decision.is_end:
            held[decision.topic] = decision
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


Progress = Callable[[str], AbstractContextManager[Callable[[float], None]]]
"""Shows how far the work of the given name is while its block lasts, as a share of 0 … 1."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportRequest:
    """A recording ``a``, if there is one also ``b``, and how ``b`` came from it.

    ``mapping`` pairs topics as ``compare_bags`` does, ``topics`` are the names or patterns to show, empty
    for all. ``decisions`` and ``actions`` may be timed from any start; their stamps count. Of topics in
    ``predict`` B's receiver shows dead reckoning. Zones of ``rule_set`` are added to the ``floor_plan``.
    ``called`` is what the user calls a recording that lies elsewhere for now. ``compared`` asks for rules
    beside each other over ``a``, too.
    """

    a: Path
    b: Path | None = None
    title: str
    explanation: str = ""
    names: RunNames = field(default_factory=RunNames)
    mapping: Mapping[str, str] = field(default_factory=dict)
    topics: Sequence[str] = ()
    rule_set: RuleSet | None = None
    rule_texts: Mapping[str, str] = field(default_factory=dict)
    decisions: Sequence[Decision] = ()
    actions: Sequence[ActionDecision] = ()
    predict: Collection[str] = ()
    profile: Profile = field(default_factory=Profile)
    budget_kb_per_s: float | None = None
    floor_plan: FloorPlan = field(default_factory=FloorPlan)
    provenance: tuple[Fact, ...] = ()
    progress: Progress
    called: Callable[[Path], str] = str
    compared: AccuracyRequest | None = None


def bag_report(request: ReportRequest) -> RunReport:
    """Read the recordings and put together what their report shows.

    Raises:
        RecordingError: one cannot be read; they share no topic; a topic asked for is in neither.
    """
    runs = _measure(request, with_places=True)
    report = _report(request, runs)
    measurement, notices = known_or_why(lambda: _loss_measurement(request, runs))
    wanted = position_wanted(runs.a.channels, {pair.topic for pair in runs.pairs})
    readings = joined(measurement.readings() if measurement else {}, readings_for(wanted, request.profile))
    sent, comparison = _read_sent(request, runs, readings)
    loss: LossReport | None = None
    if measurement is not None:
        with request.progress("Measuring what was lost") as shown:
            loss, notices = known_or_why(lambda: measurement.report(sent, shown))
        notices = loss.notices if loss else notices
    curves: tuple[AccuracyCurve, ...] = ()
    if wanted:
        with request.progress("Measuring what an accuracy costs") as shown:
            curves, unread = accuracies(sent.topics, wanted, runs.a.summary.span.end_ns, shown)
        notices = (*notices, *unread)
    link, link_notices = _link(request, runs)
    return replace(
        report,
        loss=loss,
        accuracy=comparison,
        accuracy_curve=next(iter(curves), None),
        link=link,
        notices=tuple(dict.fromkeys((*report.notices, *notices, *link_notices))),
    )


_Known = TypeVar("_Known")


def known_or_why(measure: Callable[[], _Known | None]) -> tuple[_Known | None, tuple[str, ...]]:
    """Measure a part of the loss, or say why it is not known."""
    try:
        return measure(), ()
    except RecordingError as error:
        return None, (f"what was lost is not known: {error.cause}",)


def series_over_time(request: ReportRequest) -> RunReport:
    """The part of ``bag_report`` for which no payload is read: rates and bandwidth over time.

    Raises:
        RecordingError: as ``bag_report``.
    """
    return _report(request, _measure(request, with_places=False))


def _measure(request: ReportRequest, *, with_places: bool) -> PairedRuns:
    by_transforms = request.floor_plan.occupancy is not None
    with request.progress(f"Reading {request.called(request.a)}") as report:
        a = measure_run(request.a, report, with_places=with_places, by_transforms=by_transforms)
    b = None
    if request.b is not None:
        with request.progress(f"Reading {request.called(request.b)}") as report:
            b = measure_run(request.b, report, with_places=False)
    return PairedRuns.of(a, b, mapping=request.mapping, topics=request.topics)


def _report(request: ReportRequest, runs: PairedRuns) -> RunReport:
    summary = runs.a.summary
    decisions, decision_notices = timed_from_start(request.decisions, summary.span)
    return RunReport(
        title=request.title,
        explanation=request.explanation,
        duration_s=summary.span.duration_s,
        comparison=runs.comparison(decisions),
        series=runs.series(),
        total=runs.total(),
        decisions=decisions,
        actions=tuple(
            replace(one, t_s=(one.stamp_ns - summary.span.start_ns) / NS_PER_S) for one in request.actions
        ),
        names=request.names,
        tables=() if runs.b else _tables_of_one(runs),
        budget_kb_per_s=request.budget_kb_per_s,
        rules=tuple(starmap(RuleText, request.rule_texts.items())),
        provenance=request.provenance,
        notices=(*runs.notices(), *decision_notices),
        incident=None if summary.incident is None else incident_mark(summary.incident, summary.span),
        floor_plan=_floor_plan(request),
        path=runs.a.path,
    )


def _loss_measurement(request: ReportRequest, runs: PairedRuns) -> LossMeasurement | None:
    """The measurement of what B, if there is one, lost of A. Raises ``RecordingError``."""
    if request.b is None or runs.b is None:
        return None
    question = LossQuestion(
        mapping=request.mapping,
        topics=request.topics,
        rule_set=request.rule_set,
        decisions=request.decisions,
        predict=request.predict,
        profile=request.profile,
    )
    return LossMeasurement(runs.a.summary, (request.b, runs.b.summary), question)


def _read_sent(
    request: ReportRequest, runs: PairedRuns, readings: Mapping[str, TopicReading]
) -> tuple[RecordedSamples, AccuracyComparison | None]:
    """Read A in one pass for all that is measured of it; rules are compared in the same pass."""
    if not readings and request.compared is None:
        return RecordedSamples(topics={}), None
    with open_recording(request.a) as recording:
        if request.compared is not None:
            measurement = ComparisonMeasurement(request.compared, recording)
            if measurement.properties:
                sent = measurement.read(joined(readings, measurement.readings()))
                return sent, measurement.comparison(sent)
        span = runs.a.summary.span
        with request.progress(f"Reading the messages of {request.called(request.a)}") as report:
            sent = read_samples(
                recording,
                readings,
                start_ns=span.start_ns,
                end_ns=span.end_ns,
                topics=readings if request.b is None else None,
                report=report,
            )
        return sent, None


def _link(request: ReportRequest, runs: PairedRuns) -> tuple[LinkHistory | None, tuple[str, ...]]:
    """The history of a link by the operator's recording; where there is one recording only, by that."""
    if not has_statuses((runs.b or runs.a).channels):
        return None, ()
    with request.progress("Reading what the link did") as report:
        return link_history(request.b or request.a, runs.a.summary.span.start_ns, report)


def _floor_plan(request: ReportRequest) -> FloorPlan:
    zones = () if request.rule_set is None else rule_zones(request.rule_set)
    return replace(request.floor_plan, zones=(*request.floor_plan.zones, *zones))


def _tables_of_one(runs: PairedRuns) -> tuple[Table[Any], ...]:
    """The tables of the actions ``rates`` and ``bandwidth``."""
    summary = runs.a.summary.only({pair.topic for pair in runs.pairs})
    # Its heading says already which recording it is.
    return (
        replace(rates_table(summary), title="Rates", subtitles=()),
        replace(bandwidth_table(summary), title="Bandwidth", subtitles=()),
    )


RATES = frozenset({FigureKind.RATES, FigureKind.INTERVALS})
BANDWIDTH = frozenset({FigureKind.BANDWIDTH, FigureKind.TOTAL})
EVERYTHING = frozenset(FigureKind)


def draw_over_time(request: ReportRequest, kinds: Collection[FigureKind], folder: Path) -> list[Path]:
    """Measure the recordings, without their payloads, and draw what arrived when.

    Raises:
        RecordingError: one cannot be read, or they share no topic.
        OutputFileError: a figure cannot be written.
    """
    return _draw(series_over_time(request), kinds, folder)


def draw_report(report: RunReport, folder: Path) -> list[Path]:
    """Draw everything that ``report`` shows over time or on the floor. Raises ``OutputFileError``."""
    return _draw(report, EVERYTHING, folder)


def _draw(report: RunReport, kinds: Collection[FigureKind], folder: Path) -> list[Path]:
    from smarttestudo.report.figures.draw import draw_figures  # noqa: PLC0415  matplotlib takes a second

    return draw_figures(report, kinds, folder)
