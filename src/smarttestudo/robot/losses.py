# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Losses of topics before they can be relayed: counted, measured over the last seconds, and warned of."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from smarttestudo.domain.rate_meter import WINDOW_NS
from smarttestudo.domain.robot import Endpoint, Subscription
from smarttestudo.domain.status import LossBeforeRelay
from smarttestudo.domain.units import NS_PER_S

PAUSE_NS = 10 * NS_PER_S
"""How long a topic is not reported again."""
LARGE_BYTES = 1 << 16
"""What is larger is sent in pieces, all of which need room in the sender's shared memory at once."""
LEAST_SHARE = 0.05
LEAST_LOST = 3
"""Less than this or that share in the last seconds is no state of a topic: one hitch of the machine."""
READINGS_NEEDED = 4
"""A second apart or less, and enough to know whether a topic loses."""
TOO_SLOW = "either this machine or its network is too slow for them"


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceLoss:
    """Loss of one topic: so many ``messages`` since the first that came, a ``share`` of the last seconds.

    ``state`` is what a status says of it, ``None`` while that is as it should be.
    """

    messages: int
    share: float = 0.0
    state: LossBeforeRelay | None = None


@dataclass(slots=True, kw_only=True)
class _Counts:
    """Counts of one subscription, from the first look on that finds a message of it.

    Until then this process was starting, or opened the topic: what came meanwhile is not missed. ``readings``
    are time, sent and lost messages in the last seconds.
    """

    subscription: Subscription
    not_counted: int | None = None
    said: int = 0
    readings: deque[tuple[int, int, int]] = field(default_factory=deque)

    @property
    def is_numbered(self) -> bool:
        return self.subscription.sent is not None

    @property
    def lost(self) -> int:
        return 0 if self.not_counted is None else self.subscription.dropped - self.not_counted

    @property
    def in_window(self) -> tuple[int, int]:
        """Messages that were sent and lost in the last seconds."""
        if not self.readings:
            return 0, 0
        (_, first_sent, first_lost), (_, sent, lost) = self.readings[0], self.readings[-1]
        return sent - first_sent, lost - first_lost

    def read(self, now_ns: int) -> None:
        sent, readings = self.subscription.sent or 0, self.readings
        if self.not_counted is None:
            if not sent:
                return
            self.not_counted = self.subscription.dropped
        if readings and now_ns < readings[-1][0]:
            readings.clear()
        readings.append((now_ns, sent, self.lost))
        while len(readings) > 2 and readings[1][0] <= now_ns - WINDOW_NS:
            readings.popleft()


class LiveLosses:
    """Counts what each topic lost, and warns of what it lost since it was last reported.

    ``publishers_of`` are those of a topic, ``senders_remedy`` is that of the ``Robot``. ``sizes`` is to have
    the size of each topic's last message.
    """

    def __init__(
        self,
        warn: Callable[[str], None],
        publishers_of: Callable[[str], Sequence[Endpoint]],
        senders_remedy: str | None,
    ) -> None:
        self._warn = warn
        self._senders_remedy = senders_remedy
        self._publishers_of = publishers_of
        self.sizes: dict[str, int] = {}
        self._open: Mapping[str, Subscription] = {}
        self._counts: dict[str, _Counts] = {}
        self._ended: dict[str, int] = {}
        """What subscriptions lost that are closed."""
        self._silent_until_ns: dict[str, int] = {}
        self._said: set[str] = set()
        self._publishers: dict[str, Sequence[Endpoint]] = {}

    def measure(self, subscriptions: Mapping[str, Subscription], now_ns: int) -> None:
        """Count for the subscriptions that are open; times may jump back."""
        if subscriptions is not self._open:
            self._end_all_but(subscriptions)
            self._open = subscriptions
        for topic, subscription in subscriptions.items():
            counts = self._counts.setdefault(topic, _Counts(subscription=subscription))
            counts.read(now_ns)
            if counts.lost > counts.said:
                self._say_in_time(topic, counts, now_ns)

    def lost(self) -> Mapping[str, SourceLoss]:
        """The losses of each topic; none for one whose messages were never numbered."""
        ended = {topic: SourceLoss(messages=messages) for topic, messages in self._ended.items()}
        numbered = {topic: counts for topic, counts in self._counts.items() if counts.is_numbered}
        return {**ended, **{topic: self._loss(topic, counts) for topic, counts in numbered.items()}}

    def may_lack_room(self, topic: str) -> bool:
        """Whether it is, or may yet be found, to lose for want of its sender's memory.

        Then all its messages are to be received: of a topic that rests, nobody knows what is lost.
        """
        counts = self._counts.get(topic)
        if counts is None or not self._short_of_room(topic):
            return False
        return len(counts.readings) < READINGS_NEEDED or self._loss(topic, counts).state is not None

    def close(self) -> None:
        """Report what was not reported yet; nothing is received any more."""
        self.measure({}, 0)

    def _loss(self, topic: str, counts: _Counts) -> SourceLoss:
        sent, lost = counts.in_window
        share = lost / sent if sent else 0.0
        state = None
        if share > LEAST_SHARE and lost >= LEAST_LOST:
            state = LossBeforeRelay(percent=100 * share, remedy=self._remedy(topic))
        messages = self._ended.get(topic, 0) + counts.lost
        return SourceLoss(messages=messages, share=share, state=state)

    def _end_all_but(self, still_open: Mapping[str, Subscription]) -> None:
        for topic, counts in list(self._counts.items()):
            if still_open.get(topic) is not counts.subscription:
                self._say(topic, counts)
                del self._counts[topic]
                if counts.is_numbered:
                    self._ended[topic] = self._ended.get(topic, 0) + counts.lost

    def _say_in_time(self, topic: str, counts: _Counts, now_ns: int) -> None:
        silent_until_ns = self._silent_until_ns.get(topic, now_ns)
        if not silent_until_ns - PAUSE_NS <= now_ns < silent_until_ns:
            self._say(topic, counts)
            self._silent_until_ns[topic] = now_ns + PAUSE_NS

    def _say(self, topic: str, counts: _Counts) -> None:
        lost = counts.lost - counts.said
        if lost <= 0:
            return
        counts.said += lost
        remedy = self._remedy(topic)
        # What there is to do about it is said once.
        why = "" if f"{topic} {remedy}" in self._said else f"; {remedy}"
        self._said.add(f"{topic} {remedy}")
        self._warn(f"{topic}: lost {lost} messages before they could be relayed{why}")

    def _short_of_room(self, topic: str) -> list[str]:
        """The nodes whose messages of a topic can be lost for want of their memory."""
        if self._senders_remedy is None or self.sizes.get(topic, 0) < LARGE_BYTES:
            return []
        if publishers := self._publishers_of(topic):
            self._publishers[topic] = publishers
        # Of one that just left, what was lost is said, too.
        known = self._publishers.get(topic, ())
        return sorted({one.node for one in known if one.is_local and not one.reliable})

    def _remedy(self, topic: str) -> str:
        short_of_room = self._short_of_room(topic)
        if not short_of_room:
            return TOO_SLOW
        return (
            f"Fast DDS has too little shared memory where they are sent: start {' and '.join(short_of_room)} "
            f"with {self._senders_remedy} (if it has that, this machine is too slow)"
        )
