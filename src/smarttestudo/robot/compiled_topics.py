# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of a live run that are relayed without Python, while nothing there needs their messages at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence, Set
from dataclasses import dataclass
from functools import partial

from smarttestudo.domain.compiled_relay import (
    MAX_PERIOD_NS,
    CompiledRelay,
    CompiledRelays,
    RelayState,
)
from smarttestudo.domain.rate_meter import Flow
from smarttestudo.domain.robot import Publisher, Subscription
from smarttestudo.loop.hand_over import count, count_flow, hand_over, take_back, unrelayed
from smarttestudo.loop.relay import Relayed
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.pacing.grid import NEVER_NS, Pace
from smarttestudo.robot.sampling import LiveSampling
from smarttestudo.robot.topics import LiveTopics

MOST_MEAN_BYTES = 1 << 16
"""Larger messages cost the same either way, and nothing those that are not due while their topic rests."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Running:
    """A relay, what it publishes by, and whether its messages are copied."""

    relay: CompiledRelay
    publisher: Publisher | None
    is_copied: bool


class CompiledTopics:
    """Hands topics to compiled relays and takes them back, with their pace, held messages and counts.

    Those that are only recorded may be among them; where ``records_only``, no others are. Of all that are not
    handed over, ``sampling`` decides which rest. ``passed`` is given what passes because a topic came back,
    ``copied`` each message of those that are recorded, with its topic.
    """

    def __init__(
        self,
        relays: CompiledRelays | None,
        loop: RelayLoop,
        sampling: LiveSampling,
        passed: Callable[[Sequence[Relayed]], None],
        copied: Callable[[str, bytes, bytes, int], None],
        *,
        records_only: bool = False,
    ) -> None:
        self._relays = relays
        self._loop = loop
        self._sampling = sampling
        self._passed = passed
        self._copied = copied
        self._records_only = records_only
        self._running: dict[str, _Running] = {}
        self._unrelayed: dict[str, Flow] = {}
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

    def received(self, topic: str, size_bytes: int, now_ns: int) -> None:
        """A message of a topic came to Python, which is recorded only."""
        if self._relays is not None:
            self._unrelayed.setdefault(topic, Flow()).record(now_ns, size_bytes)

    def deliver(self, now_ns: int) -> None:
        """Give copies of all messages that were taken by ``now_ns``, on the clock."""
        if self._relays is not None and self._running:
            self._relays.deliver(now_ns)

    def count(self, note: Callable[[Relayed], None]) -> None:
        """Have the statistics as of now; ``note`` is given the beginning of each last relayed message."""
        self._is_counted = True
        for topic, running in self._running.items():
            relay, counts = self._loop.relays.relay(topic), running.relay.counts()
            if running.publisher is None:
                count_flow(self._unrelayed[topic], counts.arrived)
            elif relay is not None:
                count(relay, counts)
            beginning, at_ns = counts.beginning, counts.relayed.last_ns
            if beginning:
                note(Relayed(topic, at_ns, beginning, len(beginning), repeated=False))

    def close(self) -> None:
        """Take all topics back; what was copied until now is given."""
        for running in list(self._running.values()):
            running.relay.end()

    def _look(self, relays: CompiledRelays, topics: LiveTopics, staying: Set[str], now_ns: int) -> Set[str]:
        recorded = topics.recorded
        self._unrelayed = {topic: flow for topic, flow in self._unrelayed.items() if topic in recorded}
        wanted = {
            topic: ends
            for topic, ends in topics.ends().items()
            if relays.serves(*ends)
            if topic in staying or self._suits(topic, ends[1], is_recorded=topic in recorded)
        }
        for topic, running in list(self._running.items()):
            is_same = topic in wanted and running.publisher is wanted[topic][1]
            if not is_same or running.is_copied != (topic in recorded):
                running.relay.end()
        for topic, ends in wanted.items():
            if topic not in self._running:
                self._begin(relays, topic, ends, now_ns, is_copied=topic in recorded)
            elif topic not in staying:
                pace = self._pace(topic)
                self._running[topic].relay.set_pace(pace.period_ns, pace.slack_ns)
        return wanted.keys()

    def _begin(
        self,
        relays: CompiledRelays,
        topic: str,
        ends: tuple[Subscription, Publisher | None],
        now_ns: int,
        *,
        is_copied: bool,
    ) -> None:
        state = partial(hand_over, self._loop.relays, topic, now_ns)
        if ends[1] is None:
            state = partial(unrelayed, self._unrelayed[topic], now_ns)
        copied = partial(self._copied, topic) if is_copied else None
        relay = relays.begin(*ends, state, partial(self._take_back, topic), copied)
        if relay is not None:
            self._running[topic] = _Running(relay=relay, publisher=ends[1], is_copied=is_copied)

    def _suits(self, topic: str, publisher: Publisher | None, *, is_recorded: bool) -> bool:
        relay = self._loop.relays.relay(topic)
        if relay is None or publisher is None:
            arrived = self._unrelayed.get(topic)
            return relay is None and publisher is None and arrived is not None and _is_small(arrived)
        if self._records_only or not self._loop.may_skip(topic):
            return False
        period_ns = self._pace(topic).period_ns
        # A topic that is Off, or nearly, rests at no cost at all, unless it is recorded.
        is_paced = period_ns <= MAX_PERIOD_NS or (is_recorded and period_ns == NEVER_NS)
        return is_paced and _is_small(relay.statistics.arrived)

    def _pace(self, topic: str) -> Pace:
        planned = self._loop.knowledge.plan.get(topic)
        return Pace.at(0.0 if planned is None else planned.rate.hz)

    def _take_back(self, topic: str, state: RelayState) -> None:
        running = self._running.pop(topic, None)
        if running is None or running.publisher is not None:
            self._passed(take_back(self._loop.relays, topic, state))
        elif topic in self._unrelayed:
            count_flow(self._unrelayed[topic], state.counts.arrived)


def _is_small(arrived: Flow) -> bool:
    return arrived.messages > 0 and arrived.size_bytes <= MOST_MEAN_BYTES * arrived.messages
