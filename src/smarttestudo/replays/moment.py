# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The reason of a topic's rate at one moment of a run or of a recording."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.domain.action import ActionDecision
from smarttestudo.domain.decision import (
    AnyDecision,
    Decision,
    PlannedRate,
    about_actions,
    about_rates,
    decision_from_json,
)
from smarttestudo.domain.errors import RecordingError, UsageError
from smarttestudo.domain.names import DECISIONS_TOPIC, is_own_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.signal import Signal, Value
from smarttestudo.domain.units import utc_time
from smarttestudo.language.evaluator import ExplainedValue, explain, explain_block
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop.block_states import values_in
from smarttestudo.loop.decision_log import with_run_starts
from smarttestudo.loop.inputs import WakeInput
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.pacing.cdr import string_text

if TYPE_CHECKING:
    from smarttestudo.domain.recording import Channel, RecordingReader

AtNs = Callable[[int, int, int], int]
"""The moment that is asked for: by the first stamp, that from which seconds count, and the last one."""

_NAMED = 8
_DECISIONS_REMEDY = "give a file of --decisions, a recording of /testudo/decisions, or the rules with --rules"


@dataclass(frozen=True, slots=True, kw_only=True)
class RateReason:
    """The rate of a topic at one moment, with its reason.

    ``asked`` is what the rules ask for, where all that they read is known: a budget, a link or the time to
    settle may give another rate. ``decision`` is the last one before, if it is known. Without ``asked``,
    ``values`` are those of the decision, and their borders those where its rule no longer holds.
    """

    topic: str
    planned: PlannedRate
    asked: PlannedRate | None = None
    decision: Decision | None = None
    values: tuple[ExplainedValue, ...] = ()


def reason_by_rules(
    rule_set: RuleSet,
    topic: str,
    planned: PlannedRate,
    values: Mapping[Signal, Value | None],
    decision: Decision | None = None,
) -> RateReason:
    """Why ``topic`` has the ``planned`` rate, by the rules in force and the values that they read."""
    explained = explain(rule_set, topic, values)
    return RateReason(
        topic=topic, planned=planned, asked=explained.request, decision=decision, values=explained.values
    )


def reason_in_replay(
    recording: RecordingReader,
    topic: str,
    at_ns: int,
    *,
    rule_set: RuleSet,
    profile: Profile,
    budget_kb_per_s: float | None,
) -> RateReason:
    """Why ``topic`` has its rate at ``at_ns`` of a replay of ``recording``. Raises ``RecordingError``."""
    from smarttestudo.bags.type_definitions import rules_for  # noqa: PLC0415  needs packages a robot lacks
    from smarttestudo.replays.replay import ReplayRequest, replay  # noqa: PLC0415  as above

    rule_set = rules_for(rule_set, recording.channels)
    require_relayed(topic, rule_set.relayed)
    decisions: list[Decision] = []
    reasons: list[RateReason] = []
    replay(
        ReplayRequest(
            recording=recording,
            rule_set=rule_set,
            profile=profile,
            output=None,
            budget_kb_per_s=budget_kb_per_s,
            decided=decisions.extend,
            until_ns=at_ns,
            ended=lambda end_ns, loop: reasons.append(_reason_of_loop(loop, topic, end_ns, decisions)),
        )
    )
    return reasons[0]


def reason_in_inputs(folder: Path, topic: str, at_ns: int) -> RateReason:
    """Why ``topic`` had its rate at ``at_ns`` of the run that recorded its inputs in ``folder``."""
    from smarttestudo.replays.inputs import replay_inputs  # noqa: PLC0415  as above

    decisions: list[Decision] = []
    reasons: list[RateReason] = []
    replay_inputs(
        folder,
        lambda decided: decisions.extend(about_rates(decided)),
        until_ns=at_ns,
        ended=lambda end_ns, loop: reasons.append(_reason_of_loop(loop, topic, end_ns, decisions)),
    )
    return reasons[0]


def _reason_of_loop(loop: RelayLoop, topic: str, now_ns: int, decisions: list[Decision]) -> RateReason:
    loop.handle(WakeInput(stamp_ns=now_ns))
    knowledge = loop.knowledge
    require_relayed(topic, knowledge.rule_set.relayed)
    decisions.extend(loop.take_decisions())
    return reason_by_rules(
        knowledge.rule_set,
        topic,
        knowledge.plan[topic],
        values_in(loop.block_states(now_ns), knowledge.rule_set),
        next((one for one in reversed(decisions) if one.topic == topic), None),
    )


