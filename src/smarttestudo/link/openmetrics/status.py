# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statuses of runtimes as metrics."""

from __future__ import annotations

import math
import types
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, is_dataclass
from functools import cache
from operator import attrgetter
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

from smarttestudo.domain.metric import Metered, Metric, MetricKind, MetricName, Sample
from smarttestudo.domain.record import marks
from smarttestudo.domain.status import RuntimeStatus, TopicStatus
from smarttestudo.domain.units import BYTES_PER_KB, BYTES_PER_MB

_ROBOT = ("robot",)
_TOPIC = ("robot", "topic")
_IN_BASE_UNITS = {"_kb_per_s": BYTES_PER_KB, "_mb": BYTES_PER_MB, "_ms": 1 / 1000, "_percent": 1 / 100}
"""By how much to multiply a number whose name ends so."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Reading:
    """A metric of a record, and how to read it; ``None`` where it is not known."""

    name: MetricName
    read: Callable[[Any], float | None]


@cache
def _readings(kind: Any, labels: tuple[str, ...]) -> tuple[_Reading, ...]:
    """The metrics of a record of ``kind`` and of the records in it, as the types of its fields say."""
    return tuple(_found(kind, labels))


def _found(kind: Any, labels: tuple[str, ...]) -> Iterator[_Reading]:
    for name, hint in _typed_names(kind):
        metered = next((extra for extra in marks(hint) if isinstance(extra, Metered)), None)
        if metered is not None:
            factor = next((by for end, by in _IN_BASE_UNITS.items() if name.endswith(end)), 1)
            named = MetricName(
                name=f"testudo_{metered.name}",
                unit=metered.unit,
                help=metered.help,
                kind=metered.kind,
                labels=labels,
            )
            yield _Reading(name=named, read=_number(name, factor))
        inner = _record_in(hint)
        if inner is not None:
            yield from (
                _Reading(name=one.name, read=_within(name, one.read)) for one in _readings(inner, labels)
            )


def _typed_names(kind: Any) -> Iterator[tuple[str, Any]]:
    """The fields and properties of a class with their types."""
    yield from get_type_hints(kind, include_extras=True).items()
    for name, member in vars(kind).items():
        if isinstance(member, property):
            yield name, get_type_hints(member.fget, include_extras=True).get("return")


def _record_in(hint: Any) -> Any:
    """The record that a field holds, or may hold."""
    plain = get_args(hint)[0] if get_origin(hint) is Annotated else hint
    if get_origin(plain) in (Union, types.UnionType):
        plain = get_args(plain)[0]
    return plain if is_dataclass(plain) else None


def _number(field: str, factor: float) -> Callable[[Any], float | None]:
    get = attrgetter(field)
    return lambda record: None if (value := get(record)) is None else float(value * factor)


def _within(field: str, read: Callable[[Any], float | None]) -> Callable[[Any], float | None]:
    get = attrgetter(field)
    return lambda record: None if (inner := get(record)) is None else read(inner)


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
    *(one.name for one in _readings(RuntimeStatus, _ROBOT)),
    *(one.name for one in _readings(TopicStatus, _TOPIC)),
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
    for one in _readings(kind, labels):
        yield Metric(name=one.name, samples=_known((of, one.read(record)) for of, record in read))


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
