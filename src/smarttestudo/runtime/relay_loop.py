# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop with its relays, as a recording and a live robot drive it alike."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterator, Mapping, Sequence

from smarttestudo.adirf.rule_set import RuleSet
from smarttestudo.domain.block_status import BlockStatus
from smarttestudo.domain.decision import Decision, PlannedRate
from smarttestudo.domain.observation import Arrival, LinkBudget, Observation, SourceChanged
from smarttestudo.domain.payload import Payload
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.runtime.analyze.block_states import block_states
from smarttestudo.runtime.execute.relay import Relayed
from smarttestudo.runtime.execute.relays import Relays
from smarttestudo.runtime.execute.statistics import RelayStatistics
from smarttestudo.runtime.knowledge.knowledge import Knowledge
from smarttestudo.runtime.monitor.monitor import meter
from smarttestudo.runtime.reload import exchange_rules, made_by_reload
from smarttestudo.runtime.step import step


class RelayLoop:
    """Steps the loop when something it watches happens, and paces every message by the plan.

    The driver passes in all messages and the time, and calls ``on_wake`` when the clock reaches
    ``next_wake_ns``; a later wake, or the next message in its place, only delays what it would have done.
    What comes back is to be published at once. The clock may jump back: for the plan it then stood still
    (``SteadyTime``), and the pacers begin anew.
    """

    def __init__(
        self,
        rule_set: RuleSet,
        profile: Profile,
        start_ns: int,
        when_slow: WhenSlow = WhenSlow.PASS,
        budget_kb_per_s: float | None = None,
    ) -> None:
        self._knowledge = Knowledge(rule_set, profile, start_ns, budget_kb_per_s)
        self._relays = Relays(rule_set.relayed, profile, when_slow, start_ns)
        self._watched = self._knowledge.watched.keys()
        self._sources: dict[str, SourceChanged] = {}
        self._decisions: list[Decision] = []
        self._now_ns = start_ns
        self._step_ns: int | None = None
        self._step((), start_ns)

    @property
    def next_wake_ns(self) -> int | None:
        """When time alone may next relay something or change the plan; it may come early."""
        step_ns, relays_ns = self._step_ns, self._relays.next_wake_ns
        if relays_ns is None:
            return step_ns
        return relays_ns if step_ns is None or relays_ns < step_ns else step_ns

    @property
    def profile(self) -> Profile:
        """What is known about the topics."""
        return self._knowledge.profile

    @property
    def plan(self) -> Mapping[str, PlannedRate]:
        """The rate of each relayed topic, with its reason; a live view."""
        return self._knowledge.plan

    @property
    def topics(self) -> Mapping[str, RelayStatistics]:
        """What was done for each relayed topic."""
        return self._relays.statistics

    @property
    def leaders(self) -> Mapping[str, str]:
        """The topic that each topic paced with another one follows."""
        return self._relays.leaders

    @property
    def undecodable(self) -> Mapping[str, int]:
        """Messages that checks would have read but that could not be decoded, by topic."""
        return self._knowledge.undecodable

    @property
    def unknown_values(self) -> Mapping[Signal, int]:
        """Messages that left a signal unknown: NaN, or no such field."""
        return self._knowledge.unknown_values

    @property
    def floors_broke_budget(self) -> bool:
        """Whether the floors alone were ever more than the budget; they won."""
        return self._knowledge.link is not None and self._knowledge.link.floors_broke_budget

    @property
    def floors_break_budget(self) -> bool:
        """Whether the floors alone are more than the budget now."""
        return self._knowledge.link is not None and self._knowledge.link.floors_break_budget

    @property
    def budget_kb_per_s(self) -> float | None:
        """What all relayed topics together may take; ``None`` without a budget."""
        return None if self._knowledge.link is None else self._knowledge.link.budget_kb_per_s

    def block_states(self, now_ns: int) -> tuple[BlockStatus, ...]:
        """Which conditions hold, and what their checks read; to be asked right after ``on_wake``."""
        return block_states(self._knowledge, self._knowledge.time.at(now_ns))

    @property
    def discarded(self) -> Mapping[str, int]:
        """Messages of topics paced with another one that met no decision of it."""
        return self._relays.discarded

    @property
    def watched(self) -> Collection[str]:
        """The topics that checks read."""
        return self._knowledge.watched.keys()

    def reads(self, topic: str) -> bool:
        """Whether a check reads fields of ``topic``, so that its messages must be decoded."""
        watched = self._knowledge.watched.get(topic)
        return watched is not None and bool(watched.fields)

    def may_skip(self, topic: str) -> bool:
        """Whether the messages of ``topic`` that are not due need not be passed in, but for the last one.

        So it is where no check reads anything of it, no budget counts it and its pacer does not hold it back
        for others; tell ``on_skipped`` how many there were.
        """
        needs_all = topic in self._watched or self._knowledge.link is not None
        return not needs_all and self._relays.may_skip(topic)

    def due_ns(self, topic: str) -> int | None:
        """When the next message of a topic that ``may_skip`` may pass; ``None``: at once."""
        return self._relays.due_ns(topic)

    def on_skipped(self, topic: str, messages: int, size_bytes: int) -> None:
        """So many messages, of that size together, came since the last one and were not passed in."""
        self._relays.skipped(topic, messages, size_bytes)

    def on_message(
        self,
        topic: str,
        now_ns: int,
        payload: Payload,
        size_bytes: int,
        *,
        message: object | None = None,
        publisher: Hashable = None,
    ) -> Sequence[Relayed]:
        """A message arrived, and is itself paced by the plan that it may change.

        ``message`` is its decoded form, or ``Undecodable``, where ``reads`` asks for it.
        """
        # This runs for every message of a robot, so what is seldom needed is asked for without a call.
        freed = self._restarted(now_ns) if now_ns < self._now_ns else ()
        self._now_ns = now_ns
        if topic in self._watched:
            self._step((Arrival(topic=topic, size_bytes=size_bytes, message=message),), now_ns)
        else:
            if self._knowledge.link is not None:
                meter(self._knowledge, topic, size_bytes, now_ns)
            if self._step_ns is not None and self._step_ns <= now_ns:
                self._step((), now_ns)
        wake_ns = self._relays.next_wake_ns
        if wake_ns is not None and wake_ns <= now_ns:
            freed = [*freed, *self._relays.wake(now_ns)]
        relayed = self._relays.offer(topic, payload, size_bytes, publisher, now_ns)
        return [*freed, *relayed] if freed else relayed

    def on_source(self, change: SourceChanged, now_ns: int) -> Sequence[Relayed]:
        """The publishers, the durability or the type of a topic changed."""
        restarted = self._restarted(now_ns)
        self._sources[change.topic] = change
        self._step((change,), now_ns)
        return [*restarted, *self._woken(now_ns), *self._relays.change_source(change, now_ns)]

    def on_budget(self, budget: LinkBudget, now_ns: int) -> Sequence[Relayed]:
        """The link carries another budget."""
        restarted = self._restarted(now_ns)
        self._step((budget,), now_ns)
        return [*restarted, *self._woken(now_ns)]

    def on_wake(self, now_ns: int) -> Sequence[Relayed]:
        """Time passed."""
        return self._pass_time(now_ns)

    def reload(self, rule_set: RuleSet, profile: Profile, now_ns: int) -> Sequence[Relayed]:
        """Let other rules and another profile hold from now on.

        What is known of the robot stays, and so do the pacers of topics that are relayed before and after:
        none of their messages is lost. Sources that the rules did not name before, the driver tells anew.
        """
        relayed = [*self._pass_time(now_ns)]
        self._decisions += exchange_rules(self._knowledge, rule_set, profile, self._sources)
        self._watched = self._knowledge.watched.keys()
        relayed += self._relays.change_topics(rule_set.relayed, profile, now_ns)
        known = {*self._watched, *rule_set.relayed}
        self._sources = {topic: change for topic, change in self._sources.items() if topic in known}
        for change in self._sources.values():
            relayed += self._relays.change_source(change, now_ns)
        self._step((), now_ns, made_by_reload)
        return [*relayed, *self._woken(now_ns)]

    def _pass_time(self, now_ns: int) -> Sequence[Relayed]:
        restarted = self._restarted(now_ns)
        if self._step_ns is not None and self._step_ns <= now_ns:
            self._step((), now_ns)
        woken = self._woken(now_ns)
        return [*restarted, *woken] if restarted else woken

    def take_decisions(self) -> list[Decision]:
        """The decisions since the last call; at first, one for every relayed topic."""
        decisions, self._decisions = self._decisions, []
        return decisions

    def take_turned_blocks(self) -> dict[int, Truth]:
        """Whether each block holds now, by order, of those that turned since the last call."""
        evaluator = self._knowledge.evaluator
        return {order: evaluator.truth(order) for order in evaluator.take_changed_blocks()}

    def finish(self, now_ns: int) -> Iterator[Relayed]:
        """The recording ended at ``now_ns``: what is still held back, each at its time, by the last plan."""
        return self._relays.finish(now_ns)

    def _step(
        self,
        observations: Sequence[Observation],
        now_ns: int,
        told: Callable[[Decision], Decision] | None = None,
    ) -> None:
        result = step(self._knowledge, observations, now_ns)
        self._step_ns = result.next_wake_ns
        if result.decisions:
            self._decisions += map(told, result.decisions) if told else result.decisions
            self._relays.apply(result.decisions, now_ns)

    def _woken(self, now_ns: int) -> Sequence[Relayed]:
        wake_ns = self._relays.next_wake_ns
        return () if wake_ns is None or wake_ns > now_ns else self._relays.wake(now_ns)

    def _restarted(self, now_ns: int) -> Sequence[Relayed]:
        """What a clock that jumped back sets free."""
        jumped_back, self._now_ns = now_ns < self._now_ns, now_ns
        if not jumped_back:
            return ()
        self._step((), now_ns)
        return self._relays.restart(now_ns)
