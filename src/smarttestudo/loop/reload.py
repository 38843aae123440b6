# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Other rules for a loop that runs: made before they come into force, and the exchange."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from smarttestudo.domain.action import ActionDecision
from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal, Values
from smarttestudo.domain.timing import AlarmClock, Yield, never_yield, yielding
from smarttestudo.domain.units import NS_PER_S, ns_from_s
from smarttestudo.language.evaluator import Evaluator, RequestedRate
from smarttestudo.language.rule_set import RuleBlock, RuleSet
from smarttestudo.loop.knowledge.knowledge import Knowledge, watched_topics, watched_vitals
from smarttestudo.loop.knowledge.watched_topic import WatchedTopic
from smarttestudo.loop.knowledge.watched_vitals import WatchedVitals
from smarttestudo.loop.step import action_decisions, still_begun

_GONE = -1
"""Stands for a block that the new rules do not have."""

_Deciding = tuple[RuleSet, Sequence[RuleBlock]]
"""Rules, and their blocks that set one topic."""


@dataclass(frozen=True, slots=True)
class SameRules:
    """The blocks that decide one topic before and after, alike but for their places.

    ``blocks`` are those after by the order of those before, ``named`` the same by the former label and line.
    """

    blocks: Mapping[int, RuleBlock]
    named: Mapping[tuple[str, int], RuleBlock]


class RuleExchange:
    """An exchange of the rules ``before`` for ``after``, and all that can be made before it.

    So the loop need not stop for as long as the number of rules takes. An exchange is made once; ``values``
    of signals may be those then. ``same`` are the topics whose rules stay the same.
    """

    def __init__(
        self,
        before: RuleSet,
        after: RuleSet,
        values: Mapping[Signal, Values | None] | None = None,
        yield_turn: Yield = never_yield,
    ) -> None:
        self.before, self.after = before, after
        self.evaluator = Evaluator(after, yield_turn=yield_turn)
        self.evaluator.foresee(values or {}, yield_turn)
        old_blocks, new_blocks = before.blocks_by_topic(yield_turn), after.blocks_by_topic(yield_turn)
        self.same = {
            topic: _same(old, new)
            for topic, old in old_blocks.items()
            if (new := new_blocks.get(topic)) is not None
            and _are_alike(topic, (before, old), (after, new), yield_turn)
        }
        self.counterpart = _counterparts(before, after, yield_turn)

    def fits(self, before: RuleSet, after: RuleSet) -> bool:
        """Whether it is an exchange of these rules."""
        return self.before is before and self.after is after

    def dismantle(self, yield_turn: Yield = never_yield) -> None:
        """Free what was in force before, after the exchange, piece by piece."""
        self.evaluator.dismantle(yield_turn)
        left: list[object] = [*self.before.blocks]
        del self.before, self.same, self.counterpart
        while left:
            yield_turn()
            left.pop()


def _same(before: Sequence[RuleBlock], after: Sequence[RuleBlock]) -> SameRules:
    pairs = list(zip(before, after, strict=True))
    return SameRules(
        blocks={one.order: other for one, other in pairs},
        named={(one.label, one.line): other for one, other in pairs},
    )


def _are_alike(topic: str, before: _Deciding, after: _Deciding, yield_turn: Yield) -> bool:
    """Whether all that decides the rate and the bounds of ``topic`` is the same."""
    (before_set, old), (after_set, new) = before, after
    if len(old) != len(new) or _always(before_set, topic) != _always(after_set, topic):
        return False
    pairs = yielding(zip(old, new, strict=True), yield_turn)
    return all(_stance(one, topic) == _stance(other, topic) for one, other in pairs)


def _always(rule_set: RuleSet, topic: str) -> object:
    return rule_set.defaults.get(topic), rule_set.floors_hz.get(topic), rule_set.bounds.get(topic)


def _stance(block: RuleBlock, topic: str) -> object:
    return block.name, block.priority, block.rates.get(topic), block.bounds.get(topic), block.form


def _counterparts(before: RuleSet, after: RuleSet, yield_turn: Yield) -> Callable[[int], int]:
    """Which block of ``after`` each block of ``before`` became: the one of the same name."""
    found: dict[int, int] = {}
    by_label: dict[str, list[int]] = {}
    for block in yielding(reversed(after.blocks), yield_turn):
        by_label.setdefault(block.label, []).append(block.order)
    for block in yielding(before.blocks, yield_turn):
        if orders := by_label.get(block.label):
            found[block.order] = orders.pop()
    return lambda order: found.get(order, _GONE)


