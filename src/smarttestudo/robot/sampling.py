# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of a live run of which only the due messages are received."""

from __future__ import annotations

import math

from smarttestudo.domain.robot import PausableSubscription
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.pacing.grid import NEVER_NS, Pace

BEGIN_RATIO = 3.5
"""Source over target from which sampling is worth a change of subscriptions."""
END_RATIO = 2.5
"""Source over target below which it no longer is."""
LEAST_SOURCE_HZ = 20.0
"""Slower sources cost next to nothing."""
MEASURE_NS = NS_PER_S * 9 // 10
"""Less than the second from one poll to the next, which may come a little early."""
PAUSE_NS = 10 * NS_PER_S
"""How long every message is received again before sampling may begin again: rules may flicker."""


class SamplingChoice:
    """Decides for one topic, by the number of messages that its source has sent.

    ``source_hz`` is the source's rate in the last second or so; ``None`` before it was measured.
    """

    __slots__ = ("_not_before_ns", "_sent", "_since_ns", "is_sampled", "source_hz")

    def __init__(self, now_ns: int) -> None:
        self.is_sampled = False
        self.source_hz: float | None = None
        self._sent: int | None = None
        self._since_ns = now_ns
        self._not_before_ns = now_ns

    def should_sample(self, sent: int, target_hz: float, now_ns: int) -> bool:
        """Whether to sample from ``now_ns`` on; ``sent`` counts messages from any point on."""
        self._measure(sent, now_ns)
        ratio = _ratio(self.source_hz, target_hz)
        if self.is_sampled:
            if ratio < END_RATIO:
                self.is_sampled = False
                self._not_before_ns = now_ns + PAUSE_NS
        elif ratio >= BEGIN_RATIO and now_ns >= self._not_before_ns:
            self.is_sampled = True
        return self.is_sampled

    def _measure(self, sent: int, now_ns: int) -> None:
        elapsed_ns = now_ns - self._since_ns
        if self._sent is None or elapsed_ns < 0:
            self._not_before_ns = min(self._not_before_ns, now_ns)
        elif elapsed_ns < MEASURE_NS:
            return
        else:
            self.source_hz = (sent - self._sent) * NS_PER_S / elapsed_ns
        self._sent, self._since_ns = sent, now_ns


def _ratio(source_hz: float | None, target_hz: float) -> float:
    if source_hz is None or source_hz < LEAST_SOURCE_HZ:
        return 0.0
    return source_hz / target_hz if target_hz else math.inf


class SampledTopic:
    """A subscription that may pause.

    ``sent`` is what its source had sent by the last message received, ``polled_sent`` by the last poll.
    ``wake_ns`` is when to arm it, or, while it is armed, when to take what it kept. After a pause it
    ``has_resumed`` until the next message: what was skipped last is counted with that.
    """

    __slots__ = (
        "choice",
        "has_resumed",
        "is_armed",
        "is_paused",
        "name",
        "polled_sent",
        "sent",
        "subscription",
        "wake_ns",
    )

    def __init__(self, name: str, subscription: PausableSubscription, now_ns: int) -> None:
        self.name = name
        self.subscription = subscription
        self.choice = SamplingChoice(now_ns)
        self.sent = 0
        self.polled_sent = 0
        self.is_paused = False
        self.has_resumed = False
        self.is_armed = False
        self.wake_ns = NEVER_NS


class LiveSampling:
    """Pauses subscriptions while no message is due, and arms each when one is.

    So what passes is the first message at its due time or after it, as without pauses. If none comes for
    another period, the newest one from before passes, as the final message. Only those that ``may_pause`` do.
    """

    def __init__(self, loop: RelayLoop, *, may_pause: bool = True) -> None:
        self.may_pause = may_pause
        self._loop = loop
        self._paused: list[SampledTopic] = []
        self._wake_ns = NEVER_NS
        self._has_changed = False

    def choose(self, topic: SampledTopic, now_ns: int, *, needs_all: bool = False) -> None:
        """Decide by the plan as it is now whether ``topic`` pauses; not where it ``needs_all`` messages."""
        sent = topic.subscription.sent
        if sent is None:
            return
        loop, name = self._loop, topic.name
        needs_all = needs_all or loop.relays.comes_in_bursts(name)
        may_pause = self.may_pause and loop.may_skip(name) and not needs_all
        pauses = may_pause and topic.choice.should_sample(sent, self._target_hz(topic), now_ns)
        if pauses and not topic.is_paused:
            if not topic.has_resumed:
                topic.sent = sent
            topic.has_resumed = False
            topic.subscription.pause()
            topic.is_paused = True
            self._paused.append(topic)
        elif not pauses and topic.is_paused:
            self._resume(topic)
        elif pauses and sent == topic.polled_sent:
            # Nothing was due since the last poll, yet how much the source sends must be known.
            topic.subscription.arm()
        topic.polled_sent = sent
        self._has_changed = True

    def end(self, topic: SampledTopic, now_ns: int) -> None:
        """Receive all messages of ``topic``, as something needs them; its subscription may be closed."""
        if topic.is_paused:
            self._resume(topic)
        topic.choice = SamplingChoice(now_ns)

    def received(self, topic: SampledTopic, size_bytes: int) -> None:
        """A message goes to the loop next; what was skipped before it counts as sent."""
        if not (topic.is_paused or topic.has_resumed):
            return
        if not topic.is_paused:
            topic.has_resumed = False
        sent = topic.subscription.sent or 0
        skipped = sent - topic.sent - 1
        if skipped > 0:
            self._loop.relays.skipped(topic.name, skipped, skipped * size_bytes)
        topic.sent = sent
        topic.is_armed = False
        self._has_changed = True

    @property
    def wake_ns(self) -> int | None:
        """When to call ``on_wake``."""
        if self._has_changed:
            self._arm()
        return self._wake_ns if self._wake_ns < NEVER_NS else None

    def on_wake(self, now_ns: int) -> None:
        """Arm the subscriptions whose topics are due, and take what is pending where nothing was received."""
        for topic in self._paused:
            if topic.wake_ns > now_ns:
                continue
            if topic.is_armed:
                topic.wake_ns = NEVER_NS
                topic.subscription.take_pending()
            else:
                topic.is_armed = True
                topic.wake_ns = now_ns + Pace.at(self._target_hz(topic)).period_ns
                topic.subscription.arm()
        self._has_changed = True

    def _resume(self, topic: SampledTopic) -> None:
        self._paused.remove(topic)
        topic.is_paused, topic.has_resumed = False, True
        topic.subscription.resume()
        # What was pending was received just now; more may have been skipped after it.
        topic.has_resumed = True
        self._has_changed = True

    def _target_hz(self, topic: SampledTopic) -> float:
        return self._loop.knowledge.plan[topic.name].rate.hz

    def _arm(self) -> None:
        self._has_changed = False
        self._wake_ns = NEVER_NS
        for topic in self._paused:
            if not topic.is_armed:
                topic.wake_ns = self._loop.relays.due_ns(topic.name) or 0
            self._wake_ns = min(self._wake_ns, topic.wake_ns)
