# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop with its relays, as a recording and a live robot drive it alike."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence

from smarttestudo.domain.decision import AnyDecision, Decision, about_rates
from smarttestudo.domain.observation import (
    Arrival,
    ClockJumped,
    ListenersChanged,
    Observation,
    ReceiversReckon,
    SourceChanged,
)
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.signal import Truth
from smarttestudo.domain.timing import Yield, never_yield
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop.block_states import BlockStates
from smarttestudo.loop.inputs import ChangeInput, GraphInput, LoopInput, MessageInput, RulesInput, WakeInput
from smarttestudo.loop.knowledge.knowledge import Knowledge
from smarttestudo.loop.relay import Relayed
from smarttestudo.loop.relays import Relays
from smarttestudo.loop.reload import RuleExchange, change_actions, exchange_rules, made_by_reload
from smarttestudo.loop.step import Trigger, meter, step
from smarttestudo.pacing.sample import WhenSlow


class RelayLoop:
    """Steps the loop when something it watches happens, and paces every message by the plan.

    The driver lets it ``handle`` all that happens, in order, and a ``WakeInput`` when the clock reaches
    ``next_wake_ns``; a later wake, or the next message in its place, only delays what it would have done.
    The clock may jump back: for the plan it then stood still (``SteadyTime``), and the pacers begin anew.
    Where it jumps ahead, that is time that passed, unless a ``ClockJumped`` comes before anything else.
    Of topics in ``reckoned``, receivers show dead reckoning in the place of the last value, until a
    ``ReceiversReckon`` says otherwise. ``knowledge`` and ``relays`` are there to be read, not changed.
    """

    def __init__(
        self,
        rule_set: RuleSet,
        profile: Profile,
        start_ns: int,
        when_slow: WhenSlow = WhenSlow.PASS,
        budget_kb_per_s: float | None = None,
        *,
        reckoned: Collection[str] = (),
    ) -> None:
        self.knowledge = Knowledge(rule_set, profile, start_ns, budget_kb_per_s)
        self.relays = Relays(
            rule_set.relayed, profile, when_slow, start_ns, floors_hz=rule_set.floors_hz, reckoned=reckoned
        )
        self._freed: list[Relayed] = []
        """What passed because of a step; it goes out with what the step was for."""
        self._watched = self.knowledge.watched.keys()
        self._sources: dict[str, SourceChanged] = {}
        self._decisions: list[AnyDecision] = []
        self.triggers: list[Trigger] = []
        """Blocks that began to record with the last input, or at the start."""
        self._now_ns = start_ns
        self._step_ns: int | None = None
        self._step((), start_ns)

    @property
    def next_wake_ns(self) -> int | None:
        """When time alone may next relay something or change the plan; it may come early."""
        step_ns, relays_ns = self._step_ns, self.relays.next_wake_ns
        if relays_ns is None:
            return step_ns
        return relays_ns if step_ns is None or relays_ns < step_ns else step_ns

    def handle(self, given: LoopInput) -> Sequence[Relayed]:
        """Handle an input: return what to publish at once.

        A message is itself paced by the plan that it may change.
        """
        if self.triggers:
            self.triggers = []
        if not isinstance(given, MessageInput):
            others = self._handle_other(given)
            return self._with_freed(others) if self._freed else others
        # This runs for every message of a robot, so what is seldom needed is asked for without a call.
        now_ns, topic = given.stamp_ns, given.topic
        freed = self._restarted(now_ns) if now_ns < self._now_ns else ()
        self._now_ns = now_ns
        if topic in self._watched:
            self._step((Arrival(topic, given.size_bytes, given.message),), now_ns)
        else:
            needs_step = self.knowledge.link is not None and meter(
                self.knowledge, topic, given.size_bytes, now_ns
            )
            if needs_step or (self._step_ns is not None and self._step_ns <= now_ns):
                self._step((), now_ns)
        wake_ns = self.relays.next_wake_ns
        if wake_ns is not None and wake_ns <= now_ns:
            freed = [*freed, *self.relays.wake(now_ns)]
        relayed = self.relays.offer(given)
        if self.knowledge.link is not None:
            self.knowledge.link.set_streams(topic, self.relays.streams(topic))
        if self._freed:
            freed = self._with_freed(freed)
        return [*freed, *relayed] if freed else relayed

    def count(self, topic: str, size_bytes: int, stamp_ns: int) -> Sequence[Relayed]:
        """Count a message that is paced elsewhere for the budget, in the order of all inputs; what passes."""
        self.triggers = []
        now_ns = max(stamp_ns, self._now_ns)
        if not meter(self.knowledge, topic, size_bytes, now_ns):
            return ()
        self._now_ns = now_ns
        self._step((), now_ns)
        return self._with_freed(())

    def needs_decoded(self, topic: str) -> bool:
        """Whether messages of ``topic`` must come decoded: for a check, or for a bound of its estimate."""
        return self.knowledge.reads(topic) or self.relays.needs_decoded(topic)

    @property
    def counts_all(self) -> bool:
        """Whether a budget counts all messages, those of topics that are paced elsewhere included."""
        return self.knowledge.link is not None

    def may_skip(self, topic: str) -> bool:
        """Whether messages of ``topic`` that are not due may be skipped, except for the last one.

        That is so if no check reads anything of it, its pacer does not hold it back for others, and no budget
        counts it; report to ``relays.skipped`` how many.
        """
        return not self.counts_all and topic not in self._watched and self.relays.may_skip(topic)

    def may_leave(self, topic: str) -> bool:
        """Whether messages of ``topic`` may be paced elsewhere.

        That is so if no check reads anything of it, and its pacer does not hold it back for others.
        """
        return topic not in self._watched and self.relays.may_leave(topic)

    def block_states(self, now_ns: int, most: int | None = None) -> BlockStates:
        """Which conditions hold, of the first ``most`` blocks; to be asked right after a ``WakeInput``."""
        return BlockStates(self.knowledge, self.knowledge.time.at(now_ns), most)

    def prepare(self, rule_set: RuleSet, yield_turn: Yield = never_yield) -> RuleExchange:
        """Other rules, prepared to replace those in force; another thread may call it meanwhile."""
        knowledge = self.knowledge
        return RuleExchange(knowledge.rule_set, rule_set, knowledge.evaluator.values, yield_turn)

    def take_all_decisions(self) -> list[AnyDecision]:
        """The decisions since the last call, in order; at first, one for every relayed topic."""
        decisions, self._decisions = self._decisions, []
        return decisions

    def take_decisions(self) -> list[Decision]:
        """As ``take_all_decisions``, of topics only; the others are dropped."""
        return about_rates(self.take_all_decisions())

    def take_turned_blocks(self) -> dict[int, Truth]:
        """Whether each block holds now, by order, of those that turned since the last call."""
        evaluator = self.knowledge.evaluator
        return {order: evaluator.truth(order) for order in evaluator.take_changed_blocks()}

    def finish(self, now_ns: int) -> Iterator[Relayed]:
        """The recording ended at ``now_ns``: what is still held back, each at its time, by the last plan."""
        return self.relays.finish(now_ns)

    def _handle_other(self, given: ChangeInput | GraphInput | WakeInput | RulesInput) -> Sequence[Relayed]:
        match given:
            case WakeInput(stamp_ns=now_ns):
                return self._pass_time(now_ns)
            case ChangeInput(stamp_ns=now_ns, change=change):
                if isinstance(change, ReceiversReckon):
                    return [*self._pass_time(now_ns), *self.relays.set_reckoned(change.topics, now_ns)]
                if isinstance(change, ClockJumped):
                    self.knowledge.time.leave_out(change.ahead_ns)
                    for statistics in self.relays.statistics.values():
                        statistics.leave_out(change.ahead_ns, now_ns)
                    self.relays.restart_grids(now_ns)
                    return self._pass_time(now_ns)
                return self._observe((change,), now_ns)
            case GraphInput(stamp_ns=now_ns):
                return self._observe((*given.sources, *given.listeners), now_ns)
            case RulesInput():
                return self._handle_rules(given)

    def _observe(self, changes: Sequence[Observation], now_ns: int) -> Sequence[Relayed]:
        relayed = [*self._restarted(now_ns)]
        self._step(changes, now_ns)
        relayed += self._woken(now_ns)
        for change in changes:
            if isinstance(change, ListenersChanged) and not change.are_there:
                self.relays.end_groups(change.topic)
            elif isinstance(change, ListenersChanged):
                self.relays.resend_to_new_receiver(change.topic, now_ns)
                relayed += self._woken(now_ns)
            if isinstance(change, SourceChanged):
                self._sources[change.topic] = change
                relayed += self.relays.change_source(change, now_ns)
        return relayed

    def _handle_rules(self, given: RulesInput) -> Sequence[Relayed]:
        """Exchange the rules.

        Knowledge of the robot stays, and so do the pacers of topics that are relayed before and after: none
        of their messages is lost. The driver must report sources again that are new to the rules.
        """
        rule_set, profile, now_ns = given.rule_set, given.profile, given.stamp_ns
        relayed = [*self._pass_time(now_ns)]
        self.knowledge.time.advance(now_ns)
        prepared = given.prepared
        if prepared is None or not prepared.fits(self.knowledge.rule_set, rule_set):
            prepared = RuleExchange(self.knowledge.rule_set, rule_set)
        self._decisions += exchange_rules(self.knowledge, prepared, profile, self._sources)
        self._decisions += change_actions(self.knowledge)
        self._watched = self.knowledge.watched.keys()
        relayed += self.relays.change_topics(rule_set.relayed, profile, now_ns, floors_hz=rule_set.floors_hz)
        known = {*self._watched, *rule_set.relayed}
        self._sources = {topic: change for topic, change in self._sources.items() if topic in known}
        for change in self._sources.values():
            relayed += self.relays.change_source(change, now_ns)
        self._step((), now_ns, made_by_reload)
        return [*relayed, *self._woken(now_ns)]

    def _pass_time(self, now_ns: int) -> Sequence[Relayed]:
        restarted = self._restarted(now_ns)
        if self._step_ns is not None and self._step_ns <= now_ns:
            self._step((), now_ns)
        woken = self._woken(now_ns)
        return [*restarted, *woken] if restarted else woken

    def _step(
        self,
        observations: Sequence[Observation],
        now_ns: int,
        relabel: Callable[[Decision], Decision] | None = None,
    ) -> None:
        result = step(self.knowledge, observations, now_ns)
        self._step_ns = result.next_wake_ns
        self.triggers += result.triggers
        if result.decisions:
            self._decisions += map(relabel, result.decisions) if relabel else result.decisions
            self._freed += self.relays.apply(result.decisions, now_ns)
        self._decisions += result.actions

    def _with_freed(self, relayed: Sequence[Relayed]) -> list[Relayed]:
        freed, self._freed = self._freed, []
        return [*freed, *relayed]

    def _woken(self, now_ns: int) -> Sequence[Relayed]:
        wake_ns = self.relays.next_wake_ns
        return () if wake_ns is None or wake_ns > now_ns else self.relays.wake(now_ns)

    def _restarted(self, now_ns: int) -> Sequence[Relayed]:
        """Messages that pass because the clock jumped back."""
        before_ns, self._now_ns = self._now_ns, now_ns
        if now_ns >= before_ns:
            return ()
        # A message without a step does not advance the knowledge's time, from which the jump counts.
        self.knowledge.time.advance(before_ns)
        self._step((), now_ns)
        return self.relays.restart(now_ns)
