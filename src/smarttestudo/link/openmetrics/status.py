# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statuses of runtimes as metrics."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import is_dataclass

from smarttestudo.domain.metric import MeteredField, Metric, MetricKind, MetricName, Sample, metered_fields
from smarttestudo.domain.status import RuntimeStatus, TopicStatus
from smarttestudo.domain.units import BYTES_PER_KB, BYTES_PER_MB

_ROBOT = ("robot",)
_TOPIC = ("robot", "topic")
_IN_BASE_UNITS = {"_kb_per_s": BYTES_PER_KB, "_mb": BYTES_PER_MB, "_ms": 1 / 1000, "_percent": 1 / 100}
"""By how much to multiply a number whose name ends so."""


def _name(field: MeteredField, labels: tuple[str, ...]) -> MetricName:
    mark = field.mark
    return MetricName(
        name=f"testudo_{mark.name}", unit=mark.unit, help=mark.help, kind=mark.kind, labels=labels
    )


def _number(field: MeteredField, record: object) -> float | None:
    """The number in the unit of its metric."""
    value = field.read(record)
    factor = next((by for end, by in _IN_BASE_UNITS.items() if field.keys[-1].endswith(end)), 1)
    return None if value is None else float(value * factor)


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
    *(_name(metered_field, _ROBOT) for metered_field in metered_fields(RuntimeStatus)),
    *(_name(metered_field, _TOPIC) for metered_field in metered_fields(TopicStatus)),
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
        *_metrics(RuntimeStatus, _ROBOT, [((robot,), status) for robot, status in robots]),
        *_metrics(TopicStatus, _TOPIC, topics),
        *_of_sections(statuses),
        Metric(name=_SILENT, samples=silent),
    ]


def _metrics(
    kind: type, labels: tuple[str, ...], records: Iterable[tuple[tuple[str, ...], object]]
) -> Iterator[Metric]:
    read = list(records)
    for metered_field in metered_fields(kind):
        numbers = ((of, _number(metered_field, record)) for of, record in read)
        yield Metric(name=_name(metered_field, labels), samples=_known(numbers))


def _of_sections(statuses: Mapping[str, RuntimeStatus]) -> Iterator[Metric]:
    """Metrics of the sections of parts."""
    by_kind: dict[type, list[tuple[tuple[str, ...], object]]] = {}
    for robot, status in statuses.items():
        for section in status.sections.values():
            if is_dataclass(section):
                by_kind.setdefault(type(section), []).append(((robot,), section))
    for kind, records in by_kind.items():
        yield from _metrics(kind, _ROBOT, records)


def _rules(robot: str, status: RuntimeStatus) -> Sample:
    return (robot, status.node, status.rules.sha256, status.rules.origin.value), 1.0


def _known(read: Iterable[tuple[tuple[str, ...], float | None]]) -> list[Sample]:
    numbers = ((labels, float(number)) for labels, number in read if number is not None)
    return [(labels, number) for labels, number in numbers if not math.isnan(number)]
