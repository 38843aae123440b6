# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of a live run of which only what is due is looked at."""

from __future__ import annotations

from collections.abc import Mapping

from smarttestudo.domain.robot import Inlet
from smarttestudo.pacing.pace import NEVER_NS, Pace
from smarttestudo.runtime.execute.sampling import SamplingChoice
from smarttestudo.runtime.relay_loop import RelayLoop


class _Topic:
    """A topic that may rest.

    ``sent`` is what its source had sent by the last message that came, ``looked_sent`` by the last look.
    ``wake_ns`` is when to rouse its inlet, or, while that is roused, when to take what it kept.
    """

    __slots__ = ("choice", "inlet", "is_roused", "looked_sent", "sent", "wake_ns")

    def __init__(self, inlet: Inlet, now_ns: int) -> None:
        self.inlet = inlet
        self.choice = SamplingChoice(now_ns)
        self.sent = 0
        self.looked_sent = 0
        self.is_roused = False
        self.wake_ns = NEVER_NS


class LiveSampling:
    """Lets inlets rest while what comes is not due, and rouses each when it is.

    So what passes is the first message at its due time or after it, as without resting. If none comes for
    another period, the newest one from before passes, as the last word.
    """

    def __init__(self, loop: RelayLoop) -> None:
        self._loop = loop
        self._topics: dict[str, _Topic] = {}
        self._resting: dict[str, _Topic] = {}
        self._wake_ns = NEVER_NS
        self._has_changed = False

    def look(self, inlets: Mapping[str, Inlet], now_ns: int) -> None:
        """Decide by the plan as it is now which of ``inlets`` rest; all others work, or are closed."""
        for name in [name for name, topic in self._topics.items() if inlets.get(name) is not topic.inlet]:
            self._topics.pop(name).inlet.work()
            self._resting.pop(name, None)
        for name, inlet in inlets.items():
            sent = inlet.sent
            if sent is None:
                continue
            topic = self._topics.setdefault(name, _Topic(inlet, now_ns))
            self._decide(name, topic, sent, now_ns)
        self._has_changed = True

    def received(self, name: str, size_bytes: int) -> None:
        """A message of a topic came and goes to the loop next; what was skipped before it counts as sent."""
        topic = self._resting.get(name)
        if topic is None:
            return
        sent = topic.inlet.sent or 0
        skipped = sent - topic.sent - 1
        if skipped > 0:
            self._loop.on_skipped(name, skipped, skipped * size_bytes)
        topic.sent = sent
        topic.is_roused = False
        self._has_changed = True

    @property
    def wake_ns(self) -> int | None:
        """When to call ``on_wake``."""
        if self._has_changed:
            self._arm()
        return self._wake_ns if self._wake_ns < NEVER_NS else None

    def on_wake(self, now_ns: int) -> None:
        """Rouse the inlets whose topics are due, and take the last words of those that nothing came of."""
        for name, topic in self._resting.items():
            if topic.wake_ns > now_ns:
                continue
            if topic.is_roused:
                topic.wake_ns = NEVER_NS
                topic.inlet.take_kept()
            else:
                topic.is_roused = True
                topic.wake_ns = now_ns + Pace.at(self._loop.plan[name].rate.hz).period_ns
                topic.inlet.rouse()
        self._has_changed = True

    def _decide(self, name: str, topic: _Topic, sent: int, now_ns: int) -> None:
        rests = self._loop.may_skip(name) and topic.choice.look(sent, self._loop.plan[name].rate.hz, now_ns)
        if rests and name not in self._resting:
            topic.sent = sent
            topic.inlet.rest()
            self._resting[name] = topic
        elif not rests and name in self._resting:
            del self._resting[name]
            topic.inlet.work()
        elif rests and sent == topic.looked_sent:
            # Nothing was due since the last look, yet how much the source sends must be known.
            topic.inlet.rouse()
        topic.looked_sent = sent

    def _arm(self) -> None:
        self._has_changed = False
        self._wake_ns = NEVER_NS
        for name, topic in self._resting.items():
            if not topic.is_roused:
                topic.wake_ns = self._loop.due_ns(name) or 0
            self._wake_ns = min(self._wake_ns, topic.wake_ns)
