# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of a live run that are relayed without Python, while nothing there needs their messages at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from smarttestudo.domain.compiled_relay import (
    MAX_PERIOD_NS,
    CompiledRelay,
    CompiledRelays,
    Copying,
    MessageCopy,
    RelayState,
)
from smarttestudo.domain.rate_meter import Flow
from smarttestudo.domain.robot import Publisher, Subscription
from smarttestudo.domain.units import LAST_STAMP_NS
from smarttestudo.loop.hand_over import count, count_flow, hand_over, take_back, unrelayed
from smarttestudo.loop.relay import Relayed
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.pacing.grid import NEVER_NS, Pace

MOST_MEAN_BYTES = 1 << 16
"""Larger messages cost the same either way, and nothing those that are not due while their topic rests."""


Ends = tuple[Subscription, Publisher | None]
"""Where all messages of a topic come in and go out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RelayUse:
    """How a topic is relayed: by which publisher, and who is told of its messages."""

    publisher: Publisher | None
    is_relayed: bool
    is_recorded: bool
    is_counted: bool

    @property
    def wants_all(self) -> bool:
        """Whether somebody is told of each message."""
        return self.is_recorded or self.is_counted


class CompiledTopic:
    """A topic that may be relayed without Python: by ``relay``, if it is now, to whom ``use`` says.

    ``is_left`` says whether it was last to be relayed so. ``unrelayed`` counts what came of a topic that is
    received and not relayed.
    """

    __slots__ = ("is_left", "name", "relay", "unrelayed", "use")

    def __init__(self, name: str) -> None:
        self.name = name
        self.relay: CompiledRelay | None = None
        self.use: RelayUse | None = None
        self.is_left = False
        self.unrelayed: Flow | None = None


class CompiledTopics:
    """Hands topics to compiled relays and takes them back, with their pace, held messages and counts.

    ``came`` is told of each message of those that are recorded, or that a budget counts. ``passed`` is given
    what passes because a topic came back and, where ``is_returned``, all that passes: no relay publishes it.
    """

    def __init__(
        self,
        relays: CompiledRelays | None,
        loop: RelayLoop,
        passed: Callable[[Sequence[Relayed]], None],
        came: Callable[[str, MessageCopy], None],
        *,
        is_returned: bool = False,
    ) -> None:
        self._relays = relays
        self._loop = loop
        self._passed = passed
        self._came = came
        self.is_returned = is_returned
        self._running: list[CompiledTopic] = []
        self._told_ns, self._until_ns = 0, LAST_STAMP_NS
        """Between which stamps on the clock what is told came: beyond them the clock jumped to and fro."""

    @property
    def can_relay(self) -> bool:
        """Whether topics may be relayed so now."""
        return self._relays is not None and self._relays.can_relay

    def choose(self, topic: CompiledTopic, ends: Ends | None, now_ns: int, *, is_recorded: bool) -> None:
        """Decide by the plan as it is now whether ``topic`` is relayed so, between its ``ends`` if any."""
        use = self._use(topic.name, ends, is_recorded=is_recorded)
        wanted = use if use is not None and self._suits(topic, use) else None
        if topic.relay is not None and topic.use != wanted:
            topic.relay.end()
        if use is None or use.is_relayed:
            topic.unrelayed = None
        topic.is_left = wanted is not None
        if wanted is None or ends is None:
            return
        if topic.relay is None:
            self._begin(topic, ends[0], wanted, now_ns)
        else:
            topic.relay.set_pace(self._pace(topic.name).period_ns)

    def end(self, topic: CompiledTopic) -> None:
        """Take ``topic`` back."""
        if topic.relay is not None:
            topic.relay.end()

    def received(self, topic: CompiledTopic, size_bytes: int, now_ns: int) -> None:
        """A message of a topic came to Python, which is recorded only."""
        if self._relays is not None:
            if topic.unrelayed is None:
                topic.unrelayed = Flow()
            topic.unrelayed.record(now_ns, size_bytes)

    def deliver(self, now_ns: int) -> None:
        """Tell of all messages that came or passed by ``now_ns``, on the clock."""
        self._told_ns = min(self._told_ns, now_ns)
        self._deliver(now_ns)
        self._told_ns = now_ns

    def deliver_before(self, jump_ns: int, now_ns: int) -> None:
        """Tell of all that came before the clock jumped by so much, to ``now_ns``, or was set back."""
        self._deliver(now_ns - jump_ns)
        self._told_ns += jump_ns

    def _deliver(self, until_ns: int) -> None:
        self._until_ns = until_ns
        if self._relays is not None and self._running:
            self._relays.deliver(until_ns)

    def count(self, note: Callable[[Relayed], None]) -> None:
        """Have the statistics as of now; ``note`` is given the beginning of each last relayed message."""
        for topic in self._running:
            assert topic.relay is not None
            relay, counts = self._loop.relays.relay(topic.name), topic.relay.counts()
            if topic.unrelayed is not None:
                count_flow(topic.unrelayed, counts.arrived)
            elif relay is not None:
                count(relay, counts)
            beginning, at_ns = counts.beginning, counts.relayed.last_ns
            if beginning:
                note(Relayed(topic.name, at_ns, beginning, len(beginning), repeated=False))

    def leave_out(self, ahead_ns: int, now_ns: int) -> None:
        """The clock jumped ahead by so much, to ``now_ns``: take all topics back, with counts without that.

        To be called once the loop has left it out; what was copied since is told of.
        """
        self._until_ns = now_ns
        flows = [flow for topic in self._running for flow in self._flows(topic)]
        self._end_all()
        self._loop.relays.restart_grids(now_ns)
        for flow in flows:
            flow.leave_out(ahead_ns, now_ns)

    def close(self) -> None:
        """Take all topics back; what was copied until now is told of."""
        self._until_ns = LAST_STAMP_NS
        self._end_all()

    def _end_all(self) -> None:
        for topic in list(self._running):
            self.end(topic)

    def _flows(self, topic: CompiledTopic) -> Sequence[Flow]:
        relay = self._loop.relays.relay(topic.name)
        if topic.unrelayed is not None:
            return (topic.unrelayed,)
        return () if relay is None else (relay.statistics.arrived, relay.statistics.relayed)

    def _use(self, name: str, ends: Ends | None, *, is_recorded: bool) -> RelayUse | None:
        """How a topic would be relayed; ``None`` where no compiled relay can."""
        if ends is None or self._relays is None or not self._relays.serves(*ends):
            return None
        is_relayed = self._loop.relays.relay(name) is not None
        return RelayUse(
            publisher=ends[1],
            is_relayed=is_relayed,
            is_recorded=is_recorded,
            is_counted=is_relayed and self._loop.counts_all,
        )

    def _begin(self, topic: CompiledTopic, subscription: Subscription, use: RelayUse, now_ns: int) -> None:
        assert self._relays is not None
        if topic.unrelayed is None:
            state = partial(hand_over, self._loop.relays, topic.name, now_ns)
        else:
            state = partial(unrelayed, topic.unrelayed, now_ns)
        copying = Copying(
            came=partial(self._tell, topic.name) if use.wants_all else None,
            has_payload=use.is_recorded,
            passed=partial(self._return, topic.name) if use.is_relayed and self.is_returned else None,
        )
        relay = self._relays.begin(
            subscription, use.publisher, state, partial(self._take_back, topic), copying
        )
        if relay is not None:
            topic.relay, topic.use = relay, use
            self._running.append(topic)

    def _suits(self, topic: CompiledTopic, use: RelayUse) -> bool:
        relay = self._loop.relays.relay(topic.name)
        if relay is None:
            return topic.unrelayed is not None and _is_small(topic.unrelayed)
        period_ns = self._pace(topic.name).period_ns
        # A topic that is Off, or nearly, rests at no cost at all, unless all its messages are wanted.
        is_paced = period_ns <= MAX_PERIOD_NS or (use.wants_all and period_ns == NEVER_NS)
        return is_paced and self._loop.may_leave(topic.name) and _is_small(relay.statistics.arrived)

    def _pace(self, name: str) -> Pace:
        planned = self._loop.knowledge.plan.get(name)
        return Pace.at(0.0 if planned is None else planned.rate.hz)

    def _tell(self, name: str, copy: MessageCopy) -> None:
        if not self._told_ns <= copy.stamp_ns <= self._until_ns:
            copy = replace(copy, stamp_ns=max(self._told_ns, min(copy.stamp_ns, self._until_ns)))
        self._told_ns = copy.stamp_ns
        self._came(name, copy)

    def _return(self, name: str, copy: MessageCopy) -> None:
        payload, publisher = copy.payload or b"", copy.publisher
        passed = Relayed(name, copy.stamp_ns, payload, copy.size_bytes, repeated=False, publisher=publisher)
        self._passed([passed])

    def _take_back(self, topic: CompiledTopic, state: RelayState) -> None:
        if topic.relay is not None:
            topic.relay, topic.use = None, None
            self._running.remove(topic)
        if topic.unrelayed is not None:
            count_flow(topic.unrelayed, state.counts.arrived)
        else:
            self._passed(take_back(self._loop.relays, topic.name, state))


def _is_small(arrived: Flow) -> bool:
    return arrived.messages > 0 and arrived.size_bytes <= MOST_MEAN_BYTES * arrived.messages
