# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The thesis's golden case, digit for digit, at the level of topics and levels."""

from __future__ import annotations

import pytest

from optimizer import golden
from smarttestudo.domain.finding import Span
from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.model import Model, Requirement, needs_of
from smarttestudo.optimizer.requirements import RuleRequirements, Subproblem
from smarttestudo.optimizer.rule_rates import Optimization, solve_requirements

HERE = Span(line=1, column=1, end_line=1, end_column=2)


def subproblem(label: str | None, levels: dict[str, Tier]) -> Subproblem:
    requirements = {
        topic: Requirement(needs=needs_of(topic, golden.profile()), wanted=tier)
        for topic, tier in levels.items()
    }
    return Subproblem(
        label=label, path="rules.adirf", span=HERE, requirements=requirements, tier_statements=()
    )


def solved(budget_kb_per_s: float, block: dict[str, Tier]) -> Optimization:
    requirements = RuleRequirements(
        defaults=subproblem(None, dict.fromkeys(golden.DEFAULTS_HZ, Tier.UNACCEPTABLE)),
        blocks=(subproblem("block", block),),
        appended=(),
    )
    return solve_requirements(requirements, budget_kb_per_s, model=Model.QUPER)


def test_topics_without_a_level_get_the_top_of_unacceptable() -> None:
    assert solved(golden.AMPLE_KB_PER_S, {}).defaults.rates_hz == golden.DEFAULTS_HZ


def test_the_block_gets_200_and_35_hz_and_the_sum_is_the_thesis_s() -> None:
    (block,) = solved(
        golden.AMPLE_KB_PER_S, {"/imu": Tier.COMPETITIVE, "/camera/image_raw": Tier.EXCESSIVE}
    ).blocks
    assert block.rates_hz == {"/imu": 200, "/camera/image_raw": 35}
    assert block.used_kb_per_s == pytest.approx(219_881.72, abs=1e-9)


@pytest.mark.parametrize(
    ("level", "needed", "feasible"),
    [(Tier.EXCESSIVE, 157_665.72, False), (Tier.MARGINAL, 14_605.72, True)],
)
def test_within_15000_the_block_needs_what_the_design_says(
    level: Tier, needed: float, feasible: bool
) -> None:
    result = solved(golden.SCARCE_KB_PER_S, {"/imu": Tier.COMPETITIVE, "/camera/image_raw": level})
    (block,) = result.blocks
    assert block.needs_kb_per_s == pytest.approx(needed, abs=1e-9)
    assert block.feasible is feasible
