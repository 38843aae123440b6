# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of a live run that are relayed without Python, while nothing there needs their messages at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from smarttestudo.domain.compiled_relay import MAX_PERIOD_NS, CompiledRelays, Copying, MessageCopy, RelayState
from smarttestudo.domain.rate_meter import Flow
from smarttestudo.domain.robot import Subscription
from smarttestudo.loop.hand_over import count, count_flow, hand_over, take_back, unrelayed
from smarttestudo.loop.relay import Relayed
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.pacing.grid import NEVER_NS, Pace
from smarttestudo.robot.topic import Ends, RelayUse, Topic

MOST_MEAN_BYTES = 1 << 16
"""Larger messages cost the same either way; those that are not due cost nothing while their topic pauses."""


class CompiledTopics:
    """Hands topics to compiled relays and takes them back, with their pace, held messages and counts.

    Copies of the messages of those that are recorded, or that a budget counts, are received by their topic.
    ``passed`` is given what passes because a topic came back, and ``copy_passed``, where there is one, a copy
    of all that passes: no relay publishes it then.
    """

    def __init__(
        self,
        relays: CompiledRelays | None,
        loop: RelayLoop,
        passed: Callable[[Sequence[Relayed]], None],
        copy_passed: Callable[[str, MessageCopy], None] | None = None,
    ) -> None:
        self._relays = relays
        self._loop = loop
        self._passed = passed
        self._copy_passed = copy_passed
        self._running: list[Topic] = []
        self.makes_copies = False
        """Whether there may be copies to deliver."""

    @property
    def can_relay(self) -> bool:
        """Whether topics may be relayed so now."""
        return self._relays is not None and self._relays.can_relay

    def choose(self, topic: Topic, ends: Ends | None, now_ns: int) -> None:
        """Decide by the plan as it is now whether ``topic`` is relayed so, between its ``ends`` if any."""
        use = self._use(topic, ends)
        wanted = use if use is not None and self._suits(topic, use) else None
        if topic.compiled is not None and topic.use != wanted:
            topic.compiled.end()
        if use is None or use.is_relayed:
            topic.unrelayed = None
        topic.is_left = wanted is not None
        if wanted is None or ends is None:
            return
        if topic.compiled is None:
            self._begin(topic, ends[0], wanted, now_ns)
        else:
            topic.compiled.set_pace(self._pace(topic).period_ns)

    def end(self, topic: Topic) -> None:
        """Take ``topic`` back."""
        if topic.compiled is not None:
            topic.compiled.end()

    def count_unrelayed(self, topic: Topic, size_bytes: int, now_ns: int) -> None:
        """Count a message that Python received of a topic that is recorded only."""
        if self._relays is not None:
            if topic.unrelayed is None:
                topic.unrelayed = Flow()
            topic.unrelayed.record(now_ns, size_bytes)

    def deliver(self, steady_ns: int) -> None:
        """Have the topics receive the copies that were made by ``steady_ns``."""
        if self._relays is not None:
            self._relays.deliver(steady_ns)

    def count(self) -> None:
        """Have the statistics as of now, and the meters the beginning of each last relayed message."""
        for topic in self._running:
            assert topic.compiled is not None
            relay, counts = self._loop.relays.relay(topic.name), topic.compiled.counts()
            if topic.unrelayed is not None:
                count_flow(topic.unrelayed, counts.arrived)
            elif relay is not None:
                count(relay, counts)
            beginning, at_ns = counts.beginning, counts.relayed.last_ns
            if beginning and topic.meters is not None:
                topic.meters.note(Relayed(topic.name, at_ns, beginning, len(beginning), repeated=False))

    def leave_out(self, ahead_ns: int, now_ns: int) -> None:
        """The clock jumped ahead by so much, to ``now_ns``: take all topics back, with counts without that.

        To be called once the loop has left it out; copies that were made since are delivered.
        """
        flows = [flow for topic in self._running for flow in self._flows(topic)]
        self.close()
        self._loop.relays.restart_grids(now_ns)
        for flow in flows:
            flow.leave_out(ahead_ns, now_ns)

    def close(self) -> None:
        """Take all topics back; copies that were made until now are delivered."""
        for topic in list(self._running):
            self.end(topic)

    def _flows(self, topic: Topic) -> Sequence[Flow]:
        relay = self._loop.relays.relay(topic.name)
        if topic.unrelayed is not None:
            return (topic.unrelayed,)
        return () if relay is None else (relay.statistics.arrived, relay.statistics.relayed)

    def _use(self, topic: Topic, ends: Ends | None) -> RelayUse | None:
        """How a topic would be relayed; ``None`` where no compiled relay can."""
        if ends is None or self._relays is None or not self._relays.serves(*ends):
            return None
        is_relayed = self._loop.relays.relay(topic.name) is not None
        return RelayUse(
            publisher=ends[1],
            is_relayed=is_relayed,
            is_recorded=topic.is_recorded,
            is_counted=is_relayed and self._loop.counts_all,
        )

    def _begin(self, topic: Topic, subscription: Subscription, use: RelayUse, now_ns: int) -> None:
        assert self._relays is not None
        if topic.unrelayed is None:
            state = partial(hand_over, self._loop.relays, topic.name, now_ns)
        else:
            state = partial(unrelayed, topic.unrelayed, now_ns)
        passed = None if self._copy_passed is None else partial(self._copy_passed, topic.name)
        copying = Copying(
            received=partial(_receive, topic) if use.copies_all else None,
            has_payload=use.is_recorded,
            passed=passed if use.is_relayed else None,
        )
        relay = self._relays.begin(
            subscription, use.publisher, state, partial(self._take_back, topic), copying
        )
        if relay is not None:
            topic.compiled, topic.use = relay, use
            self._running.append(topic)
            self._note_copies()

    def _note_copies(self) -> None:
        has_all = any(topic.use is not None and topic.use.copies_all for topic in self._running)
        self.makes_copies = bool(self._running) and (has_all or self._copy_passed is not None)

    def _suits(self, topic: Topic, use: RelayUse) -> bool:
        relay = self._loop.relays.relay(topic.name)
        if relay is None:
            return topic.unrelayed is not None and _is_small(topic.unrelayed)
        period_ns = self._pace(topic).period_ns
        # A topic that is Off, or nearly, costs nothing while paused, unless all its messages are copied.
        is_paced = period_ns <= MAX_PERIOD_NS or (use.copies_all and period_ns == NEVER_NS)
        return is_paced and self._loop.may_leave(topic.name) and _is_small(relay.statistics.arrived)

    def _pace(self, topic: Topic) -> Pace:
        planned = self._loop.knowledge.plan.get(topic.name)
        return Pace.at(0.0 if planned is None else planned.rate.hz)

    def _take_back(self, topic: Topic, state: RelayState) -> None:
        if topic.compiled is not None:
            topic.compiled, topic.use = None, None
            self._running.remove(topic)
            self._note_copies()
        if topic.unrelayed is not None:
            count_flow(topic.unrelayed, state.counts.arrived)
        else:
            self._passed(take_back(self._loop.relays, topic.name, state))


def _receive(topic: Topic, copy: MessageCopy) -> None:
    topic.receive(copy.payload, copy.publisher, copy)


def _is_small(arrived: Flow) -> bool:
    return arrived.messages > 0 and arrived.size_bytes <= MOST_MEAN_BYTES * arrived.messages
