# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One turn of the loop: monitor, analyze, plan."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

from smarttestudo.domain.action import ActionDecision, ActionEvent
from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.observation import (
    Arrival,
    LinkBudget,
    ListenersChanged,
    Observation,
    SourceChanged,
    Undecodable,
    VitalsMeasured,
)
from smarttestudo.domain.signal import Truth, Value
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.evaluator import RequestedRate
from smarttestudo.language.rule_set import RuleBlock, RuleSet
from smarttestudo.loop.knowledge.action_plan import PlannedAction
from smarttestudo.loop.knowledge.knowledge import Hysteresis, Knowledge
from smarttestudo.loop.knowledge.watched_topic import Reading, WatchedTopic
from smarttestudo.loop.knowledge.watched_vitals import WatchedVitals


def monitor(knowledge: Knowledge, observations: Iterable[Observation], now_ns: int) -> list[Reading]:
    """The values of the signals of every topic that was observed or that time alone changes.

    ``now_ns`` is the steady time. Topics that no check reads cost a look-up.
    """
    touched: dict[str, WatchedTopic | WatchedVitals] = {}
    for observation in observations:
        if isinstance(observation, LinkBudget):
            knowledge.set_budget(observation)
            continue
        if isinstance(observation, VitalsMeasured):
            vitals = knowledge.vitals.get(observation.source)
            if vitals is not None:
                touched[observation.source] = vitals
                vitals.take(observation.values, now_ns)
            continue
        _meter(knowledge, observation, now_ns)
        if isinstance(observation, ListenersChanged):
            continue
        watched = knowledge.watched.get(observation.topic)
        if watched is not None:
            touched[observation.topic] = watched
            _take(knowledge, watched, observation, now_ns)
    for topic in knowledge.watch_alarms.take_due(now_ns):
        touched[topic] = knowledge.vitals.get(topic) or knowledge.watched[topic]
    readings: list[Reading] = []
    for topic, read in touched.items():
        readings += read.readings(now_ns)
        knowledge.watch_alarms.set(topic, read.next_change_ns(now_ns))
    return readings


def meter(knowledge: Knowledge, topic: str, size_bytes: int, clock_ns: int) -> bool:
    """Count, for the link's budget, a message of a topic that no check reads; whether that needs a step.

    It does where the topic asks for a part from now on; else the link looks at what it counted from time to
    time.
    """
    if knowledge.link is None:
        return False
    now_ns = knowledge.time.advance(clock_ns)
    return topic not in knowledge.without_subscribers and knowledge.link.record(topic, now_ns, size_bytes)


def _meter(
    knowledge: Knowledge, observation: Arrival | SourceChanged | ListenersChanged, now_ns: int
) -> None:
    """Record an observation for the link's budget."""
    topic, is_over = observation.topic, False
    match observation:
        case Arrival(size_bytes=size_bytes):
            if knowledge.link is not None and topic not in knowledge.without_subscribers:
                knowledge.link.record(topic, now_ns, size_bytes)
        case SourceChanged(publishers=publishers):
            is_over = publishers == 0
        case ListenersChanged(are_there=True):
            knowledge.without_subscribers.discard(topic)
        case ListenersChanged():
            knowledge.without_subscribers.add(topic)
            is_over = True
    if is_over and knowledge.link is not None:
        knowledge.link.end(topic, now_ns)


def _take(
    knowledge: Knowledge, watched: WatchedTopic, observation: Arrival | SourceChanged, now_ns: int
) -> None:
    match observation:
        case Arrival():
            watched.source.record(now_ns)
            watched.arrivals.record(now_ns, observation.size_bytes)
            if watched.fields:
                _read(knowledge, watched, observation, now_ns)
        case SourceChanged():
            watched.change_source(observation)


def _read(knowledge: Knowledge, watched: WatchedTopic, arrival: Arrival, now_ns: int) -> None:
    if arrival.message is None or isinstance(arrival.message, Undecodable):
        watched.fields.forget()
        knowledge.undecodable[arrival.topic] += 1
        return
    for signal in watched.fields.read(arrival.message, now_ns):
        knowledge.unknown_values[signal] += 1


