# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is known about a topic that checks read."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from smarttestudo.adirf.region import Bound
from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.profile import TopicProfile
from smarttestudo.domain.signal import ArrivalProperty, Signal
from smarttestudo.domain.units import ns_from_s
from smarttestudo.runtime.knowledge.arrivals import Arrivals
from smarttestudo.runtime.knowledge.fields import Fields, Reading
from smarttestudo.runtime.knowledge.source_state import SourceState


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

    def carry_on(self, before: WatchedTopic) -> None:
        """Take over what ``before``, the same topic under other rules, knows."""
        self.source.carry_on(before.source)
        self.fields.carry_on(before.fields)
        self.arrivals.carry_on(before.arrivals)

    def change_source(self, change: SourceChanged) -> None:
        """Take what is said of the source."""
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
