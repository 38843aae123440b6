# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All that is known about one source: its values, its arrivals, and whether it is alive."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.profile import LevelUnit, TopicProfile
from smarttestudo.domain.rate_meter import SourcePeriod
from smarttestudo.domain.signal import ArrivalProperty, Signal, Values
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S, ns_from_s
from smarttestudo.language.properties import Reader, value_reader
from smarttestudo.language.region import Bound

WINDOW_S = 2
WINDOW_NS = WINDOW_S * NS_PER_S


class ArrivalWindow:
    """The arrivals of ``(now - 2 s, now]``, the source of the properties ``rate`` and ``bandwidth``."""

    __slots__ = ("_arrivals", "_bytes_gone", "_bytes_seen")

    def __init__(self) -> None:
        self._arrivals: deque[tuple[int, int]] = deque()
        self._bytes_seen = 0
        self._bytes_gone = 0

    def record(self, now_ns: int, size_bytes: int) -> None:
        self.forget(now_ns)
        self._bytes_seen += size_bytes
        self._arrivals.append((now_ns, self._bytes_seen))

    def forget(self, now_ns: int) -> None:
        """Drop what has left the window by ``now_ns``."""
        while self._arrivals and self._arrivals[0][0] <= now_ns - WINDOW_NS:
            _, self._bytes_gone = self._arrivals.popleft()

    def leaving(self, now_ns: int) -> int:
        """How many will have left the window by ``now_ns``."""
        oldest_first = enumerate(self._arrivals)
        is_in = (count for count, (stamp_ns, _) in oldest_first if stamp_ns > now_ns - WINDOW_NS)
        return next(is_in, len(self._arrivals))

    def rate_hz(self, leaving: int = 0) -> float:
        """Arrivals per second without the oldest ``leaving``."""
        return (len(self._arrivals) - leaving) / WINDOW_S

    def bandwidth_kb_per_s(self, leaving: int = 0) -> float:
        """KB per second without the oldest ``leaving`` arrivals."""
        gone = self._arrivals[leaving - 1][1] if leaving else self._bytes_gone
        return (self._bytes_seen - gone) / BYTES_PER_KB / WINDOW_S

    def falls_ns(self, measure: Callable[[int], float], cuts: Sequence[Bound]) -> int | None:
        """When, with nothing new arriving, ``measure`` crosses the next of ``cuts`` below it, if ever."""
        position = bisect_left(cuts, (measure(0), 0))
        if position == 0:
            return None
        cut = cuts[position - 1]
        counts = range(len(self._arrivals) + 1)
        leaving = bisect_left(counts, 1, key=lambda count: (measure(count), 0) < cut)
        if leaving == len(counts):
            return None
        return self._arrivals[leaving - 1][0] + WINDOW_NS


_LONGEST_NS = 2**62


class Arrivals:
    """Arrival properties that checks read, and when time alone takes one of them across a cut."""

    __slots__ = ("_ages_ns", "_cuts", "_window", "_window_is_read")

    def __init__(self, cuts: Mapping[ArrivalProperty, Sequence[Bound]]) -> None:
        self._cuts = cuts
        self._window = ArrivalWindow()
        self._window_is_read = bool(cuts.keys() - {ArrivalProperty.AGE})
        age_cuts = cuts.get(ArrivalProperty.AGE, ())
        self._ages_ns = sorted({_first_age_ns(cut) for cut in age_cuts if math.isfinite(cut[0])})

    def __bool__(self) -> bool:
        """Whether any of them is read."""
        return bool(self._cuts)

    def restore_history(self, before: Arrivals) -> None:
        """Take over the arrivals that ``before`` counted, if it did."""
        if before._window_is_read:
            self._window = before._window

    def record(self, now_ns: int, size_bytes: int) -> None:
        if self._window_is_read:
            self._window.record(now_ns, size_bytes)

    def values(self, now_ns: int, silent_since_ns: int) -> Iterator[tuple[ArrivalProperty, float]]:
        """The value of each property at ``now_ns``; to ask changes nothing."""
        for kind in self._cuts:
            if kind is ArrivalProperty.AGE:
                yield kind, (now_ns - silent_since_ns) / NS_PER_S
            else:
                yield kind, self._measure(kind)(self._window.leaving(now_ns))

    def changes_ns(self, now_ns: int, silent_since_ns: int) -> Iterator[int]:
        """When time alone next takes each property across a cut; for those that it will."""
        for kind, cuts in self._cuts.items():
            if kind is ArrivalProperty.AGE:
                position = bisect_right(self._ages_ns, now_ns - silent_since_ns)
                if position < len(self._ages_ns):
                    yield silent_since_ns + self._ages_ns[position]
            else:
                self._window.forget(now_ns)
                falls_ns = self._window.falls_ns(self._measure(kind), cuts)
                if falls_ns is not None:
                    yield falls_ns

    def _measure(self, kind: ArrivalProperty) -> Callable[[int], float]:
        is_rate = kind is ArrivalProperty.RATE
        return self._window.rate_hz if is_rate else self._window.bandwidth_kb_per_s


