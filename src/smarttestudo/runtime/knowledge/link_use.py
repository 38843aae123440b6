# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the loop knows about the link: its budget, what sources send, and what had to be cut."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from smarttestudo.adirf.evaluator import Wish
from smarttestudo.adirf.rule_set import RuleSet
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate
from smarttestudo.optimizer.run_time import BudgetKeeper, TopicLoad
from smarttestudo.runtime.knowledge.source_load import SourceLoad


class LinkUse:
    """Keeps the relayed topics within a budget by the sizes that are really measured.

    Until a topic's first message, the profile's size and rate stand in; a topic of which nothing is known
    counts as nothing, and so does one that fell silent. ``floors_broke_budget`` says whether the floors alone
    were ever too much.
    """

    def __init__(self, rule_set: RuleSet, profile: Profile, budget_kb_per_s: float) -> None:
        self.floors_broke_budget = False
        self._keeper = BudgetKeeper(budget_kb_per_s)
        self._sources: dict[str, SourceLoad] = {}
        self._unmeasured = _unmeasured(rule_set, profile)

    def change_rules(self, rule_set: RuleSet, profile: Profile) -> None:
        """Other rules and another profile hold; what was measured stays."""
        before, self._unmeasured = self._unmeasured, _unmeasured(rule_set, profile)
        if self._unmeasured != before:
            self._sources = {
                topic: source for topic, source in self._sources.items() if topic in self._unmeasured
            }
            self._keeper.change_topics(self._unmeasured)

    def set_budget(self, budget_kb_per_s: float) -> None:
        """The link now carries ``budget_kb_per_s``; the next ``update`` plans anew."""
        self._keeper.budget_kb_per_s = budget_kb_per_s

    @property
    def budget_kb_per_s(self) -> float:
        """What the link carries."""
        return self._keeper.budget_kb_per_s

    @property
    def floors_break_budget(self) -> bool:
        """Whether the floors alone are too much now."""
        return not self._keeper.plan.floors_fit

    def record(self, topic: str, now_ns: int, size_bytes: int) -> None:
        """A source sent a message; topics without a relay do not count."""
        source = self._sources.get(topic)
        if source is None:
            if topic not in self._unmeasured:
                return
            source = self._sources[topic] = SourceLoad()
        source.record(now_ns, size_bytes)

    @property
    def next_check_ns(self) -> int | None:
        """When the use of the link is next looked at."""
        return self._keeper.next_check_ns

    def update(self, wishes: Mapping[str, Wish], now_ns: int, *, wishes_changed: bool) -> set[str]:
        """Plan anew if it is time or wishes changed; the topics whose cut is another one now."""
        if not wishes_changed and not self._keeper.is_due(now_ns):
            return set()
        before = self._keeper.plan
        loads = [self._load(topic, wish, now_ns) for topic, wish in wishes.items()]
        after = self._keeper.update(loads, now_ns, wishes_changed=wishes_changed)
        if after is before:
            return set()
        self.floors_broke_budget |= not after.floors_fit
        topics = {*before.cut_hz, *after.cut_hz}
        return {topic for topic in topics if before.cut_hz.get(topic) != after.cut_hz.get(topic)}

    def within(self, topic: str, wish: Wish) -> Wish:
        """``wish``, cut if the budget asks for it; the deciding block stays named."""
        cut_hz = self._keeper.plan.cut_hz.get(topic)
        if cut_hz is None:
            return wish
        return replace(wish, planned=replace(wish.planned, rate=Rate(cut_hz), reason=Reason.BUDGET))

    def _load(self, topic: str, wish: Wish, now_ns: int) -> TopicLoad:
        load = replace(self._unmeasured[topic], wish_hz=wish.planned.rate.hz)
        source = self._sources.get(topic)
        if source is not None:
            source.forget(now_ns)
            load.source_hz = 0.0 if source.is_empty else source.source_hz
            load.size_kb = 0.0 if source.is_empty else source.message_kb
        elif math.isinf(load.wanted_hz):
            load.source_hz = 0.0
        return load


def _unmeasured(rule_set: RuleSet, profile: Profile) -> dict[str, TopicLoad]:
    loads = {}
    for topic in rule_set.relayed:
        entry = profile.topic(topic)
        loads[topic] = TopicLoad(
            topic=topic,
            wish_hz=0.0,
            floor_hz=max(rule_set.floors_hz.get(topic, 0.0), entry.min_hz or 0.0),
            priority=entry.priority,
            size_kb=entry.message_kb or 0.0,
            source_hz=math.inf if entry.source_hz is None else entry.source_hz,
        )
    return loads
