# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The one state of the loop."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from smarttestudo.adirf.evaluator import Evaluator, Wish
from smarttestudo.adirf.rule_set import RuleSet
from smarttestudo.domain.decision import PlannedRate
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.signal import Signal
from smarttestudo.domain.units import ns_from_s
from smarttestudo.runtime.knowledge.alarm_clock import AlarmClock
from smarttestudo.runtime.knowledge.link_use import LinkUse
from smarttestudo.runtime.knowledge.settling import Settling
from smarttestudo.runtime.knowledge.steady_time import SteadyTime
from smarttestudo.runtime.knowledge.watched_topic import WatchedTopic


class Knowledge:
    """Rules, profile and everything remembered about the robot; the loop owns one and changes it in ``step``.

    Times inside are steady times. ``effective`` and ``plan`` hold the relayed topics, ``watched`` those that
    checks read; ``settled`` are the wishes that settled, before ``link`` cuts them to a budget, if there is
    one. ``unknown_values`` counts messages that left a signal unknown, ``undecodable`` those that
    could not be decoded, by topic.
    """

    def __init__(
        self,
        rule_set: RuleSet,
        profile: Profile,
        start_ns: int,
        budget_kb_per_s: float | None = None,
    ) -> None:
        self.rule_set = rule_set
        self.profile = profile
        self.start_ns = start_ns
        self.settle_ns = ns_from_s(profile.settle_s)
        self.time = SteadyTime(start_ns)
        self.evaluator = Evaluator(rule_set)
        self.watched = watched_topics(rule_set, profile, start_ns, self.evaluator)
        self.watch_alarms = AlarmClock()
        for topic in self.watched:
            self.watch_alarms.set(topic, start_ns)
        self.settling: dict[str, Settling] = {}
        self.settle_alarms = AlarmClock()
        self.settled: dict[str, Wish] = {}
        self.link: LinkUse | None = None
        if budget_kb_per_s is not None:
            self.set_budget(budget_kb_per_s)
        self.effective: dict[str, Wish] = {}
        self.plan: dict[str, PlannedRate] = {}
        self.order_of = {topic: place for place, topic in enumerate(rule_set.relayed)}
        self.unknown_values: Counter[Signal] = Counter()
        self.undecodable: Counter[str] = Counter()

    def set_budget(self, budget_kb_per_s: float) -> None:
        """The relayed topics may take ``budget_kb_per_s`` from now on."""
        if self.link is None:
            self.link = LinkUse(self.rule_set, self.profile, budget_kb_per_s)
        else:
            self.link.set_budget(budget_kb_per_s)

    def values_of(self, block: int | None, now_ns: int) -> dict[str, float | None]:
        """What the condition of the block of that order reads at ``now_ns``, by signal name."""
        if block is None:
            return {}
        signals = self.evaluator.reads(block)
        values = {
            signal: value
            for topic in {signal.topic for signal in signals}
            for signal, value in self.watched[topic].readings(now_ns)
        }
        return {str(signal): values[signal] for signal in signals}

    @property
    def next_wake_ns(self) -> int | None:
        """When, on the clock, time alone may next change the plan; it may come early, never late."""
        check_ns = None if self.link is None else self.link.next_check_ns
        times_ns = (self.watch_alarms.next_ns, self.settle_alarms.next_ns, check_ns)
        earliest_ns = min([at_ns for at_ns in times_ns if at_ns is not None], default=None)
        return None if earliest_ns is None else self.time.on_clock(earliest_ns)


def watched_topics(
    rule_set: RuleSet, profile: Profile, start_ns: int, evaluator: Evaluator
) -> Mapping[str, WatchedTopic]:
    """The topics that the checks of a rule set read; nothing is known of them yet."""
    signals: dict[str, list[Signal]] = {}
    for signal in sorted(rule_set.signals):
        signals.setdefault(signal.topic, []).append(signal)
    return {
        topic: WatchedTopic(read, profile.topic(topic), start_ns, evaluator.cuts)
        for topic, read in signals.items()
    }
