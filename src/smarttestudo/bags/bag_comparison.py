# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Two recordings beside each other."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated

from smarttestudo.bags.bag_summary import BagSummary, BagTotal
from smarttestudo.bags.comparison import Comparison, compare
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.record import JsonEntry, derived, to_columns
from smarttestudo.domain.units import grouped

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

    Where ``b`` is of the time of ``a``, its bandwidths count over that: where it has nothing, nothing came.
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
    is_empty = a.span.is_empty or b.span.is_empty
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
