# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages that came over a link, and how old, beside what others brought over the same."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.report.table import MISSING, Align, Cell, Column, Number, Row, Table, Text

_SHARES = (0.5, 0.95, 1.0)
_TOPIC = Column(heading="Topic", align=Align.LEFT)


def quantile(ordered: Sequence[float], share: float) -> float:
    """The value that ``share`` of the values do not exceed. Raises ``IndexError`` where there is none."""
    return ordered[min(len(ordered) - 1, int(len(ordered) * share))]


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicArrivals:
    """Arrivals of a topic: rates at the robot and at the operator, and ages in s, the youngest first."""

    published_hz: float
    received_hz: float
    ages_s: Sequence[float]


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkArrivals:
    """Arrivals by one contender: those of each topic, and the share of the link it used, 0 … 1."""

    name: str
    used: float
    topics: Mapping[str, TopicArrivals]


def arrival_rates_table(contenders: Sequence[LinkArrivals]) -> Table:
    """The rate of each topic at the robot and at the operator, and how much of the link that took."""
    rows = []
    for topic in _topics(contenders):
        seen = [one.topics.get(topic) for one in contenders]
        published_hz = next((one.published_hz for one in seen if one is not None), None)
        received = (Number(None if one is None else one.received_hz) for one in seen)
        rows.append(Row(cells=(Text(topic), Number(published_hz), *received)))
    used = (Text(f"{one.used:.0%}") for one in contenders)
    rows.append(Row(cells=(Text("Share of the link used"), Text(MISSING), *used), is_total=True))
    return Table(
        title="Rate at the operator",
        columns=(
            _TOPIC,
            Column(heading="Published", unit="Hz"),
            *(Column(heading=one.name, unit="Hz") for one in contenders),
        ),
        rows=tuple(rows),
    )


def arrival_ages_table(contenders: Sequence[LinkArrivals]) -> Table:
    """How old each topic's messages were when they arrived."""
    return Table(
        title="Age at the operator: p50, p95 and maximum",
        columns=(_TOPIC, *(Column(heading=one.name, unit="s") for one in contenders)),
        rows=tuple(
            Row(cells=(Text(topic), *(_ages(one.topics.get(topic)) for one in contenders)))
            for topic in _topics(contenders)
        ),
        footnotes=(
            "Age: from when a subscriber beside the robot had a message to when the operator had its bytes.",
        ),
    )


def _ages(arrivals: TopicArrivals | None) -> Cell:
    if arrivals is None or not arrivals.ages_s:
        return Text(MISSING)
    return Text("  ".join(f"{quantile(arrivals.ages_s, share):.2f}" for share in _SHARES))


def _topics(contenders: Sequence[LinkArrivals]) -> Iterator[str]:
    yield from sorted({topic for one in contenders for topic in one.topics})
