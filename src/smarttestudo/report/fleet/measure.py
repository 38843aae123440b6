# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Measuring a recording, or a pair, for the report over many."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path

from smarttestudo.accuracy.bounds import BoundLoss
from smarttestudo.accuracy.loss_report import LossReport, TopicLoss
from smarttestudo.accuracy.recorded_loss import LossMeasurement, LossQuestion
from smarttestudo.accuracy.recorded_samples import read_samples
from smarttestudo.bags.bag_summary import BagSummary
from smarttestudo.bags.comparison import compare_bags
from smarttestudo.bags.measure import measure_bag, measure_run
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.statistics import RecordingSpan, TraceAccumulator
from smarttestudo.bags.topic_selection import is_selected
from smarttestudo.domain.decision import Decision, about_rates
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.replays.decisions import decisions_over, kept_decisions
from smarttestudo.report.bag_report import known_or_why, timed_from_start
from smarttestudo.report.fleet.numbers import (
    BoundNumbers,
    Received,
    RecordingNumbers,
    RuleNumbers,
    TopicNumbers,
)
from smarttestudo.report.loss_tables import bound_name
from smarttestudo.report.rule_timeline import (
    DecidingBlock,
    block_at,
    by_topic,
    deciding_block,
    deciding_spans,
)
from smarttestudo.report.summary import position_error

Traces = Mapping[str, TraceAccumulator]


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingQuestion:
    """A recording ``a`` of ``robot``, if there is one also ``b``, and what is asked as of ``ReportRequest``.

    Of ``topics`` a recording need not have one. ``rule_set`` decides over ``a``, where neither recording has
    decisions.
    """

    a: Path
    b: Path | None = None
    robot: str = ""
    mapping: Mapping[str, str] = field(default_factory=dict)
    topics: Sequence[str] = ()
    rule_set: RuleSet | None = None
    predict: Collection[str] = ()
    profile: Profile = field(default_factory=Profile)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Measured:
    """A recording, and each of its topics over time where rules decide."""

    path: Path
    summary: BagSummary
    traces: Traces


def measure_recording(question: RecordingQuestion) -> RecordingNumbers:
    """The numbers of a recording, or a pair.

    Raises:
        RecordingError: one cannot be read; they share no topic.
    """
    kept = about_rates(kept_decisions(question.b, question.a))
    has_decisions = bool(kept) or question.rule_set is not None
    a = _measure(question.a, over_time=has_decisions)
    b = None if question.b is None else _measure(question.b, over_time=has_decisions)
    partners = {} if b is None else _partners(a.summary, b.summary, question.mapping)
    called = {name: {name, partners.get(name, name)} for name in a.summary.statistics}
    names = [name for name, own in called.items() if not question.topics or _selected(own, question.topics)]
    known = [decision for decision in kept or _decided(question) if decision.topic in names]
    decisions, decision_notices = timed_from_start(known, a.summary.span)
    statistics = a.summary.statistics
    sent = [name for name in names if name in partners and statistics[name].messages]
    loss, notices = known_or_why(lambda: _loss(question, a, b, sent, known))
    lost = {} if loss is None else {topic.topic: topic for topic in loss.topics}
    return RecordingNumbers(
        a=str(question.a),
        b=None if question.b is None else str(question.b),
        robot=question.robot,
        span=a.summary.span,
        topics=tuple(
            TopicNumbers(
                topic=name,
                messages=statistics[name].messages,
                size_bytes=statistics[name].size_bytes,
                received=_received(lost.get(name)),
            )
            for name in names
        ),
        rules=rule_numbers(decisions, a.summary.span, a.traces, _shared(b, partners) if loss else None),
        bounds=() if loss is None else tuple(map(_bound, loss.bounds)),
        position=None if loss is None else position_error(loss),
        unmatched=frozenset(
            topic for topic in question.topics if not any(_selected(own, [topic]) for own in called.values())
        ),
        notices=_once(
            a.summary.notices,
            b.summary.notices if b else (),
            decision_notices,
            loss.notices if loss else notices,
        ),
    )


def _once(*notices: Sequence[str]) -> tuple[str, ...]:
    """``notices`` without those that a recording gave again when it was read for its losses."""
    return tuple(dict.fromkeys(chain.from_iterable(notices)))


def _measure(path: Path, *, over_time: bool) -> _Measured:
    if not over_time:
        return _Measured(path=path, summary=measure_bag(path, lambda _: None), traces={})
    run = measure_run(path, lambda _: None, with_places=False)
    return _Measured(
        path=path, summary=run.summary, traces={name: counter.trace for name, counter in run.topics.items()}
    )


