# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Requests to effective rates, with the decisions that this makes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from smarttestudo.domain.decision import Decision, Reason
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.evaluator import RequestedRate
from smarttestudo.loop.knowledge.knowledge import Knowledge, Settling
from smarttestudo.loop.knowledge.settling_bounds import SettlingBounds


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
    settling = knowledge.settling.get(topic)
    if settling is None:
        knowledge.settling[topic] = Settling(request, knowledge.settle_ns)
    else:
        settling.on_request(request, now_ns)
    bounds = knowledge.settling_bounds.get(topic)
    if bounds is None:
        knowledge.settling_bounds[topic] = SettlingBounds(request.planned, knowledge.settle_ns)
    else:
        bounds.on_request(request.planned, now_ns)


def _settle(knowledge: Knowledge, topic: str, now_ns: int) -> bool:
    """Whether another rate, or other bounds, have settled for ``topic``."""
    settling = knowledge.settling[topic]
    before, after = knowledge.settled.get(topic), settling.effective(now_ns)
    bounds = knowledge.settling_bounds[topic]
    planned = bounds.effective(after.planned, now_ns)
    if planned is not after.planned:
        after = replace(after, planned=planned)
    times_ns = (settling.next_change_ns, bounds.next_change_ns)
    next_ns = min((at_ns for at_ns in times_ns if at_ns is not None), default=None)
    knowledge.settle_alarms.set(topic, next_ns)
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
