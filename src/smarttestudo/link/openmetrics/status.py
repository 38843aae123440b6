# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statuses of runtimes as metrics."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TypeVar

from smarttestudo.domain.link_state import LinkState, StreamCounts
from smarttestudo.domain.metric import Metric, MetricKind, MetricName, Sample
from smarttestudo.domain.status import RuntimeStatus, TopicStatus
from smarttestudo.domain.units import BYTES_PER_KB, BYTES_PER_MB

_ROBOT = ("robot",)
_TOPIC = ("robot", "topic")
_MS_PER_S = 1000
_PERCENT = 100
_Of = TypeVar("_Of")


_Reads = tuple[tuple[MetricName, Callable[[_Of], float | None]], ...]


def _gauge(name: str, unit: str, help_text: str) -> MetricName:
    labels = _TOPIC if name.startswith("topic_") else _ROBOT
    return MetricName(name=f"testudo_{name}", unit=unit, help=help_text, labels=labels)


def _counter(name: str, unit: str, help_text: str) -> MetricName:
    return replace(_gauge(name, unit, help_text), kind=MetricKind.COUNTER)


def _scaled(number: float | None, factor: float) -> float | None:
    return None if number is None else number * factor


def _link(read: Callable[[LinkState], float | None]) -> Callable[[RuntimeStatus], float | None]:
    return lambda status: None if status.link is None else read(status.link)


def _on_link(read: Callable[[StreamCounts], int]) -> Callable[[TopicStatus], float | None]:
    return lambda topic: None if topic.on_link is None else read(topic.on_link.counts)


def _age_s(topic: TopicStatus) -> float | None:
    return None if topic.on_link is None else _scaled(topic.on_link.age_ms, 1 / _MS_PER_S)