def analyze(knowledge: Knowledge, readings: Iterable[Reading], now_ns: int) -> AbstractSet[str]:
    """The topics whose request may have changed by ``now_ns``, a steady time; at first all relayed ones."""
    knowledge.evaluator.advance(now_ns)
    for signal, value in readings:
        knowledge.evaluator.set(signal, value)
    return knowledge.evaluator.take_changed_topics()


def plan(knowledge: Knowledge, changed: Iterable[str], now_ns: int) -> tuple[Decision, ...]:
    """Bring the plan up to date with the requests of ``changed`` topics and with what has settled.

    ``now_ns`` is the steady time. Decisions come in the order in which the rule set names the topics.
    """
    for topic in changed:
        _take_request(knowledge, topic, now_ns)
    topics = {*changed, *knowledge.settle_alarms.take_due(now_ns)}
    if not topics and knowledge.link is None:
        return ()
    has_changed = [_settle(knowledge, topic, now_ns) for topic in topics]
    if knowledge.link is not None:
        topics |= knowledge.link.update(knowledge.settled, now_ns, requests_changed=any(has_changed))
    return tuple(_decisions(knowledge, sorted(topics, key=knowledge.order_of.__getitem__), now_ns))


def _take_request(knowledge: Knowledge, topic: str, now_ns: int) -> None:
    request = knowledge.evaluator.decide(topic)
    known = knowledge.hysteresis.get(topic)
    if known is None:
        knowledge.hysteresis[topic] = Hysteresis.of(request, knowledge.settle_ns)
    else:
        known.on_request(request, now_ns)


def _settle(knowledge: Knowledge, topic: str, now_ns: int) -> bool:
    """Whether another rate, or other bounds, have settled for ``topic``."""
    hysteresis = knowledge.hysteresis[topic]
    before, after = knowledge.settled.get(topic), hysteresis.effective(now_ns)
    knowledge.settle_alarms.set(topic, hysteresis.next_change_ns)
    knowledge.settled[topic] = after
    if before is None:
        return True
    return (before.planned.rate, before.planned.within) != (after.planned.rate, after.planned.within)


def _decisions(knowledge: Knowledge, topics: Iterable[str], now_ns: int) -> Iterator[Decision]:
    for topic in topics:
        before, after = knowledge.effective.get(topic), knowledge.settled[topic]
        if knowledge.link is not None:
            after = knowledge.link.within(topic, after)
        knowledge.effective[topic] = after
        knowledge.plan[topic] = after.planned
        if before is None or _differs(before, after):
            yield _decision(knowledge, topic, before, after, now_ns)


def _differs(before: RequestedRate, after: RequestedRate) -> bool:
    before_plan, after_plan = before.planned, after.planned
    return (
        before_plan.rate != after_plan.rate
        or before_plan.within != after_plan.within
        or before.block != after.block
        or (before_plan.reason is Reason.UNKNOWN) != (after_plan.reason is Reason.UNKNOWN)
    )