def exchange_rules(
    knowledge: Knowledge, prepared: RuleExchange, profile: Profile, sources: Mapping[str, SourceChanged]
) -> tuple[Decision, ...]:
    """Put other rules and another profile in force; the next step, to be made now, plans by them.

    ``prepared`` was made of the rules in force, and has their evaluator afterwards. ``sources`` is the last
    report on each source. A topic whose rules stay the same keeps a lower rate waiting; any other takes its
    new rate in the next step. Returns the end of each topic that is no longer relayed.
    """
    rule_set = prepared.after
    now_ns = knowledge.time.now_ns
    order_of = {topic: place for place, topic in enumerate(rule_set.relayed)}
    ended = tuple(_end(knowledge, topic, now_ns) for topic in knowledge.order_of if topic not in order_of)
    knowledge.begun = still_begun(knowledge, rule_set)
    knowledge.rule_set, knowledge.profile = rule_set, profile
    knowledge.order_of = order_of
    knowledge.settle_ns = ns_from_s(profile.settle_s)
    prepared.evaluator.start(now_ns)
    prepared.evaluator.restore_history(knowledge.evaluator)
    knowledge.evaluator, prepared.evaluator = prepared.evaluator, knowledge.evaluator
    knowledge.watched = _watched(knowledge, sources, now_ns)
    knowledge.vitals = _vitals(knowledge)
    knowledge.watch_alarms = AlarmClock()
    for topic in (*knowledge.watched, *knowledge.vitals):
        knowledge.watch_alarms.set(topic, now_ns)
    _carry_on_hysteresis(knowledge, prepared.same)
    knowledge.settle_alarms = AlarmClock()
    _keep_plan(knowledge, prepared.counterpart)
    knowledge.without_subscribers &= order_of.keys()
    if knowledge.link is not None:
        knowledge.link.change_rules(rule_set, profile)
    return ended


def change_actions(knowledge: Knowledge) -> Iterator[ActionDecision]:
    """Go on with what the blocks do that hold still, and end what the others did."""
    now_ns = knowledge.time.now_ns
    holding = [knowledge.rule_set.blocks[order] for order in knowledge.begun]
    planned = knowledge.actions.change_rules(holding, knowledge.profile, now_ns)
    yield from action_decisions(knowledge, planned, now_ns)


def made_by_reload(decision: Decision) -> Decision:
    """``decision`` with the reason ``reload``, unless its reason is that there are no rules."""
    if decision.planned.reason is Reason.FALLBACK:
        return decision
    return replace(decision, planned=replace(decision.planned, reason=Reason.RELOAD))


def _end(knowledge: Knowledge, topic: str, now_ns: int) -> Decision:
    return Decision(
        t_s=(now_ns - knowledge.start_ns) / NS_PER_S,
        stamp_ns=knowledge.time.on_clock(now_ns),
        topic=topic,
        from_rate=knowledge.effective[topic].planned.rate,
        from_within=knowledge.effective[topic].planned.within,
        planned=PlannedRate(rate=Rate(0.0), reason=Reason.RELOAD),
        values={},
        is_end=True,
    )


def _watched(
    knowledge: Knowledge, sources: Mapping[str, SourceChanged], now_ns: int
) -> Mapping[str, WatchedTopic]:
    watched = watched_topics(knowledge.rule_set, knowledge.profile, now_ns, knowledge.evaluator)
    for topic, entry in watched.items():
        known, change = knowledge.watched.get(topic), sources.get(topic)
        if known is not None:
            entry.restore_history(known)
        elif change is not None:
            entry.change_source(change)
    return watched


def _vitals(knowledge: Knowledge) -> Mapping[str, WatchedVitals]:
    vitals = watched_vitals(knowledge.rule_set)
    for source, entry in vitals.items():
        if (known := knowledge.vitals.get(source)) is not None:
            entry.restore_history(known)
    return vitals


def _carry_on_hysteresis(knowledge: Knowledge, same: Mapping[str, SameRules]) -> None:
    """Keep the requests that wait, of the topics whose rules stay the same."""
    knowledge.hysteresis = {
        topic: waiting.carried_on(
            partial(_renamed, same[topic].blocks),
            partial(_with_renamed_bounds, same[topic].named),
            knowledge.settle_ns,
        )
        for topic, waiting in knowledge.hysteresis.items()
        if topic in same
    }


def _renamed(new_blocks: Mapping[int, RuleBlock], request: RequestedRate) -> RequestedRate:
    if request.block is None:
        return request
    block = new_blocks[request.block]
    return replace(
        request, block=block.order, planned=replace(request.planned, rule=block.label, line=block.line)
    )


def _with_renamed_bounds(
    new_blocks: Mapping[tuple[str, int], RuleBlock], planned: PlannedRate
) -> PlannedRate:
    """``planned``, its bounds decided by the blocks as the new rules have them."""
    reasons = {
        name: reason
        if reason.rule is None or reason.line is None
        else replace(
            reason,
            rule=new_blocks[reason.rule, reason.line].label,
            line=new_blocks[reason.rule, reason.line].line,
        )
        for name, reason in planned.bound_reasons.items()
    }
    return replace(planned, bound_reasons=reasons)


def _keep_plan(knowledge: Knowledge, counterpart: Callable[[int], int]) -> None:
    """The plan of topics still relayed, with the deciding blocks as the new rules count them."""
    for kept in (knowledge.settled, knowledge.effective, knowledge.plan):
        for topic in [topic for topic in kept if topic not in knowledge.order_of]:
            del kept[topic]
    for requests in (knowledge.settled, knowledge.effective):
        for topic, request in requests.items():
            if request.block is not None:
                requests[topic] = replace(request, block=counterpart(request.block))
