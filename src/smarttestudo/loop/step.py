# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One turn of the loop: monitor, analyze, plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from smarttestudo.domain.decision import Decision, PlannedRate
from smarttestudo.domain.observation import Observation
from smarttestudo.loop.analyze import analyze
from smarttestudo.loop.knowledge.knowledge import Knowledge
from smarttestudo.loop.monitor import monitor
from smarttestudo.loop.plan import plan
from smarttestudo.loop.triggers import Trigger, triggers


class StepResult(NamedTuple):
    """The plan of all relayed topics, what changed in it, and when to step next.

    ``plan`` is a live view of the knowledge; ``triggers`` are the blocks that now begin to record.
    ``next_wake_ns`` is when time alone may next change the plan; it may come early, never late, and stepping
    later than it does no harm. ``None``: only observations can.
    """

    plan: Mapping[str, PlannedRate]
    decisions: tuple[Decision, ...]
    next_wake_ns: int | None
    triggers: tuple[Trigger, ...] = ()


def step(knowledge: Knowledge, observations: Sequence[Observation], now_ns: int) -> StepResult:
    """Take what was observed at ``now_ns``, then what time alone has changed by then.

    The first step makes the first plan, with a decision for every relayed topic. A clock that jumps back
    counts as one that stood still meanwhile (see ``SteadyTime``).
    """
    steady_ns = knowledge.time.advance(now_ns)
    readings = monitor(knowledge, observations, steady_ns)
    decisions = plan(knowledge, analyze(knowledge, readings, steady_ns), steady_ns)
    return StepResult(
        plan=MappingProxyType(knowledge.plan),
        decisions=decisions,
        next_wake_ns=knowledge.next_wake_ns,
        triggers=tuple(triggers(knowledge, steady_ns)) if knowledge.evaluator.has_recordings else (),
    )
