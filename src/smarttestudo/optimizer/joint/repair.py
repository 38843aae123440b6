# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates with which the situations that break the budget would fit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.decision import Reason
from smarttestudo.language.evaluator import Evaluator
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.optimizer.joint.check import Loads, Situation
from smarttestudo.optimizer.problem import Budget, Demand, Piece, Solver, round_down

_NOISE_HZ = 1e-6


@dataclass(frozen=True, slots=True, order=True)
class Setting:
    """The rate that a block, by order, or the default (-1) sets a topic to."""

    order: int
    topic: str

    @property
    def key(self) -> str:
        """The setting's name in a problem."""
        return f"{self.order} {self.topic}"


@dataclass(slots=True)
class _Use:
    """A setting's rate now, and the lowest at which it still decides wherever it does."""

    rate_hz: float
    least_hz: float


@dataclass(slots=True)
class _Settings:
    """``situations`` are the settings that decide in each, and what the topics take that no rate decides."""

    uses: dict[Setting, _Use] = field(default_factory=dict)
    situations: list[tuple[set[str], float]] = field(default_factory=list)


def lowered_rates(
    rule_set: RuleSet,
    loads: Loads,
    situations: Sequence[Situation],
    topics: Iterable[str],
    budget_kb_per_s: float,
    *,
    priorities: Mapping[str, float],
    solver: Solver,
) -> dict[Setting, float] | None:
    """The settings to lower, with rates in Hz, so that all ``situations`` fit; ``None`` where none do.

    Of all such rates, the sum weighted by priority is the greatest: one budget for each situation over the
    settings that decide in it. Each setting stays at or above the others that hold beside it, so that it goes
    on deciding; elsewhere lower rates take no more. ``topics`` are those whose loads the situations count.
    """
    settings = _deciding(rule_set, loads, situations, list(topics))
    demands = [
        Demand(
            topic=setting.key,
            size_kb=loads.size_kb[setting.topic],
            least_hz=use.least_hz,
            pieces=(Piece(use.rate_hz - use.least_hz, priorities.get(setting.topic, 1.0)),),
        )
        for setting, use in sorted(settings.uses.items())
    ]
    budgets = [
        Budget(limit_kb_per_s=budget_kb_per_s - fixed_kb_per_s, topics=frozenset(keys))
        for keys, fixed_kb_per_s in settings.situations
    ]
    found = solver.allocate(demands, budgets)
    if found is None:
        return None
    return {
        setting: max(round_down(found.rates_hz[setting.key]), use.least_hz)
        for setting, use in sorted(settings.uses.items())
        if found.rates_hz[setting.key] < use.rate_hz - _NOISE_HZ
    }


def _deciding(
    rule_set: RuleSet, loads: Loads, situations: Sequence[Situation], topics: Sequence[str]
) -> _Settings:
    evaluator = Evaluator(rule_set)
    settings = _Settings()
    for situation in situations:
        for signal, value in situation.state.items():
            evaluator.set(signal, value)
        keys: set[str] = set()
        fixed_kb_per_s = 0.0
        for topic in topics:
            request = evaluator.decide(topic)
            rate_hz = loads.ceiling_hz(topic, request.planned.rate)
            if loads.needed_hz(topic, request.planned) < rate_hz:
                # It takes what its bounds need, and no lower rate changes that without breaking them.
                fixed_kb_per_s += loads.kb_per_s(topic, request.planned)
                continue
            setting = Setting(-1 if request.block is None else request.block, topic)
            # What a floor decides cannot go lower.
            is_fixed = request.planned.reason is Reason.FLOOR
            least_hz = rate_hz if is_fixed else min(rate_hz, _beside(rule_set, situation, setting))
            use = settings.uses.setdefault(setting, _Use(rate_hz, least_hz))
            use.least_hz = max(use.least_hz, least_hz)
            keys.add(setting.key)
        settings.situations.append((keys, fixed_kb_per_s))
    return settings


def _beside(rule_set: RuleSet, situation: Situation, setting: Setting) -> float:
    """The highest rate that would decide the topic if ``setting`` did not."""
    rates = [rule_set.floors_hz.get(setting.topic, 0.0)]
    if setting.order >= 0:
        priority = rule_set.blocks[setting.order].priority
        rates += [
            block.rates[setting.topic].hz
            for block in situation.blocks
            if block.order != setting.order and block.priority == priority and setting.topic in block.rates
        ]
    return max(rates)
