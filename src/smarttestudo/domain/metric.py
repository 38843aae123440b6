# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers that a monitoring system collects, by the naming rules of Prometheus and OpenMetrics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum


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


Sample = tuple[tuple[str, ...], float]
"""The values of the labels, and the number that they have."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Metric:
    """A metric with its numbers now, at most one for the same labels."""

    name: MetricName
    samples: Sequence[Sample]