_OF_ROBOTS: _Reads[RuntimeStatus] = (
    (_gauge("uptime", "seconds", "Time since the start of the run."), lambda status: status.uptime_s),
    (
        _gauge("cpu", "ratio", "CPU time of the run over the last second, as a share of one core."),
        lambda status: _scaled(status.cpu_percent, 1 / _PERCENT),
    ),
    (
        _gauge("memory", "bytes", "Resident memory of the run."),
        lambda status: _scaled(status.memory_mb, BYTES_PER_MB),
    ),
    (
        _gauge("budget", "bytes_per_second", "What relayed topics may take together, if limited."),
        lambda status: _scaled(status.budget_kb_per_s, BYTES_PER_KB),
    ),
    (
        _gauge("floors_break_budget", "", "1 if the floors alone are more than the budget, else 0."),
        lambda status: float(status.floors_break_budget),
    ),
    (
        _gauge("fallback", "", "1 if everything is relayed because there are no valid rules, else 0."),
        lambda status: float(status.is_fallback),
    ),
    (
        _gauge("link_connected", "", "1 if an operator is connected over the link, else 0."),
        _link(lambda link: float(link.is_connected)),
    ),
    (
        _gauge("link_capacity", "bytes_per_second", "What the link carries, where it is the limit."),
        _link(lambda link: _scaled(link.capacity_kb_per_s, BYTES_PER_KB)),
    ),
    (
        _gauge("link_round_trip", "seconds", "The least round trip of the last seconds on the link."),
        _link(lambda link: _scaled(link.round_trip_ms, 1 / _MS_PER_S)),
    ),
    (
        _counter("link", "outages", "How often the operator's end was silent while something was under way."),
        _link(lambda link: link.outages),
    ),
)
_OF_TOPICS: _Reads[TopicStatus] = (
    (
        _gauge("topic_source", "hertz", "Messages a second that come of the topic."),
        lambda topic: topic.source_hz,
    ),
    (
        _gauge("topic_target", "hertz", "The planned rate of the topic; +Inf for Full, 0 for Off."),
        lambda topic: topic.target_hz,
    ),
    (_gauge("topic_expected", "hertz", "The lesser of target and source."), lambda topic: topic.expected_hz),
    (_gauge("topic_actual", "hertz", "Messages a second that are relayed."), lambda topic: topic.actual_hz),
    (
        _gauge("topic_keeps_rate", "", "0 if the rate is off by more than pacing explains, else 1."),
        lambda topic: float(topic.keeps_rate),
    ),
    (
        _gauge("topic_delay", "seconds", "Age of the last message by its own stamp when it was relayed."),
        lambda topic: _scaled(topic.delay_ms, 1 / _MS_PER_S),
    ),
    (
        _gauge("topic_input", "bytes_per_second", "What comes of the topic."),
        lambda topic: topic.in_kb_per_s * BYTES_PER_KB,
    ),
    (
        _gauge("topic_output", "bytes_per_second", "What is relayed of the topic."),
        lambda topic: topic.out_kb_per_s * BYTES_PER_KB,
    ),
    (_counter("topic_received", "messages", "Messages that came."), lambda topic: topic.counts.received),
    (
        _counter("topic_relayed", "messages", "Messages that went out, repeated ones included."),
        lambda topic: topic.counts.relayed,
    ),
    (
        _counter("topic_repeated", "messages", "Messages that went out for another time."),
        lambda topic: topic.counts.repeated,
    ),
    (
        _gauge("topic_dropped", "messages", "Messages held back so far; the last of them may still go out."),
        lambda topic: topic.counts.dropped,
    ),
    (
        _counter("topic_undecodable", "messages", "Messages that a check could not read."),
        lambda topic: topic.counts.undecodable,
    ),
    (
        _gauge("topic_link_age", "seconds", "Age of the last message when it arrived at the operator."),
        _age_s,
    ),
    (
        _counter("topic_link_sent", "messages", "Messages that went out whole over the link."),
        _on_link(lambda counts: counts.sent),
    ),
    (
        _counter("topic_link_replaced", "messages", "Messages that gave way to newer ones before the link."),
        _on_link(lambda counts: counts.replaced),
    ),
    (
        _counter("topic_link_overflowed", "messages", "Messages lost because the topic's queue was full."),
        _on_link(lambda counts: counts.overflowed),
    ),
    (
        _gauge("topic_link_queued", "bytes", "What waits for the link of the topic."),
        _on_link(lambda counts: counts.queued_bytes),
    ),
)
_RULES = MetricName(
    name="testudo_rules",
    help="The rules in force: node, SHA-256 of their text, and where they come from.",
    kind=MetricKind.INFO,
    labels=("robot", "node", "sha256", "origin"),
)
_SILENT = MetricName(
    name="testudo_topic_silent",
    help="1 while nothing is received of the relayed topic, with the reason; absent otherwise.",
    labels=("robot", "topic", "reason"),
)
STATUS_METRICS = (
    _RULES,
    *(name for name, _ in _OF_ROBOTS),
    *(name for name, _ in _OF_TOPICS),
    _SILENT,
)
"""All that ``status_metrics`` may give."""


def status_metrics(statuses: Mapping[str, RuntimeStatus]) -> list[Metric]:
    """The metrics of each robot, by its name. A number that is not known has no sample.

    Raises ``OverflowError`` for a number that no metric can have.
    """
    robots = statuses.items()
    topics = [((robot, source), topic) for robot, status in robots for source, topic in status.topics.items()]
    silent = [((*labels, topic.silence.value), 1.0) for labels, topic in topics if topic.silence is not None]
    return [
        Metric(name=_RULES, samples=[_rules(robot, status) for robot, status in robots]),
        *(
            Metric(name=name, samples=_known(((robot,), read(status)) for robot, status in robots))
            for name, read in _OF_ROBOTS
        ),
        *(
            Metric(name=name, samples=_known((labels, read(topic)) for labels, topic in topics))
            for name, read in _OF_TOPICS
        ),
        Metric(name=_SILENT, samples=silent),
    ]


def _rules(robot: str, status: RuntimeStatus) -> Sample:
    return (robot, status.node, status.rules.sha256, status.rules.origin.value), 1.0


def _known(read: Iterable[tuple[tuple[str, ...], float | None]]) -> list[Sample]:
    numbers = ((labels, float(number)) for labels, number in read if number is not None)
    return [(labels, number) for labels, number in numbers if not math.isnan(number)]
