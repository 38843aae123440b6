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
from smarttestudo.domain.signal import ArrivalProperty, Signal, SignalKind, Values
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S, ns_from_s
from smarttestudo.language.properties import SignalReader, reads_element, signal_reader
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

    An element that the last message does not have keeps the value that it had. Until the topic's type is
    known, properties are plain field paths.
    """

    __slots__ = (
        "_elements",
        "_kinds",
        "_level_unit",
        "_only_kind",
        "_readers",
        "_readings",
        "_signals",
        "_type_name",
    )

    def __init__(self, signals: Sequence[Signal], type_name: str, level_unit: LevelUnit | None) -> None:
        self._signals = signals
        self._level_unit = level_unit
        self._type_name = type_name
        self._elements = {
            place: SourcePeriod() for place, signal in enumerate(signals) if reads_element(signal.property)
        }
        whole = (signal for place, signal in enumerate(signals) if place not in self._elements)
        self._kinds = sorted({signal.kind for signal in whole})
        # Most topics have fields of one kind alone, and a message of them is to cost no more than it must.
        self._only_kind = self._kinds[0] if len(self._kinds) == 1 and not self._elements else None
        self._readings = self.unknown_readings()
        self._readers = self._new_readers()

    def __bool__(self) -> bool:
        """Whether any field is read."""
        return bool(self._signals)

    def restore_history(self, before: Fields) -> None:
        """Take over the type, and the last values of the signals that ``before`` reads in the same way."""
        self.change_type(before._type_name)
        if self._type_name != before._type_name or self._level_unit is not before._level_unit:
            return
        readers = {_way_of(signal): reader for signal, reader in before._readers}
        values = {_way_of(signal): value for signal, value in before._readings}
        self._readers = [(signal, readers.get(_way_of(signal), reader)) for signal, reader in self._readers]
        self._readings = [(signal, values.get(_way_of(signal))) for signal in self._signals]
        periods = {_way_of(before._signals[place]): period for place, period in before._elements.items()}
        for place, period in self._elements.items():
            self._elements[place] = periods.get(_way_of(self._signals[place]), period)

    def change_type(self, type_name: str) -> None:
        """Read messages of another type from now on; an empty name changes nothing."""
        if type_name not in {"", self._type_name}:
            self._type_name = type_name
            self._readers = self._new_readers()

    def forget(self) -> None:
        """The last message could not be read, or nobody is there who could send the next one."""
        self._readings = self.unknown_readings()

    def read(self, message: object, now_ns: int) -> list[Signal]:
        """Take the fields of ``message``; returns the signals that it leaves unknown."""
        before = self._readings
        found = [(signal, reader(message)) for signal, reader in self._readers]
        # NaN differs from itself; a text is no number that ``isnan`` takes.
        self._readings = [(signal, None if value != value else value) for signal, value in found]  # noqa: PLR0124
        unknown = [signal for signal, value in self._readings if value is None]
        for place, period in self._elements.items():
            signal, value = found[place]
            if value is None:
                self._readings[place] = before[place]
                unknown.remove(signal)
            else:
                period.record(now_ns)
        return unknown

    def readings(self, source: SourceState, now_ns: int) -> list[Reading]:
        """The values that still count at ``now_ns``."""
        if not source.has_value:
            return self.unknown_readings()
        if self._only_kind is not None:
            is_fresh = source.is_fresh(now_ns, self._only_kind)
            return self._readings.copy() if is_fresh else self.unknown_readings()
        stale = [kind for kind in self._kinds if not source.is_fresh(now_ns, kind)]
        readings = [(signal, None if signal.kind in stale else value) for signal, value in self._readings]
        for place, period in self._elements.items():
            signal, value = self._readings[place]
            readings[place] = signal, value if source.is_fresh(now_ns, signal.kind, period) else None
        return readings

    def stale_from_ns(self, source: SourceState, now_ns: int) -> int | None:
        """When the next value becomes stale if no message comes; ``None`` while none will."""
        if self._only_kind is not None:
            at_ns = source.stale_from_ns(self._only_kind)
            return at_ns if at_ns is not None and at_ns > now_ns else None
        stale_ns = [source.stale_from_ns(kind) for kind in self._kinds]
        for place, period in self._elements.items():
            stale_ns.append(source.stale_from_ns(self._signals[place].kind, period))
        return min((at_ns for at_ns in stale_ns if at_ns is not None and at_ns > now_ns), default=None)

    def unknown_readings(self) -> list[Reading]:
        """All signals as unknown."""
        return [(signal, None) for signal in self._signals]

    def _new_readers(self) -> list[tuple[Signal, SignalReader]]:
        made: dict[tuple[str, bool], SignalReader] = {}
        for signal in self._signals:
            if _way_of(signal) not in made:
                made[_way_of(signal)] = signal_reader(self._type_name, signal, self._level_unit)
        return [(signal, made[_way_of(signal)]) for signal in self._signals]


def _way_of(signal: Signal) -> tuple[str, bool]:
    """How it is read: a number and a state are by one reader, which may remember what came before."""
    return signal.property, signal.kind is SignalKind.TEXT


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

    @property
    def has_value(self) -> bool:
        """Whether a publisher is there, and has sent a message."""
        return self._has_message and self._has_publishers

    def is_fresh(self, now_ns: int, kind: SignalKind, period: SourcePeriod | None = None) -> bool:
        """Whether values of that kind still count, while there is a publisher."""
        stale_from_ns = self.stale_from_ns(kind, period)
        return stale_from_ns is None or now_ns < stale_from_ns

    def stale_from_ns(self, kind: SignalKind, period: SourcePeriod | None = None) -> int | None:
        """When values of that kind become stale; ``None`` while they never will.

        Words are published when they change, and last as latched messages do. An element that comes in
        ``period`` becomes stale by that.
        """
        return (period or self._period).stale_from_ns(
            stale_after_ns=self._stale_after_ns,
            transient_local=self._transient_local or kind is not SignalKind.NUMBER,
        )


class WatchedTopic:
    """The source of one topic, its fields and its arrivals, and from them the value of each signal.

    What is compared with a constant that nobody knows is not read, and stays unknown.
    """

    __slots__ = ("_arrival_signals", "_unread", "arrivals", "fields", "source")

    def __init__(
        self,
        signals: Iterable[Signal],
        profile: TopicProfile,
        start_ns: int,
        cuts: Callable[[Signal], Sequence[Bound]],
    ) -> None:
        self._arrival_signals: dict[ArrivalProperty, list[Signal]] = {}
        self._unread: list[Reading] = []
        fields: list[Signal] = []
        for signal in signals:
            arrival = ArrivalProperty.named(signal.property)
            if signal.kind is SignalKind.UNRESOLVED or (arrival and signal.kind is SignalKind.TEXT):
                self._unread.append((signal, None))
            elif arrival is None:
                fields.append(signal)
            else:
                self._arrival_signals.setdefault(arrival, []).append(signal)
        self.arrivals = Arrivals(
            {
                arrival: sorted({cut for signal in read for cut in cuts(signal)})
                for arrival, read in self._arrival_signals.items()
            }
        )
        self.fields = Fields(fields, profile.type_name or "", profile.level_unit)
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
        if not change.publishers:
            self.fields.forget()

    def readings(self, now_ns: int) -> list[Reading]:
        """The value of every signal at ``now_ns``."""
        readings = self.fields.readings(self.source, now_ns)
        if self.arrivals:
            for arrival, value in self.arrivals.values(now_ns, self.source.silent_since_ns):
                readings += [(signal, value) for signal in self._arrival_signals[arrival]]
        return readings + self._unread if self._unread else readings

    def next_change_ns(self, now_ns: int) -> int | None:
        """When time alone next changes what a check makes of the topic."""
        stale_from_ns = self.fields.stale_from_ns(self.source, now_ns)
        changes_ns = [] if stale_from_ns is None else [stale_from_ns]
        if self.arrivals:
            changes_ns += self.arrivals.changes_ns(now_ns, self.source.silent_since_ns)
        return min(changes_ns, default=None)
