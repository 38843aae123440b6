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
_BY_FAR = 30
_FEW = 10
LEAST_STRAY_NS = _BY_FAR * _DAY_NS
"""A recording that lasts no longer has no stray stamps."""
LEAST_BACK_NS = NS_PER_S
"""Within that time, a recorder of several threads writes messages in another order than that of arrival."""
_MOST_TOPICS = 8

_T = TypeVar("_T")


@dataclass(frozen=True, slots=True, kw_only=True)
class StrayStamps:
    """Messages far from the median of all stamps, by topic, and the span of the others.

    Far is more than ``limit_days``: a year for at most half of the messages, where a gap of a month parts
    them from the others; for at most a tenth, 30 times as many days as all others are from the median. The
    median of two equal halves is in the later one. Latched messages of before hold from the start on.
    """

    limit_days: int
    days: range
    median_ns: int
    messages: Mapping[str, int]
    latched: Mapping[str, int]
    start_ns: int
    end_ns: int

    @property
    def total(self) -> int:
        """Messages of all topics that are left out."""
        return sum(self.messages.values())

    def left_out_of(self, entries: Iterator[tuple[Channel, int, _T]]) -> Iterator[tuple[Channel, int, _T]]:
        """``entries`` without these messages; their second item is the stamp."""
        days, start_ns = self.days, self.start_ns
        for channel, stamp_ns, content in entries:
            day = stamp_ns // _DAY_NS
            if day in days:
                yield channel, stamp_ns, content
            elif day < days.start and _is_latched(channel):
                yield channel, start_ns, content

    def notice(self) -> str:
        """Number and topics of what was left out, and of what was latched."""
        day, *_ = utc_time(self.median_ns).split()
        far = "a year" if self.limit_days == _YEAR_DAYS else f"{self.limit_days} days"
        why = f"as their stamps are more than {far} from the median ({day})"
        ways = {"left out of all numbers": self.messages, "latched, and so held from the start": self.latched}
        return "; ".join(f"{way}, {why}: {_listed(counts)}" for way, counts in ways.items() if counts)


def _listed(counts: Mapping[str, int]) -> str:
    (first, count), *others = sorted(counts.items(), key=lambda item: (-item[1], item[0]))
    listed = [f"{counted(count, 'message')} of {first}"]
    listed += [f"{grouped(number)} of {topic}" for topic, number in others[: _MOST_TOPICS - 1]]
    rest = others[_MOST_TOPICS - 1 :]
    if rest:
        number = sum(count for _, count in rest)
        listed.append(f"{grouped(number)} of {counted(len(rest), 'other topic')}")
    return ", ".join(listed)


def _is_latched(channel: Channel) -> bool:
    """Whether messages are kept for who comes later; many files lack the QoS of /tf_static that says so."""
    return channel.transient_local or channel.topic.endswith("/tf_static")


def stray_stamps(sizes: Iterable[RecordedSize]) -> StrayStamps | None:
    """The stray messages among ``sizes``, if there are any; memory grows with the days of the stamps."""
    counts: Counter[tuple[int, str]] = Counter()
    spans_ns: dict[int, tuple[int, int]] = {}
    latched_topics: set[str] = set()
    for channel, stamp_ns, _ in sizes:
        day = stamp_ns // _DAY_NS
        counts[day, channel.topic] += 1
        if _is_latched(channel):
            latched_topics.add(channel.topic)
        first_ns, last_ns = spans_ns.get(day, (stamp_ns, stamp_ns))
        spans_ns[day] = min(first_ns, stamp_ns), max(last_ns, stamp_ns)
    if not counts:
        return None
    median = _median_day(counts)
    limit_days = _limit_days(counts, median)
    if limit_days is None:
        return None
    days = range(median - limit_days, median + limit_days + 1)
    strays, latched = Counter[str](), Counter[str]()
    for (day, topic), count in counts.items():
        if day < days.start and topic in latched_topics:
            latched[topic] += count
        elif day not in days:
            strays[topic] += count
    kept_ns = [span_ns for day, span_ns in spans_ns.items() if day in days]
    return StrayStamps(
        limit_days=limit_days,
        days=days,
        median_ns=spans_ns[median][0],
        messages=strays,
        latched=latched,
        start_ns=min(first_ns for first_ns, _ in kept_ns),
        end_ns=max(last_ns for _, last_ns in kept_ns),
    )


def _limit_days(counts: Mapping[tuple[int, str], int], median: int) -> int | None:
    """How far from the median messages may be; ``None`` where there are no strays."""
    by_distance: Counter[int] = Counter()
    for (day, _), count in counts.items():
        by_distance[abs(day - median)] += count
    total = left = by_distance.total()
    radius_days = 1
    for distance_days, count in sorted(by_distance.items()):
        is_by_far = distance_days > _BY_FAR * radius_days and left * _FEW <= total
        if is_by_far and distance_days <= _YEAR_DAYS:
            return _BY_FAR * radius_days
        is_after_gap = distance_days > radius_days + _BY_FAR and left * 2 <= total
        if distance_days > _YEAR_DAYS and (radius_days <= _YEAR_DAYS):
            return _YEAR_DAYS if is_after_gap else None
        radius_days = max(radius_days, distance_days)
        left -= count
    return None


def _median_day(counts: Mapping[tuple[int, str], int]) -> int:
    left = sum(counts.values()) // 2
    for (day, _), count in sorted(counts.items()):
        if left < count:
            return day
        left -= count
    raise AssertionError("a count is positive")
