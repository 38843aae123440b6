# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of a live run that are relayed without Python, while nothing there needs their messages."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial

from smarttestudo.domain.compiled_relay import (
    MAX_PERIOD_NS,
    CompiledRelay,
    CompiledRelays,
    FlowCounts,
    RelayCounts,
    RelayState,
)
from smarttestudo.domain.rate_meter import Flow
from smarttestudo.domain.robot import Publisher, Subscription
from smarttestudo.loop.relay import Relayed
from smarttestudo.loop.relay_loop import RelayLoop

MOST_MEAN_BYTES = 1 << 16
"""Larger messages cost the same either way, and nothing those that are not due while their topic rests."""


class CompiledTopics:
    """Hands topics to compiled relays and takes them back, with their pace, held messages and counts.

    ``passed`` is given what passes because a topic came back.
    """

    def __init__(
        self, relays: CompiledRelays | None, loop: RelayLoop, passed: Callable[[Sequence[Relayed]], None]
    ) -> None:
        self._relays = relays
        self._loop = loop
        self._passed = passed
        self._running: dict[str, CompiledRelay] = {}

    def look(self, topics: Mapping[str, tuple[Subscription, Publisher]], now_ns: int) -> Collection[str]:
        """Which of ``topics``, the only ones that may be, are to be relayed so by the plan as it is now.

        One that rests has to work first.
        """
        if self._relays is None:
            return ()
        wanted = {
            topic: ends for topic, ends in topics.items() if self._relays.serves(*ends) and self._suits(topic)
        }
        for topic in [topic for topic in self._running if topic not in wanted]:
            self._running[topic].end()
        for topic, (subscription, publisher) in wanted.items():
            running = self._running.get(topic)
            if running is not None:
                self._follow(topic, running)
                continue
            begun = self._relays.begin(
                subscription,
                publisher,
                partial(self._hand_over, topic, now_ns),
                partial(self._take_back, topic),
            )
            if begun is not None:
                self._running[topic] = begun
        return wanted

    def count(self, note: Callable[[Relayed], None]) -> None:
        """Have the statistics as of now; ``note`` is given the beginning of each last relayed message."""
        for topic, running in self._running.items():
            counts = running.counts()
            self._count(topic, counts)
            relayed = counts.relayed
            if counts.beginning:
                note(Relayed(topic, relayed.last_ns, counts.beginning, len(counts.beginning), repeated=False))

    def _suits(self, topic: str) -> bool:
        loop = self._loop
        if not loop.may_skip(topic):
            return False
        arrived = loop.relays.statistics[topic].arrived
        is_small = arrived.messages > 0 and arrived.size_bytes <= MOST_MEAN_BYTES * arrived.messages
        # A topic that is Off, or nearly, rests at no cost at all.
        return is_small and loop.relays.pace(topic).period_ns <= MAX_PERIOD_NS

    def _follow(self, topic: str, running: CompiledRelay) -> None:
        pace = self._loop.relays.pace(topic)
        running.set_pace(pace.period_ns, pace.slack_ns)
        self._count(topic, running.counts())

    def _hand_over(self, topic: str, now_ns: int) -> RelayState:
        relays = self._loop.relays
        pace, statistics = relays.pace(topic), relays.statistics[topic]
        return RelayState(
            now_ns=now_ns,
            period_ns=pace.period_ns,
            slack_ns=pace.slack_ns,
            streams=relays.hand_over(topic),
            counts=RelayCounts(arrived=_counts(statistics.arrived), relayed=_counts(statistics.relayed)),
        )

    def _take_back(self, topic: str, state: RelayState) -> None:
        del self._running[topic]
        self._count(topic, state.counts)
        self._passed(self._loop.relays.take_back(topic, state))

    def _count(self, topic: str, counts: RelayCounts) -> None:
        statistics = self._loop.relays.statistics.get(topic)
        if statistics is not None:
            _set(statistics.arrived, counts.arrived)
            _set(statistics.relayed, counts.relayed)


def _counts(flow: Flow) -> FlowCounts:
    return FlowCounts(
        messages=flow.messages, size_bytes=flow.size_bytes, span_ns=flow.span_ns, last_ns=flow.last_ns
    )


def _set(flow: Flow, counts: FlowCounts) -> None:
    flow.messages, flow.size_bytes = counts.messages, counts.size_bytes
    flow.span_ns, flow.last_ns = counts.span_ns, counts.last_ns