def _first_age_ns(cut: Bound) -> int:
    """The first age beyond ``cut``, found by the very comparison that checks use: floats round."""
    # Not bisect, which counts no further than 2**31 on a 32-bit machine: two seconds.
    shortest_ns, longest_ns = 0, _LONGEST_NS
    while shortest_ns < longest_ns:
        age_ns = (shortest_ns + longest_ns) // 2
        if (age_ns / NS_PER_S, 0) > cut:
            longest_ns = age_ns
        else:
            shortest_ns = age_ns + 1
    return shortest_ns


Reading = tuple[Signal, Values | None]
"""A signal's value; ``None`` is unknown."""


class Fields:
    """The values of each signal in the last message of one topic; NaN and missing fields are unknown.

    Until the topic's type is known, properties are plain field paths.
    """

    __slots__ = ("_level_unit", "_readers", "_readings", "_signals", "_type_name")

    def __init__(self, signals: Sequence[Signal], type_name: str, level_unit: LevelUnit | None) -> None:
        self._signals = signals
        self._level_unit = level_unit
        self._type_name = type_name
        self._readings = self.unknown_readings()
        self._readers = self._new_readers()

    def __bool__(self) -> bool:
        """Whether any field is read."""
        return bool(self._signals)

    def restore_history(self, before: Fields) -> None:
        """Take over the type, and the last values of the signals that ``before`` reads in the same way."""
        self.change_type(before._type_name)
        if self._type_name == before._type_name and self._level_unit is before._level_unit:
            readers, values = dict(before._readers), dict(before._readings)
            self._readers = [(signal, readers.get(signal, reader)) for signal, reader in self._readers]
            self._readings = [(signal, values.get(signal)) for signal in self._signals]

    def change_type(self, type_name: str) -> None:
        """Read messages of another type from now on; an empty name changes nothing."""
        if type_name not in {"", self._type_name}:
            self._type_name = type_name
            self._readers = self._new_readers()

    def forget(self) -> None:
        """The last message could not be read."""
        self._readings = self.unknown_readings()

    def read(self, message: object) -> list[Signal]:
        """Take the fields of ``message``; returns the signals that it leaves unknown."""
        values = [(signal, reader(message)) for signal, reader in self._readers]
        self._readings = [(signal, None if math.isnan(value) else value) for signal, value in values]
        return [signal for signal, value in self._readings if value is None]

    def readings(self) -> list[Reading]:
        return self._readings.copy()

    def unknown_readings(self) -> list[Reading]:
        """All signals as unknown."""
        return [(signal, None) for signal in self._signals]

    def _new_readers(self) -> list[tuple[Signal, Reader]]:
        return [
            (signal, value_reader(self._type_name, signal.property, self._level_unit))
            for signal in self._signals
        ]


