# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Losses of a topic before it can be relayed: counted, measured over the last seconds, and warned of."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
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
    """Loss of one topic: so many ``messages`` since the first received, a ``share`` of the last seconds.

    ``state`` is what a status says of it, ``None`` while that is as it should be.
    """

    messages: int
    share: float = 0.0
    state: LossBeforeRelay | None = None


@dataclass(slots=True, kw_only=True)
class _Counts:
    """Counts of one subscription, from the first look on that finds a message of it.

    Until then this process was starting, or opened the topic: nobody misses what was sent meanwhile.
    ``readings`` are time, sent and lost messages in the last seconds.
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


class TopicLosses:
    """Counts what a topic lost, and warns of what it lost since that was last reported.

    ``publishers`` gives those that are there now, ``senders_remedy`` is that of the ``Robot``. ``size_bytes``
    is to be that of the last message.
    """

    def __init__(
        self,
        topic: str,
        warn: Callable[[str], None],
        publishers: Callable[[], Sequence[Endpoint]],
        senders_remedy: str | None,
    ) -> None:
        self.size_bytes = 0
        self._topic = topic
        self._warn = warn
        self._senders_remedy = senders_remedy
        self._publishers = publishers
        self._known: Sequence[Endpoint] = ()
        self._counts: _Counts | None = None
        self._ended: int | None = None
        """What subscriptions lost that are closed; ``None`` while none of them was numbered."""
        self._silent_until_ns: int | None = None
        self._named: set[str] = set()

    def measure(self, subscription: Subscription | None, now_ns: int) -> None:
        """Count for the subscription that is open, if one is; times may jump back."""
        if self._counts is not None and self._counts.subscription is not subscription:
            self._end(self._counts)
        if subscription is None:
            return
        if self._counts is None:
            self._counts = _Counts(subscription=subscription)
        self._counts.read(now_ns)
        if self._counts.lost > self._counts.said:
            self._say_in_time(self._counts, now_ns)

    def loss(self) -> SourceLoss | None:
        """The loss of the topic; ``None`` where its messages were never numbered."""
        counts = self._counts
        if counts is None or not counts.is_numbered:
            return None if self._ended is None else SourceLoss(messages=self._ended)
        sent, lost = counts.in_window
        share = lost / sent if sent else 0.0
        state = None
        if share > LEAST_SHARE and lost >= LEAST_LOST:
            state = LossBeforeRelay(percent=100 * share, remedy=self._remedy())
        return SourceLoss(messages=(self._ended or 0) + counts.lost, share=share, state=state)

    @property
    def may_lack_room(self) -> bool:
        """Whether it is, or may yet be found, to lose for want of its sender's memory.

        Then all its messages are to be received: of a topic that pauses, what is lost is unknown.
        """
        if self._counts is None or not self._short_of_room():
            return False
        loss = self.loss()
        return len(self._counts.readings) < READINGS_NEEDED or (loss is not None and loss.state is not None)

    def close(self) -> None:
        """Report what was not reported yet; nothing is received any more."""
        self.measure(None, 0)

    def _end(self, counts: _Counts) -> None:
        self._say(counts)
        self._counts = None
        if counts.is_numbered:
            self._ended = (self._ended or 0) + counts.lost

    def _say_in_time(self, counts: _Counts, now_ns: int) -> None:
        until_ns = now_ns if self._silent_until_ns is None else self._silent_until_ns
        if not until_ns - PAUSE_NS <= now_ns < until_ns:
            self._say(counts)
            self._silent_until_ns = now_ns + PAUSE_NS

    def _say(self, counts: _Counts) -> None:
        lost = counts.lost - counts.said
        if lost <= 0:
            return
        counts.said += lost
        remedy = self._remedy()
        # What there is to do about it is said once.
        why = "" if remedy in self._named else f"; {remedy}"
        self._named.add(remedy)
        self._warn(f"{self._topic}: lost {lost} messages before they could be relayed{why}")

    def _short_of_room(self) -> list[str]:
        """The nodes whose messages can be lost for want of their memory."""
        if self._senders_remedy is None or self.size_bytes < LARGE_BYTES:
            return []
        # Of one that just left, what was lost is said, too.
        self._known = self._publishers() or self._known
        return sorted({one.node for one in self._known if one.is_local and not one.reliable})

    def _remedy(self) -> str:
        short_of_room = self._short_of_room()
        if not short_of_room:
            return TOO_SLOW
        return (
            f"Fast DDS has too little shared memory where they are sent: start {' and '.join(short_of_room)} "
            f"with {self._senders_remedy} (if it has that, this machine is too slow)"
        )
