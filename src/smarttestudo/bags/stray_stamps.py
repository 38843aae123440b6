# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages whose stamps are of another time than the recording, as from before a robot had its clock."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeVar

from smarttestudo.domain.recording import Channel, RecordedSize
from smarttestudo.domain.units import NS_PER_S, counted, grouped, utc_time

_DAY_NS = 86_400 * NS_PER_S
_YEAR_DAYS = 366
YEAR_NS = _YEAR_DAYS * _DAY_NS
"""A recording that lasts no longer has no stray stamps."""
LEAST_BACK_NS = NS_PER_S
"""A recorder that has several threads writes messages in another order than they came, by less than that."""
_MOST_TOPICS = 8

_T = TypeVar("_T")


@dataclass(frozen=True, slots=True, kw_only=True)
class StrayStamps:
    """Messages more than a year from the median of all stamps, by topic, and the span of the others.

    The median of two equal halves is in the later one.
    """

    days: range
    median_ns: int
    messages: Mapping[str, int]
    start_ns: int
    end_ns: int

    @property
    def total(self) -> int:
        """Messages of all topics."""
        return sum(self.messages.values())

    def left_out_of(self, entries: Iterator[tuple[Channel, int, _T]]) -> Iterator[tuple[Channel, int, _T]]:
        """``entries`` without these messages; their second item is the stamp."""
        days = self.days
        return (entry for entry in entries if entry[1] // _DAY_NS in days)

    def notice(self) -> str:
        """Number and topics of what was left out."""
        (first, count), *others = sorted(self.messages.items(), key=lambda one: (-one[1], one[0]))
        listed = [f"{counted(count, 'message')} of {first}"]
        listed += [f"{grouped(number)} of {topic}" for topic, number in others[: _MOST_TOPICS - 1]]
        rest = others[_MOST_TOPICS - 1 :]
        if rest:
            number = sum(count for _, count in rest)
            listed.append(f"{grouped(number)} of {counted(len(rest), 'other topic')}")
        day, *_ = utc_time(self.median_ns).split()
        return (
            f"left out of all numbers, as their stamps are more than a year from the median ({day}): "
            + ", ".join(listed)
        )


def stray_stamps(sizes: Iterable[RecordedSize]) -> StrayStamps | None:
    """The stray messages among ``sizes``, if there are any; memory grows with the days of the stamps."""
    counts: Counter[tuple[int, str]] = Counter()
    spans_ns: dict[int, tuple[int, int]] = {}
    for channel, stamp_ns, _ in sizes:
        day = stamp_ns // _DAY_NS
        counts[day, channel.topic] += 1
        first_ns, last_ns = spans_ns.get(day, (stamp_ns, stamp_ns))
        spans_ns[day] = min(first_ns, stamp_ns), max(last_ns, stamp_ns)
    if not counts:
        return None
    median = _median_day(counts)
    days = range(median - _YEAR_DAYS, median + _YEAR_DAYS + 1)
    strays: Counter[str] = Counter()
    for (day, topic), count in counts.items():
        if day not in days:
            strays[topic] += count
    if not strays:
        return None
    kept_ns = [span_ns for day, span_ns in spans_ns.items() if day in days]
    return StrayStamps(
        days=days,
        median_ns=spans_ns[median][0],
        messages=strays,
        start_ns=min(first_ns for first_ns, _ in kept_ns),
        end_ns=max(last_ns for _, last_ns in kept_ns),
    )


def _median_day(counts: Mapping[tuple[int, str], int]) -> int:
    left = sum(counts.values()) // 2
    for (day, _), count in sorted(counts.items()):
        if left < count:
            return day
        left -= count
    raise AssertionError("a count is positive")
