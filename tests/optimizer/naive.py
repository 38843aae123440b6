# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""OBI as it is written down: all topics are added anew for every block, and every piece has its turn."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from smarttestudo.optimizer.model import Model, Requirement
from smarttestudo.optimizer.problem import Allocation, Demand, fits, round_down, used_kb_per_s
from smarttestudo.optimizer.requirements import RuleRequirements, Subproblem
from smarttestudo.optimizer.rule_rates import SolvedSubproblem, best_rates
from smarttestudo.optimizer.run_time import LARGE_SHARE, SMALL_SHARE


def gain(demands: Sequence[Demand], rates_hz: Mapping[str, float]) -> float:
    """What the rates are worth above everyone's lowest rate."""
    return math.fsum(_gain(demand, rates_hz[demand.topic]) for demand in demands)


def _gain(demand: Demand, rate_hz: float) -> float:
    gained, above_hz = 0.0, rate_hz - demand.least_hz
    for piece in demand.pieces:
        gained += piece.gain_per_hz * min(piece.width_hz, above_hz)
        above_hz = max(0.0, above_hz - piece.width_hz)
    return gained


def rates_of(model: Model, requirements: Sequence[Requirement], budget_kb_per_s: float) -> Allocation | None:
    bounds_hz = [one.bounds_hz(model) for one in requirements]
    return best_rates(model, requirements, bounds_hz, budget_kb_per_s)


def naive_allocate(demands: Sequence[Demand], budget_kb_per_s: float) -> Allocation | None:
    """Fill the pieces of equal gain per KB by one share, the best first."""
    rates_hz = {one.topic: one.least_hz for one in demands}
    least_kb_per_s = used_kb_per_s((one.size_kb, one.least_hz) for one in demands)
    if not fits(least_kb_per_s, budget_kb_per_s):
        return None
    left_kb_per_s = max(0.0, budget_kb_per_s - least_kb_per_s)
    pieces = [
        (float(f"{piece.gain_per_hz / one.size_kb:.12g}"), one, piece)
        for one in demands
        for piece in one.pieces
        if piece.gain_per_hz > 0 and piece.width_hz > 0
    ]
    for density in sorted({density for density, _, _ in pieces}, reverse=True):
        best = [(one, piece) for own, one, piece in pieces if own == density]
        cost = math.fsum(piece.width_hz * one.size_kb for one, piece in best)
        share = 1.0 if fits(cost, left_kb_per_s) else left_kb_per_s / cost
        for one, piece in best:
            rates_hz[one.topic] += share * piece.width_hz
        if share < 1.0:
            return Allocation(rates_hz=rates_hz, price=density)
        left_kb_per_s = max(0.0, left_kb_per_s - cost)
    return Allocation(rates_hz=rates_hz, price=0.0)


def naive_solve(
    requirements: RuleRequirements, budget_kb_per_s: float, model: Model
) -> list[SolvedSubproblem]:
    """The defaults, and each block beside what all other topics take by default."""
    asked = requirements.defaults.requirements
    defaults = _solve(requirements.defaults, 0.0, budget_kb_per_s, model)
    rates_hz = defaults.rates_hz or {name: one.bounds_hz(model)[0] for name, one in asked.items()}
    solved = [defaults]
    for block in requirements.blocks:
        beside = block.without_its_topics(rates_hz)
        others = used_kb_per_s((asked[name].needs.size_kb, hz) for name, hz in beside.items())
        solved.append(_solve(block, others, budget_kb_per_s, model))
    return solved


def _solve(block: Subproblem, others: float, budget_kb_per_s: float, model: Model) -> SolvedSubproblem:
    asked = block.requirements
    bounds_hz = {name: one.bounds_hz(model) for name, one in asked.items()}
    own_least = used_kb_per_s((asked[name].needs.size_kb, least) for name, (least, _) in bounds_hz.items())
    found = None
    if fits(others + own_least, budget_kb_per_s):
        left = max(budget_kb_per_s - others, own_least)
        if model is Model.MAXMIN:
            found = rates_of(model, [*asked.values()], left)
        else:
            found = naive_allocate([asked[name].demand(model, *bounds_hz[name]) for name in asked], left)
    rates_hz = None
    own = own_least
    if found is not None:
        rates_hz = {
            name: max(round_down(found.rates_hz[name]), least) for name, (least, _) in bounds_hz.items()
        }
        own = used_kb_per_s((asked[name].needs.size_kb, hz) for name, hz in rates_hz.items())
    return SolvedSubproblem(
        subproblem=block,
        rates_hz=rates_hz,
        others_kb_per_s=others,
        needs_kb_per_s=others + own_least,
        used_kb_per_s=others + own,
        model=model,
        price=found.price if found else 0.0,
    )


def small_kb_per_s(wanted: Sequence[float], budget: float) -> list[float]:
    """What gives way last of topics of one priority by what they want in KB/s: of one that is small, all."""
    return [
        0.0
        if (used := math.fsum(other for other in wanted if other <= one)) >= LARGE_SHARE * budget
        else one * min(1.0, (LARGE_SHARE - used / budget) / (LARGE_SHARE - SMALL_SHARE))
        for one in wanted
    ]
