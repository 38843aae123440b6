# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Other rules for a loop that runs: what is known of the robot stays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.observation import SourceChanged
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.timing import AlarmClock
from smarttestudo.domain.units import NS_PER_S, ns_from_s
from smarttestudo.language.evaluator import RequestedRate
from smarttestudo.language.rule_set import RuleBlock
from smarttestudo.loop.knowledge.knowledge import Knowledge, watched_topics
from smarttestudo.loop.knowledge.watched_topic import WatchedTopic
from smarttestudo.loop.prepared_rules import PreparedRules, SameRules
from smarttestudo.loop.step import still_recording


def exchange_rules(
    knowledge: Knowledge, prepared: PreparedRules, profile: Profile, sources: Mapping[str, SourceChanged]
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
    knowledge.recording = still_recording(knowledge, rule_set)
    knowledge.rule_set, knowledge.profile = rule_set, profile
    knowledge.order_of = order_of
    knowledge.settle_ns = ns_from_s(profile.settle_s)
    prepared.evaluator.start(now_ns)
    prepared.evaluator.restore_history(knowledge.evaluator)
    knowledge.evaluator, prepared.evaluator = prepared.evaluator, knowledge.evaluator
    knowledge.watched = _watched(knowledge, sources, now_ns)
    knowledge.watch_alarms = AlarmClock()
    for topic in knowledge.watched:
        knowledge.watch_alarms.set(topic, now_ns)
    _carry_on_hysteresis(knowledge, prepared.same)
    knowledge.settle_alarms = AlarmClock()
    _keep_plan(knowledge, prepared.counterpart)
    knowledge.without_subscribers &= order_of.keys()
    if knowledge.link is not None:
        knowledge.link.change_rules(rule_set, profile)
    return ended


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
        name: one
        if one.rule is None or one.line is None
        else replace(one, rule=new_blocks[one.rule, one.line].label, line=new_blocks[one.rule, one.line].line)
        for name, one in planned.bound_reasons.items()
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
