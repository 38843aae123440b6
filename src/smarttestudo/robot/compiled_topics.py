# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of a live run that are relayed without Python, while nothing there needs their messages."""

from __future__ import annotations

from collections.abc import Callable, Sequence, Set
from functools import partial

from smarttestudo.domain.compiled_relay import (
    MAX_PERIOD_NS,
    CompiledRelay,
    CompiledRelays,
    RelayState,
)
from smarttestudo.loop.hand_over import count, hand_over, take_back
from smarttestudo.loop.relay import Relayed
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.pacing.grid import NEVER_NS, Pace
from smarttestudo.robot.sampling import LiveSampling
from smarttestudo.robot.topics import LiveTopics

MOST_MEAN_BYTES = 1 << 16
"""Larger messages cost the same either way, and nothing those that are not due while their topic rests."""


class CompiledTopics:
    """Hands topics to compiled relays and takes them back, with their pace, held messages and counts.

    Of the others, ``sampling`` decides which rest. ``passed`` is given what passes because a topic came back,
    ``copied`` each message of those that are recorded, with its topic.
    """

    def __init__(
        self,
        relays: CompiledRelays | None,
        loop: RelayLoop,
        sampling: LiveSampling,
        passed: Callable[[Sequence[Relayed]], None],
        copied: Callable[[str, bytes, bytes, int], None],
    ) -> None:
        self._relays = relays
        self._loop = loop
        self._sampling = sampling
        self._passed = passed
        self._give_copy = copied
        self._running: dict[str, CompiledRelay] = {}
        self._copied: Set[str] = frozenset()
        self._is_counted = False

    def look(self, topics: LiveTopics, now_ns: int, *, is_quiet: bool = False) -> None:
        """Decide by the plan as it is now which of ``topics`` are relayed so; one that rests works first.

        Where it ``is_quiet``, neither graph nor plan have changed since the last look: what is relayed so
        stays so.
        """
        staying = frozenset(self._running) if is_quiet and not self._is_counted else frozenset()
        self._is_counted = False
        compiled = () if self._relays is None else self._look(self._relays, topics, staying, now_ns)
        pausable = topics.pausable()
        self._sampling.look({topic: pausable[topic] for topic in pausable if topic not in compiled}, now_ns)

    def deliver(self, now_ns: int) -> None:
        """Give copies of all messages that were taken by ``now_ns``, on the clock."""
        if self._relays is not None and self._copied:
            self._relays.deliver(now_ns)

    def count(self, note: Callable[[Relayed], None]) -> None:
        """Have the statistics as of now; ``note`` is given the beginning of each last relayed message."""
        self._is_counted = True
        for topic, running in self._running.items():
            relay, counts = self._loop.relays.relay(topic), running.counts()
            if relay is not None:
                count(relay, counts)
            beginning, at_ns = counts.beginning, counts.relayed.last_ns
            if beginning:
                note(Relayed(topic, at_ns, beginning, len(beginning), repeated=False))

    def _look(self, relays: CompiledRelays, topics: LiveTopics, staying: Set[str], now_ns: int) -> Set[str]:
        ends, recorded = topics.ends(), topics.recorded
        # Messages of these are to be copied from now on, or no longer.
        anew = self._copied ^ recorded
        served = {topic for topic in ends if relays.serves(*ends[topic])}
        wanted = {
            topic for topic in served if topic in staying or self._suits(topic, is_recorded=topic in recorded)
        }
        for topic in self._running.keys() - (wanted - anew):
            self._running[topic].end()
        self._copied = wanted & recorded
        for topic in wanted - (staying - anew):
            running = self._running.get(topic)
            if running is not None:
                pace = self._pace(topic)
                running.set_pace(pace.period_ns, pace.slack_ns)
                continue
            state = partial(hand_over, self._loop.relays, topic, now_ns)
            copied = partial(self._give_copy, topic) if topic in recorded else None
            begun = relays.begin(*ends[topic], state, partial(self._take_back, topic), copied)
            if begun is not None:
                self._running[topic] = begun
        return wanted

    def _suits(self, topic: str, *, is_recorded: bool) -> bool:
        relay = self._loop.relays.relay(topic)
        if relay is None or not self._loop.may_skip(topic):
            return False
        arrived = relay.statistics.arrived
        is_small = arrived.messages > 0 and arrived.size_bytes <= MOST_MEAN_BYTES * arrived.messages
        period_ns = self._pace(topic).period_ns
        # A topic that is Off, or nearly, rests at no cost at all, unless it is recorded.
        return is_small and (period_ns <= MAX_PERIOD_NS or (is_recorded and period_ns == NEVER_NS))

    def _pace(self, topic: str) -> Pace:
        return Pace.at(self._loop.knowledge.plan[topic].rate.hz)

    def _take_back(self, topic: str, state: RelayState) -> None:
        self._running.pop(topic, None)
        self._passed(take_back(self._loop.relays, topic, state))
