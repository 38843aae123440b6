# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""OBI over many blocks against the naive one, to the last digit."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache

from hypothesis import given, settings
from hypothesis import strategies as st

from optimizer.instances import accuracy_tiers, entries
from optimizer.naive import naive_solve
from smarttestudo.domain.finding import Span
from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.model import BoundNeeds, Model, Requirement, TopicNeeds
from smarttestudo.optimizer.problem import exact_sum, used_kb_per_s
from smarttestudo.optimizer.requirements import RuleRequirements, Subproblem
from smarttestudo.optimizer.rule_rates import solve_requirements

HERE = Span(line=1, column=1, end_line=1, end_column=2)
levels = st.sampled_from(list(Tier)) | st.sampled_from([0.0, 0.3, 10.0])


def subproblem(requirements: Mapping[str, Requirement], kept: Mapping[str, float]) -> Subproblem:
    return Subproblem(
        label="block", path="", span=HERE, requirements=requirements, tier_statements=(), kept=kept
    )


@cache
@st.composite
def needs(draw: st.DrawFn) -> dict[str, TopicNeeds | BoundNeeds]:
    """A few topics; the last of some counts by two bounds."""
    topics = [
        TopicNeeds(topic=f"/t{index}", entry=draw(entries()), floor_hz=0.0, profile_path="")
        for index in range(draw(st.integers(1, 5)))
    ]
    found: dict[str, TopicNeeds | BoundNeeds] = {one.topic: one for one in topics}
    if draw(st.booleans()):
        last = topics[-1]
        del found[last.topic]
        for name in ("position", "orientation"):
            bound = BoundNeeds(
                of_topic=last, property_name=name, accuracy=draw(accuracy_tiers()), limit_hz=50.0
            )
            found[bound.name] = bound
    return found


@cache
@st.composite
def rule_requirements(draw: st.DrawFn) -> RuleRequirements:
    """Defaults of all, and blocks of some; of bounds a block may keep one."""
    known = draw(needs())
    defaults = {name: Requirement(needs=one, wanted=draw(levels)) for name, one in known.items()}
    blocks = []
    for _ in range(draw(st.integers(0, 4))):
        chosen = draw(st.sets(st.sampled_from(sorted(known))))
        asked, kept = {}, {}
        for name in sorted(chosen):
            if isinstance(known[name], BoundNeeds) and draw(st.booleans()):
                kept[name] = draw(st.sampled_from([0.0, 1.0, 50.0]))
            else:
                asked[name] = Requirement(needs=known[name], wanted=draw(levels))
        blocks.append(subproblem(asked, kept))
    return RuleRequirements(defaults=subproblem(defaults, {}), blocks=tuple(blocks), appended=())


@given(
    asked=rule_requirements(),
    model=st.sampled_from(Model),
    share=st.sampled_from([0.0, 1.0]) | st.floats(0, 2),
)
@settings(max_examples=300)
def test_every_block_gets_what_the_naive_way_gives_it(
    asked: RuleRequirements, model: Model, share: float
) -> None:
    bounds_hz = [(one.needs.size_kb, one.bounds_hz(model)) for one in asked.defaults.requirements.values()]
    least = used_kb_per_s((size_kb, low) for size_kb, (low, _) in bounds_hz)
    most = used_kb_per_s((size_kb, high) for size_kb, (_, high) in bounds_hz)
    budget = least + share * (most - least)
    found = solve_requirements(asked, budget, model=model)
    assert [*found.subproblems] == naive_solve(asked, budget, model)


numbers = st.floats(-1e9, 1e9) | st.sampled_from([0.1, 0.2, 1e-9, 1e15, 6220.8])


@given(values=st.lists(numbers, max_size=40), taken=st.sets(st.integers(0, 39)))
@settings(max_examples=500)
def test_a_sum_without_some_is_rounded_as_if_the_others_had_been_added(
    values: list[float], taken: set[int]
) -> None:
    others = [value for index, value in enumerate(values) if index not in taken]
    left = [-value for index, value in enumerate(values) if index in taken]
    assert math.fsum([*exact_sum(values), *left]) == math.fsum(others)