def _partners(a: BagSummary, b: BagSummary, mapping: Mapping[str, str]) -> dict[str, str]:
    """The names in B of what both have, by those in A."""
    pairs = compare_bags(a, b, mapping).comparison.topics
    return {pair.topic: pair.after_topic for pair in pairs if pair.before and pair.after_topic}


def _selected(names: Collection[str], patterns: Sequence[str]) -> bool:
    return any(is_selected(name, patterns) for name in names)


def _decided(question: RecordingQuestion) -> Sequence[Decision]:
    if question.rule_set is None:
        return ()
    return decisions_over(question.a, question.rule_set, question.profile, lambda _: None)


def _loss(
    question: RecordingQuestion,
    a: _Measured,
    b: _Measured | None,
    topics: Sequence[str],
    decisions: Sequence[Decision],
) -> LossReport | None:
    """The loss of ``topics``; ``None`` where there is none to measure. Raises ``RecordingError``."""
    if b is None or not topics:
        return None
    asked = LossQuestion(
        mapping=question.mapping,
        topics=topics,
        rule_set=question.rule_set,
        decisions=decisions,
        predict=question.predict,
        profile=question.profile,
    )
    measurement = LossMeasurement(a.summary, (b.path, b.summary), asked)
    span = a.summary.span
    with open_recording(a.path) as recording:
        sent = read_samples(
            recording,
            measurement.readings(),
            start_ns=span.start_ns,
            end_ns=span.end_ns,
            report=lambda _: None,
        )
    return measurement.report(sent, lambda _: None)


def _shared(b: _Measured | None, partners: Mapping[str, str]) -> Traces:
    """Topics over time in B that both have, by the names in A."""
    traces = {} if b is None else b.traces
    return {name: traces[partner] for name, partner in partners.items() if partner in traces}


def _received(loss: TopicLoss | None) -> Received | None:
    if loss is None:
        return None
    arm = loss.received
    return Received(
        messages=arm.messages,
        size_bytes=arm.size_bytes,
        age_mean_s=arm.age.mean_s if arm.age else None,
        age_max_s=arm.age.max_s if arm.age else None,
    )


def _bound(loss: BoundLoss) -> BoundNumbers:
    return BoundNumbers(
        picture=bound_name(loss),
        unit=loss.unit,
        bound=loss.bound,
        messages=loss.messages,
        broken=loss.broken,
        worst=loss.worst,
    )


@dataclass(slots=True, kw_only=True)
class _Volume:
    messages: int = 0
    size_bytes: int = 0


def rule_numbers(
    decisions: Sequence[Decision], span: RecordingSpan, sent: Traces, received: Traces | None
) -> tuple[RuleNumbers, ...]:
    """The numbers of each rule that decided, and of the defaults, by name.

    A second counts for what decided the topic in its middle. ``received`` goes by the names of what was
    ``sent``; where it is known, only topics that both have count.
    """
    if received is not None:
        sent = {name: trace for name, trace in sent.items() if name in received}
    volumes = [_by_rule(decisions, span, traces) for traces in (sent, received or {})]
    decided_s: dict[str, float] = defaultdict(float)
    for deciding_span in deciding_spans(decisions, span.duration_s):
        decided_s[_name(deciding_span.block)] += deciding_span.end_s - deciding_span.start_s
    began = [_name(deciding_block(decision)) for decision in decisions]
    return tuple(
        RuleNumbers(
            rule=rule,
            decided_s=decided_s.get(rule, 0.0),
            decisions=began.count(rule),
            messages=volumes[0][rule].messages,
            size_bytes=volumes[0][rule].size_bytes,
            received_messages=None if received is None else volumes[1][rule].messages,
            received_bytes=None if received is None else volumes[1][rule].size_bytes,
        )
        for rule in sorted({*began, *decided_s, *volumes[0], *volumes[1]})
    )


def _by_rule(decisions: Sequence[Decision], span: RecordingSpan, traces: Traces) -> dict[str, _Volume]:
    volumes: dict[str, _Volume] = defaultdict(_Volume)
    for topic, own in by_topic(decisions).items():
        spans = deciding_spans(own, span.duration_s)
        trace = traces.get(topic)
        for bin_ in trace.bins() if trace else ():
            if not span.start_ns <= (bin_.second + 1) * NS_PER_S <= span.end_ns + NS_PER_S:
                continue
            middle_s = bin_.second + 0.5 - span.start_ns / NS_PER_S
            volume = volumes[_name(block_at(spans, max(middle_s, 0.0)))]
            volume.messages += bin_.messages
            volume.size_bytes += bin_.size_bytes
    return volumes


def _name(block: DecidingBlock | None) -> str:
    return "" if block is None else block.name