def _decision(
    knowledge: Knowledge, topic: str, before: RequestedRate | None, after: RequestedRate, now_ns: int
) -> Decision:
    return Decision(
        t_s=(now_ns - knowledge.start_ns) / NS_PER_S,
        stamp_ns=knowledge.time.on_clock(now_ns),
        topic=topic,
        from_rate=None if before is None else before.planned.rate,
        planned=after.planned,
        values=knowledge.values_of(after.block, now_ns),
        from_within={} if before is None else before.planned.within,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Trigger:
    """A block that records or acts began to hold at ``stamp_ns``, when its condition read ``values``."""

    stamp_ns: int
    block: RuleBlock
    values: Mapping[str, Value | None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ended:
    """A block that records or acts is known to hold no more."""

    block: RuleBlock


def turns(knowledge: Knowledge, now_ns: int) -> Iterator[Trigger | Ended]:
    """The blocks that are now known to hold and were known not to since they last did, and the other way.

    A condition that is in doubt for a while has neither begun nor ended. ``now_ns`` is a steady time.
    """
    for order, truth in knowledge.evaluator.take_turned_acting():
        block = knowledge.rule_set.blocks[order]
        if truth is Truth.FALSE and order in knowledge.begun:
            knowledge.begun.remove(order)
            yield Ended(block=block)
        elif truth is Truth.TRUE and order not in knowledge.begun:
            knowledge.begun.add(order)
            yield Trigger(
                stamp_ns=knowledge.time.on_clock(now_ns),
                block=block,
                values=knowledge.values_of(order, now_ns),
            )


def act(knowledge: Knowledge, turned: Iterable[Trigger | Ended], now_ns: int) -> Iterator[ActionDecision]:
    """Actions of blocks that turned, and those that waited until ``now_ns``, a steady time."""
    plan = knowledge.actions
    for turn in turned:
        planned = (plan.begin if isinstance(turn, Trigger) else plan.end)(turn.block, now_ns)
        yield from action_decisions(knowledge, planned, now_ns)
    yield from action_decisions(knowledge, plan.advance(now_ns), now_ns)


def action_decisions(
    knowledge: Knowledge, planned: Iterable[PlannedAction], now_ns: int
) -> Iterator[ActionDecision]:
    """The decisions that were ``planned`` at ``now_ns``, with the values that made a block begin."""
    for event, action, block, lasted_ns in planned:
        yield ActionDecision(
            t_s=(now_ns - knowledge.start_ns) / NS_PER_S,
            stamp_ns=knowledge.time.on_clock(now_ns),
            event=event,
            action=action,
            rule=block.label,
            line=block.line,
            values={} if event is ActionEvent.END else knowledge.values_of(block.order, now_ns),
            lasted_s=None if lasted_ns is None else lasted_ns / NS_PER_S,
        )


def still_begun(knowledge: Knowledge, rule_set: RuleSet) -> set[int]:
    """The blocks of ``rule_set``, by order, that are written as those that hold: they do not begin again."""
    holding = {written(knowledge.rule_set.blocks[order]) for order in knowledge.begun}
    acting = (block for block in rule_set.blocks if block.recordings or block.acts)
    return {block.order for block in acting if written(block) in holding}


def written(block: RuleBlock) -> object:
    """All that stays when other statements move the block, and comments change."""
    names = tuple(recording.name for recording in block.recordings)
    return block.name, None if block.name is not None else (names, block.acts), block.form


class StepResult(NamedTuple):
    """The plan of all relayed topics, what changed in it, and when to step next.

    ``plan`` is a live view of the knowledge; ``triggers`` are the blocks that now begin to record, and
    ``actions`` is what blocks do.
    ``next_wake_ns`` is when time alone may next change the plan; it may come early, never late, and stepping
    later than it does no harm. ``None``: only observations can.
    """

    plan: Mapping[str, PlannedRate]
    decisions: tuple[Decision, ...]
    next_wake_ns: int | None
    triggers: tuple[Trigger, ...] = ()
    actions: tuple[ActionDecision, ...] = ()


def step(knowledge: Knowledge, observations: Sequence[Observation], now_ns: int) -> StepResult:
    """Take what was observed at ``now_ns``, then what time alone has changed by then.

    The first step makes the first plan, with a decision for every relayed topic. A clock that jumps back
    counts as one that stood still meanwhile (see ``SteadyTime``).
    """
    steady_ns = knowledge.time.advance(now_ns)
    readings = monitor(knowledge, observations, steady_ns)
    decisions = plan(knowledge, analyze(knowledge, readings, steady_ns), steady_ns)
    turned = tuple(turns(knowledge, steady_ns)) if knowledge.evaluator.has_acting else ()
    actions = tuple(act(knowledge, turned, steady_ns))
    return StepResult(
        plan=MappingProxyType(knowledge.plan),
        decisions=decisions,
        next_wake_ns=knowledge.next_wake_ns,
        triggers=tuple(turn for turn in turned if isinstance(turn, Trigger) and turn.block.recordings),
        actions=actions,
    )
