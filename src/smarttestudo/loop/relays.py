# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All relays."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType

from smarttestudo.domain.decision import Decision
from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.timing import AlarmClock
from smarttestudo.loop.inputs import MessageInput
from smarttestudo.loop.relay import PredictedEstimate, Relay, Relayed
from smarttestudo.loop.statistics import RelayStatistics
from smarttestudo.pacing.follower import Follower, leaders
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.pacing.topic_pacer import TopicPacer


class Relays:
    """The relays of some topics, each woken when its pacer asks for it. Times are the clock's.

    The cost of a message does not depend on how many topics there are.
    """

    def __init__(
        self,
        topics: Sequence[str],
        profile: Profile,
        when_slow: WhenSlow,
        now_ns: int,
        *,
        floors_hz: Mapping[str, float] = MappingProxyType({}),
        reckoned: Collection[str] = (),
    ) -> None:
        self._when_slow = when_slow
        self._reckoned = frozenset(reckoned)
        self._relays: dict[str, Relay] = {}
        self._alarms = AlarmClock()
        self.change_topics(topics, profile, now_ns, floors_hz=floors_hz)

    @property
    def next_wake_ns(self) -> int | None:
        """A time before which no pacer has anything to relay by itself; it may come early."""
        return self._alarms.next_ns

    @property
    def statistics(self) -> Mapping[str, RelayStatistics]:
        return {topic: relay.statistics for topic, relay in self._relays.items()}

    @property
    def leaders(self) -> Mapping[str, str]:
        """The topic that each topic paced with another one follows."""
        return {
            topic: relay.leader.topic for topic, relay in self._relays.items() if relay.leader is not None
        }

    @property
    def discarded(self) -> Mapping[str, int]:
        """Messages of topics paced with another one for which no decision of the leader was found."""
        return {
            topic: relay.pacer.discarded + relay.pacer.undecided
            for topic, relay in self._relays.items()
            if relay.leader is not None and isinstance(relay.pacer, Follower)
        }

    def relay(self, topic: str) -> Relay | None:
        """The relay of ``topic``, if it is relayed; after a change of its pacer it is to be armed."""
        return self._relays.get(topic)

    def may_skip(self, topic: str) -> bool:
        """Whether messages of ``topic`` that come before ``due_ns`` make no difference, but for the last."""
        relay = self._relays.get(topic)
        return relay is not None and isinstance(relay.pacer, TopicPacer) and relay.pacer.may_skip

    def may_leave(self, topic: str) -> bool:
        """Whether another pacer can go on with ``topic``."""
        relay = self._relays.get(topic)
        return relay is not None and isinstance(relay.pacer, TopicPacer) and relay.pacer.may_leave

    def due_ns(self, topic: str) -> int | None:
        """When the next message of ``topic``, of which some may be skipped, may pass; ``None``: at once."""
        pacer = self._relays[topic].pacer
        return pacer.due_ns if isinstance(pacer, TopicPacer) else None

    def skipped(self, topic: str, messages: int, size_bytes: int) -> None:
        """Count what was sent before the next message, yet not looked at."""
        relay = self._relays[topic]
        relay.statistics.arrived.skip(messages, size_bytes)
        if isinstance(relay.pacer, TopicPacer):
            relay.pacer.skipped(messages)

    def streams(self, topic: str) -> float:
        """How many messages of ``topic`` pass at 1 Hz, as each stream that they name has that."""
        relay = self._relays.get(topic)
        return 1.0 if relay is None else relay.statistics.frames.streams

    def comes_in_bursts(self, topic: str) -> bool:
        """Whether messages come in bursts, of which each is to be looked at."""
        relay = self._relays.get(topic)
        return relay is not None and isinstance(relay.pacer, TopicPacer) and relay.pacer.comes_in_bursts

    def restart_grids(self, now_ns: int) -> None:
        """Begin all grids anew: the clock jumped ahead to ``now_ns``, and no credit comes of that."""
        for relay in self._relays.values():
            if isinstance(relay.pacer, TopicPacer):
                relay.pacer.restart(now_ns)
                self.arm(relay)

    def needs_decoded(self, topic: str) -> bool:
        """Whether messages of ``topic`` must be decoded for the bounds of its estimate."""
        relay = self._relays.get(topic)
        return relay is not None and relay.needs_decoded

    @property
    def estimates(self) -> Mapping[str, PredictedEstimate]:
        """Estimate that receivers reckon of each topic that has bounds and is reckoned."""
        if not self._reckoned:
            return {}
        found = {topic: relay.predicted_estimate for topic, relay in self._relays.items()}
        return {topic: estimate for topic, estimate in found.items() if estimate is not None}

    def set_reckoned(self, topics: Collection[str], now_ns: int) -> list[Relayed]:
        """Receivers reckon these topics from now on, and no others; what was held may pass then."""
        self._reckoned = frozenset(topics)
        relayed: list[Relayed] = []
        for topic, relay in self._relays.items():
            relayed += relay.set_reckoned(is_reckoned=topic in self._reckoned, now_ns=now_ns)
            self.arm(relay)
        return relayed

    def resend_to_new_receiver(self, topic: str, now_ns: int) -> None:
        """Serve a new receiver of ``topic``, which has got nothing yet."""
        relay = self._relays.get(topic)
        if relay is not None:
            relay.begin_estimate(now_ns)
            self.arm(relay)

    def end_groups(self, topic: str) -> None:
        """Messages of ``topic`` do not come from now on, as nobody listens to it."""
        relay = self._relays.get(topic)
        if relay is not None:
            relay.end_groups()

    def change_topics(
        self,
        topics: Sequence[str],
        profile: Profile,
        now_ns: int,
        *,
        floors_hz: Mapping[str, float] = MappingProxyType({}),
    ) -> list[Relayed]:
        """Relay these topics from now on; those that were relayed before go on as they are."""
        before = self._relays
        relayed: list[Relayed] = []
        for topic in before.keys() - set(topics):
            self._alarms.set(topic, None)
        self._relays = {
            topic: before.get(topic) or self._new(topic, profile.topic(topic), now_ns) for topic in topics
        }
        for topic, relay in self._relays.items():
            relay.set_floor(floors_hz.get(topic, 0.0), now_ns)
            relayed += relay.change_profile(profile.topic(topic), now_ns)
        self._pair({topic: leader for topic in topics if (leader := profile.topic(topic).paced_with)}, now_ns)
        for relay in self._relays.values():
            self.arm(relay)
        return relayed

    def _new(self, topic: str, profile: TopicProfile, now_ns: int) -> Relay:
        return Relay(topic, profile, self._when_slow, now_ns, is_reckoned=topic in self._reckoned)

    def _pair(self, paced_with: Mapping[str, str], now_ns: int) -> None:
        leader_of = leaders(paced_with, self._relays)
        for relay in self._relays.values():
            relay.detach_followers()
        # Leaders first: one that followed another before needs a pacer of its own.
        for topic, relay in sorted(self._relays.items(), key=lambda item: item[0] in leader_of):
            relay.follow(self._relays.get(leader_of.get(topic, "")), now_ns)

    def apply(self, decisions: Iterable[Decision], now_ns: int) -> list[Relayed]:
        """Take the rates and bounds of a plan's changes; what passes because of them."""
        relayed: list[Relayed] = []
        for decision in decisions:
            relay = self._relays[decision.topic]
            relay.set_rate(decision.planned.rate.hz, now_ns)
            relayed += relay.set_within(decision.planned.within, now_ns)
            self.arm(relay)
            relayed += _followed(relay, now_ns)
        return relayed

    def offer(self, given: MessageInput) -> Sequence[Relayed]:
        """Pace a message that arrived: return what to relay now; nothing for topics without a relay."""
        topic = given.topic
        relay = self._relays.get(topic)
        if relay is None:
            return ()
        relayed = relay.offer(given)
        self._alarms.set(topic, relay.pacer.wake_ns)
        return [*relayed, *_followed(relay, given.stamp_ns)] if relay.followers else relayed

    def wake(self, now_ns: int) -> list[Relayed]:
        """Messages to relay by ``now_ns`` without a new one."""
        relayed: list[Relayed] = []
        for topic in self._alarms.take_due(now_ns):
            relay = self._relays[topic]
            relayed += relay.wake(now_ns)
            self.arm(relay)
            relayed += _followed(relay, now_ns)
        return relayed

    def change_source(self, change: SourceChanged, now_ns: int) -> Sequence[Relayed]:
        relay = self._relays.get(change.topic)
        if relay is None:
            return ()
        relayed = relay.change_source(change, now_ns)
        self.arm(relay)
        return [*relayed, *_followed(relay, now_ns)]

    def restart(self, now_ns: int) -> list[Relayed]:
        """Begin anew on a clock that jumped back to ``now_ns``."""
        self._alarms = AlarmClock()
        for topic in self._relays:
            self._alarms.set(topic, now_ns)
        return self.wake(now_ns)

    def finish(self, now_ns: int) -> Iterator[Relayed]:
        """No more messages come: what is still held back, each at its own time, from ``now_ns`` on."""
        for relay in self._relays.values():
            relay.statistics.target.account(now_ns)
            relay.pacer.finish()
            self.arm(relay)
        return self._remaining(now_ns)

    def _remaining(self, now_ns: int) -> Iterator[Relayed]:
        while (at_ns := self._alarms.next_ns) is not None:
            yield from self.wake(max(at_ns, now_ns))

    def arm(self, relay: Relay) -> None:
        """Wake ``relay`` when its pacer asks for it."""
        self._alarms.set(relay.topic, relay.pacer.wake_ns)


def _followed(relay: Relay, now_ns: int) -> list[Relayed]:
    """Messages of topics paced with ``relay`` that pass after something happened to it."""
    return [
        relayed
        for follower in relay.followers
        if follower.pacer.wake_ns is not None
        for relayed in follower.wake(now_ns)
    ]
