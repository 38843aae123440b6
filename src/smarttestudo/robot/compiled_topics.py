# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of a live run that are relayed without Python, while nothing there needs their messages at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
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
from smarttestudo.robot.sampling import LiveSampling
from smarttestudo.robot.settled_topics import Ends
from smarttestudo.robot.topics import LiveTopics

MOST_MEAN_BYTES = 1 << 16
"""Larger messages cost the same either way, and nothing those that are not due while their topic rests."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Use:
    """How a topic is relayed: by which publisher, and who is told of its messages."""

    publisher: Publisher | None
    is_relayed: bool
    is_recorded: bool
    is_counted: bool

    @property
    def wants_all(self) -> bool:
        """Whether somebody is told of each message."""
        return self.is_recorded or self.is_counted


class CompiledTopics:
    """Hands topics to compiled relays and takes them back, with their pace, held messages and counts.

    Those that are only recorded may be among them; of all others, ``sampling`` decides which rest. ``came``
    is told of each message of those that are recorded, or that a budget counts. ``passed`` is given what
    passes because a topic came back and, where ``is_returned``, all that passes, which no relay publishes.
    """

    def __init__(
        self,
        relays: CompiledRelays | None,
        loop: RelayLoop,
        sampling: LiveSampling,
        passed: Callable[[Sequence[Relayed]], None],
        came: Callable[[str, MessageCopy], None],
        *,
        is_returned: bool = False,
    ) -> None:
        self._relays = relays
        self._loop = loop
        self._sampling = sampling
        self._passed = passed
        self._came = came
        self._is_returned = is_returned
        self._running: dict[str, tuple[CompiledRelay, _Use]] = {}
        self._unrelayed: dict[str, Flow] = {}
        self._sampled: Mapping[str, Subscription] = {}
        self._told_ns, self._until_ns = 0, LAST_STAMP_NS
        """Between which stamps on the clock what is told came: beyond them the clock jumped to and fro."""
        self._polled: object = None
        """What the last poll found, where another one that finds the same would decide the same."""

    def choose(self, topics: LiveTopics, now_ns: int, *, is_quiet: bool = False) -> None:
        """Decide by the plan as it is now which of ``topics`` are relayed so; one that rests works first.

        Where it ``is_quiet``, neither graph nor plan have changed since the last poll.
        """
        relays, pausable = self._relays, topics.pausable()
        ends: Ends = {}
        if relays is not None and relays.can_relay:
            ends = topics.ends(is_published=not self._is_returned)
        found = (ends, pausable, topics.recorded, self._loop.counts_all)
        if not is_quiet or found != self._polled:
            wanted = {} if relays is None else self._choose(relays, ends, topics.recorded, now_ns)
            self._sampled = {topic: pausable[topic] for topic in pausable if topic not in wanted}
            # What is not relayed so may be as soon as a message comes.
            self._polled = found if self._running.keys() == ends.keys() else None
        self._sampling.choose(self._sampled, now_ns)

    def received(self, topic: str, size_bytes: int, now_ns: int) -> None:
        """A message of a topic came to Python, which is recorded only."""
        if self._relays is not None:
            self._unrelayed.setdefault(topic, Flow()).record(now_ns, size_bytes)

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
        self._polled = None
        for topic, (running, use) in self._running.items():
            relay, counts = self._loop.relays.relay(topic), running.counts()
            if not use.is_relayed:
                count_flow(self._unrelayed[topic], counts.arrived)
            elif relay is not None:
                count(relay, counts)
            beginning, at_ns = counts.beginning, counts.relayed.last_ns
            if beginning:
                note(Relayed(topic, at_ns, beginning, len(beginning), repeated=False))

    def leave_out(self, ahead_ns: int, now_ns: int) -> None:
        """The clock jumped ahead by so much, to ``now_ns``: take all topics back, with counts without that.

        To be called once the loop has left it out; what was copied since is told of.
        """
        self._polled = None
        self._until_ns = now_ns
        flows = [flow for topic, (_, use) in self._running.items() for flow in self._flows(topic, use)]
        self._end_all()
        self._loop.relays.restart_grids(now_ns)
        for flow in flows:
            flow.leave_out(ahead_ns, now_ns)

    def close(self) -> None:
        """Take all topics back; what was copied until now is told of."""
        self._until_ns = LAST_STAMP_NS
        self._end_all()

    def _end_all(self) -> None:
        for relay, _ in list(self._running.values()):
            relay.end()

    def _flows(self, topic: str, use: _Use) -> Sequence[Flow]:
        relay = self._loop.relays.relay(topic)
        if not use.is_relayed:
            return (self._unrelayed[topic],)
        return () if relay is None else (relay.statistics.arrived, relay.statistics.relayed)

    def _choose(
        self, relays: CompiledRelays, ends: Ends, recorded: Set[str], now_ns: int
    ) -> Mapping[str, _Use]:
        uses = {
            topic: self._use(topic, publisher, is_recorded=topic in recorded)
            for topic, (subscription, publisher) in ends.items()
            if relays.serves(subscription, publisher)
        }
        wanted = {topic: use for topic, use in uses.items() if self._suits(topic, use)}
        for topic, (relay, use) in list(self._running.items()):
            if wanted.get(topic) != use:
                relay.end()
        self._unrelayed = {
            topic: flow
            for topic, flow in self._unrelayed.items()
            if topic in uses and not uses[topic].is_relayed
        }
        for topic, use in wanted.items():
            if topic not in self._running:
                self._begin(relays, topic, ends[topic][0], use, now_ns)
            else:
                self._running[topic][0].set_pace(self._pace(topic).period_ns)
        return wanted

    def _use(self, topic: str, publisher: Publisher | None, *, is_recorded: bool) -> _Use:
        is_relayed = self._loop.relays.relay(topic) is not None
        return _Use(
            publisher=publisher,
            is_relayed=is_relayed,
            is_recorded=is_recorded,
            is_counted=is_relayed and self._loop.counts_all,
        )

    def _begin(
        self, relays: CompiledRelays, topic: str, subscription: Subscription, use: _Use, now_ns: int
    ) -> None:
        if use.is_relayed:
            state = partial(hand_over, self._loop.relays, topic, now_ns)
        else:
            state = partial(unrelayed, self._unrelayed[topic], now_ns)
        copying = Copying(
            came=partial(self._tell, topic) if use.wants_all else None,
            has_payload=use.is_recorded,
            passed=partial(self._return, topic) if use.is_relayed and self._is_returned else None,
        )
        relay = relays.begin(subscription, use.publisher, state, partial(self._take_back, topic), copying)
        if relay is not None:
            self._running[topic] = relay, use

    def _suits(self, topic: str, use: _Use) -> bool:
        relay = self._loop.relays.relay(topic)
        if relay is None:
            return topic in self._unrelayed and _is_small(self._unrelayed[topic])
        period_ns = self._pace(topic).period_ns
        # A topic that is Off, or nearly, rests at no cost at all, unless all its messages are wanted.
        is_paced = period_ns <= MAX_PERIOD_NS or (use.wants_all and period_ns == NEVER_NS)
        return is_paced and self._loop.may_leave(topic) and _is_small(relay.statistics.arrived)

    def _pace(self, topic: str) -> Pace:
        planned = self._loop.knowledge.plan.get(topic)
        return Pace.at(0.0 if planned is None else planned.rate.hz)

    def _tell(self, topic: str, copy: MessageCopy) -> None:
        if not self._told_ns <= copy.stamp_ns <= self._until_ns:
            copy = replace(copy, stamp_ns=max(self._told_ns, min(copy.stamp_ns, self._until_ns)))
        self._told_ns = copy.stamp_ns
        self._came(topic, copy)

    def _return(self, topic: str, copy: MessageCopy) -> None:
        payload, publisher = copy.payload or b"", copy.publisher
        passed = Relayed(topic, copy.stamp_ns, payload, copy.size_bytes, repeated=False, publisher=publisher)
        self._passed([passed])

    def _take_back(self, topic: str, state: RelayState) -> None:
        _, use = self._running.pop(topic, (None, None))
        if use is not None and not use.is_relayed:
            count_flow(self._unrelayed[topic], state.counts.arrived)
        else:
            self._passed(take_back(self._loop.relays, topic, state))


def _is_small(arrived: Flow) -> bool:
    return arrived.messages > 0 and arrived.size_bytes <= MOST_MEAN_BYTES * arrived.messages
