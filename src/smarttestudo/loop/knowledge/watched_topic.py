# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All that is known about one source: its values, its arrivals, and whether it is alive."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.profile import LevelUnit, TopicProfile
from smarttestudo.domain.rate_meter import SourcePeriod
from smarttestudo.domain.signal import ArrivalProperty, Signal
from smarttestudo.domain.units import ns_from_s
from smarttestudo.language.properties import Reader, value_reader
from smarttestudo.language.region import Bound
from smarttestudo.loop.knowledge.arrivals import Arrivals

Reading = tuple[Signal, float | None]
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
        """The last values."""
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
        "_has_publishers",
        "_is_heard",
        "_period",
        "_stale_after_ns",
        "_start_ns",
        "_transient_local",
    )

    def __init__(self, start_ns: int, stale_after_ns: int | None) -> None:
        self._start_ns = start_ns
        self._stale_after_ns = stale_after_ns
        self._period = SourcePeriod()
        self._is_heard = False
        self._has_publishers = True
        self._transient_local = False

    def restore_history(self, before: SourceState) -> None:
        """Take over what ``before`` knows of the source."""
        self._start_ns = before._start_ns
        self._period = before._period
        self._is_heard = before._is_heard
        self._has_publishers = before._has_publishers
        self._transient_local = before._transient_local

    def record(self, now_ns: int) -> None:
        """Count an arrival."""
        self._period.record(now_ns)
        self._is_heard = True

    def change(self, change: SourceChanged) -> None:
        """Take a change of the publishers."""
        self._has_publishers = change.publishers > 0
        self._is_heard = self._is_heard and self._has_publishers
        self._transient_local = change.transient_local

    @property
    def silent_since_ns(self) -> int:
        """The time of the last message, or the loop's start."""
        return self._start_ns if self._period.last_ns is None else self._period.last_ns

    def is_fresh(self, now_ns: int) -> bool:
        """Whether the values of the last message still count."""
        if not (self._is_heard and self._has_publishers):
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
        """Take a change of the source."""
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