def reason_in_decisions(
    decisions: Sequence[tuple[int, Decision]], topic: str, at: AtNs, rule_set: RuleSet | None, place: str
) -> RateReason:
    """Why ``topic`` had its rate by the last decision before; each comes with when it was known.

    ``rule_set`` has the borders of its values. Raises ``RecordingError`` where nothing was decided by then.
    """
    if not decisions:
        raise RecordingError("it has no decisions", place=place, remedy=_DECISIONS_REMEDY)
    starts = [began_ns for began_ns, _ in with_run_starts(one for _, one in decisions)]
    at_ns = at(decisions[0][0], decisions[starts.index(starts[-1])][0], decisions[-1][0])
    require_relayed(topic, dict.fromkeys(one.topic for _, one in decisions))
    runs = [began_ns for began_ns, (known_ns, _) in zip(starts, decisions, strict=True) if known_ns <= at_ns]
    mine = [
        one
        for began_ns, (known_ns, one) in zip(starts, decisions, strict=True)
        if one.topic == topic and known_ns <= at_ns and began_ns == runs[-1]
    ]
    if not mine:
        cause = f"nothing was decided of {topic} by {utc_time(at_ns)}"
        raise RecordingError(
            cause, place=place, remedy=f"the first decision is of {utc_time(decisions[0][0])}"
        )
    decision = mine[-1]
    planned = decision.planned
    named = {str(signal): signal for signal in (rule_set.signals if rule_set is not None else ())}
    values = {named.get(name, Signal.named(name)): value for name, value in decision.values.items()}
    explained: tuple[ExplainedValue, ...] = ()
    if rule_set is not None and planned.rule is not None and planned.line is not None:
        explained = explain_block(rule_set, planned.rule, planned.line, values)
    known = tuple(ExplainedValue(signal=one, value=value, borders=()) for one, value in values.items())
    return RateReason(topic=topic, planned=planned, decision=decision, values=explained or known)


def actions_at(decisions: Sequence[AnyDecision], name: str, at: AtNs) -> list[ActionDecision]:
    """The last ``_NAMED`` events of actions on the node or service ``name`` by that time."""
    own = [one for one in about_actions(decisions) if one.action.target == name]
    if not own:
        return []
    at_ns = at(decisions[0].stamp_ns, decisions[0].stamp_ns, decisions[-1].stamp_ns)
    return [one for one in own if one.stamp_ns <= at_ns][-_NAMED:]


def recorded_decisions(recording: RecordingReader) -> list[tuple[int, AnyDecision]]:
    """The decisions that a recording has on ``/testudo/decisions``, with the stamps of their messages.

    Each counts once: a link sends the last ones again after an outage. Raises ``RecordingError`` for a
    recording with those of several robots, which nothing tells apart.
    """
    topics = sorted({one.topic for one in recording.channels if _has_decisions(one)})
    if len(topics) > 1:
        raise RecordingError(
            "it has the decisions of several robots", place=", ".join(topics), remedy=_DECISIONS_REMEDY
        )
    decisions: dict[str, tuple[int, AnyDecision]] = {}
    for _, stamp_ns, payload in recording.messages(topics) if topics else ():
        text = string_text(payload) or ""
        with suppress(ValueError, RecursionError):
            decisions.setdefault(text, (stamp_ns, decision_from_json(json.loads(text))))
    return [*decisions.values()]


def _has_decisions(channel: Channel) -> bool:
    return channel.topic.endswith(DECISIONS_TOPIC) and is_own_topic(channel.topic, channel.type_name)


def require_relayed(topic: str, relayed: Iterable[str]) -> None:
    """Raise ``UsageError`` for a topic that is not among those that rules relay."""
    names = [*relayed]
    if topic not in names:
        near = get_close_matches(topic, names, n=1)
        remedy = f"did you mean {near[0]}?" if near else f"there are {', '.join(names[:_NAMED]) or 'none'}"
        raise UsageError("no rule relays it", place=topic, remedy=remedy)
