# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers that a monitoring system collects, by the naming rules of Prometheus and OpenMetrics."""

from __future__ import annotations

import types
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, is_dataclass
from enum import Enum
from functools import cache
from operator import attrgetter
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin, get_type_hints

from smarttestudo.domain.record import JsonEntry, marks


class MetricKind(Enum):
    """Kind of a metric; the value is its name in OpenMetrics."""

    GAUGE = "gauge"
    COUNTER = "counter"
    """Since the start; it only grows."""
    INFO = "info"
    """Words in labels; the number is always 1."""


_SUFFIXES = {MetricKind.GAUGE: "", MetricKind.COUNTER: "_total", MetricKind.INFO: "_info"}


@dataclass(frozen=True, slots=True, kw_only=True)
class MetricName:
    """A metric without its numbers: ``unit`` is a base unit, empty for what is 1 or 0, and for words."""

    name: str
    help: str
    unit: str = ""
    kind: MetricKind = MetricKind.GAUGE
    labels: tuple[str, ...] = ()

    @property
    def sample_name(self) -> str:
        """Name of its numbers in queries."""
        unit = f"_{self.unit}" if self.unit else ""
        return f"{self.name}{unit}{_SUFFIXES[self.kind]}"


@dataclass(frozen=True, slots=True)
class Metered:
    """Mark in the type of a record's field: the number is a metric, too.

    Its ``name`` follows ``testudo_``. Where the field's name ends in another unit, as in ``age_ms``, the
    number is converted to ``unit``.
    """

    name: str
    unit: str
    help: str
    kind: MetricKind = MetricKind.GAUGE


class MeteredField(NamedTuple):
    """A number that the type of a record marks; ``keys`` lead to it in the record's JSON.

    ``read`` gives the number of a record, ``None`` where it is not known.
    """

    keys: tuple[str, ...]
    mark: Metered
    read: Callable[[Any], float | None]


@cache
def metered_fields(kind: Any) -> tuple[MeteredField, ...]:
    """The metered fields and properties of a record of ``kind``, and of the records in it."""
    return tuple(_metered(kind))


def _metered(kind: Any) -> Iterator[MeteredField]:
    for name, key, hint in _typed_names(kind):
        found = marks(hint)
        mark = next((annotation for annotation in found if isinstance(annotation, Metered)), None)
        entry = next((annotation for annotation in found if isinstance(annotation, JsonEntry)), JsonEntry())
        if mark is not None:
            yield MeteredField((entry.name or key,), mark, attrgetter(name))
        inner = _record_in(hint)
        for metered_field in metered_fields(inner) if inner is not None else ():
            keys = metered_field.keys if entry.is_merged else (entry.name or key, *metered_field.keys)
            yield MeteredField(keys, metered_field.mark, _within(name, metered_field.read))


def _typed_names(kind: Any) -> Iterator[tuple[str, str, Any]]:
    """The fields and properties of a class with their keys and types."""
    for name, hint in get_type_hints(kind, include_extras=True).items():
        yield name, name, hint
    for name, member in vars(kind).items():
        if isinstance(member, property):
            entry = vars(member.fget).get("record_entry", JsonEntry())
            yield name, entry.name or name, get_type_hints(member.fget, include_extras=True).get("return")


def _record_in(hint: Any) -> Any:
    """The record that a field holds, or may hold."""
    plain = get_args(hint)[0] if get_origin(hint) is Annotated else hint
    if get_origin(plain) in (Union, types.UnionType):
        plain = get_args(plain)[0]
    return plain if is_dataclass(plain) else None


def _within(field: str, read: Callable[[Any], float | None]) -> Callable[[Any], float | None]:
    get = attrgetter(field)
    return lambda record: None if (inner := get(record)) is None else read(inner)


Sample = tuple[tuple[str, ...], float]
"""The values of the labels, and the number that they have."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Metric:
    """A metric with its numbers now, at most one for the same labels."""

    name: MetricName
    samples: Sequence[Sample]