class SourceState:
    """The arrivals of a topic and the state of its publishers.

    It is fresh from a message on until it is stale or the last publisher has left; then a publisher and a
    message must come, in either order: a latched message may arrive before its publisher is discovered.
    """

    __slots__ = (
        "_has_message",
        "_has_publishers",
        "_period",
        "_stale_after_ns",
        "_start_ns",
        "_transient_local",
    )

    def __init__(self, start_ns: int, stale_after_ns: int | None) -> None:
        self._start_ns = start_ns
        self._stale_after_ns = stale_after_ns
        self._period = SourcePeriod()
        self._has_message = False
        self._has_publishers = True
        self._transient_local = False

    def restore_history(self, before: SourceState) -> None:
        """Take over what ``before`` knows of the source."""
        self._start_ns = before._start_ns
        self._period = before._period
        self._has_message = before._has_message
        self._has_publishers = before._has_publishers
        self._transient_local = before._transient_local

    def record(self, now_ns: int) -> None:
        self._period.record(now_ns)
        self._has_message = True

    def change(self, change: SourceChanged) -> None:
        """Take a change of the publishers."""
        self._has_publishers = change.publishers > 0
        self._has_message = self._has_message and self._has_publishers
        self._transient_local = change.transient_local

    @property
    def silent_since_ns(self) -> int:
        """The time of the last message, or the loop's start."""
        return self._start_ns if self._period.last_ns is None else self._period.last_ns

    def is_fresh(self, now_ns: int) -> bool:
        """Whether the values of the last message still count."""
        if not (self._has_message and self._has_publishers):
            return False
        stale_from_ns = self.stale_from_ns
        return stale_from_ns is None or now_ns < stale_from_ns

    @property
    def stale_from_ns(self) -> int | None:
        """When the last message becomes stale; ``None`` while it never will."""
        return self._period.stale_from_ns(
            stale_after_ns=self._stale_after_ns, transient_local=self._transient_local
        )


class WatchedTopic:
    """The source of one topic, its fields and its arrivals, and from them the value of each signal."""

    __slots__ = ("_arrival_signals", "arrivals", "fields", "source")

    def __init__(
        self,
        signals: Iterable[Signal],
        profile: TopicProfile,
        start_ns: int,
        cuts: Callable[[Signal], Sequence[Bound]],
    ) -> None:
        kinds = {signal: ArrivalProperty.named(signal.property) for signal in signals}
        self._arrival_signals = {kind: signal for signal, kind in kinds.items() if kind is not None}
        self.arrivals = Arrivals({kind: cuts(signal) for kind, signal in self._arrival_signals.items()})
        self.fields = Fields(
            [signal for signal, kind in kinds.items() if kind is None],
            profile.type_name or "",
            profile.level_unit,
        )
        after_s = profile.stale_after_s
        self.source = SourceState(start_ns, None if after_s is None else ns_from_s(after_s))

    def restore_history(self, before: WatchedTopic) -> None:
        """Take over what ``before``, the same topic under other rules, knows."""
        self.source.restore_history(before.source)
        self.fields.restore_history(before.fields)
        self.arrivals.restore_history(before.arrivals)

    def change_source(self, change: SourceChanged) -> None:
        self.source.change(change)
        self.fields.change_type(change.type_name)

    def readings(self, now_ns: int) -> list[Reading]:
        """The value of every signal at ``now_ns``."""
        is_fresh = self.source.is_fresh(now_ns)
        readings = self.fields.readings() if is_fresh else self.fields.unknown_readings()
        if self.arrivals:
            for kind, value in self.arrivals.values(now_ns, self.source.silent_since_ns):
                readings.append((self._arrival_signals[kind], value))
        return readings

    def next_change_ns(self, now_ns: int) -> int | None:
        """When time alone next changes what a check makes of the topic."""
        stale_from_ns = self.source.stale_from_ns if self.fields else None
        changes_ns = [] if stale_from_ns is None or stale_from_ns <= now_ns else [stale_from_ns]
        if self.arrivals:
            changes_ns += self.arrivals.changes_ns(now_ns, self.source.silent_since_ns)
        return min(changes_ns, default=None)
