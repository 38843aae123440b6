# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The smallest change that makes everything fit, against trying them all."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import cache

import highspy
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimizer.instances import requirement
from smarttestudo.domain.finding import Span
from smarttestudo.domain.profile import TopicProfile
from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.explanation import Change, Reduction
from smarttestudo.optimizer.model import Model
from smarttestudo.optimizer.problem import fits
from smarttestudo.optimizer.requirements import Subproblem
from smarttestudo.optimizer.rule_rates import SolvedSubproblem, solve_subproblem
from smarttestudo.optimizer.solver import smallest, smallest_change

HERE = Span(line=1, column=1, end_line=1, end_column=2)

Size = tuple[int, int]
"""Topics and squared steps."""


@cache
@st.composite
def reductions(draw: st.DrawFn) -> list[Reduction]:
    """Up to six topics with up to three rising reductions each; some topics save as much as others."""
    found = []
    savings_kb = st.integers(1, 6) | st.integers(1, 50)
    for topic in range(draw(st.integers(1, 6))):
        savings = sorted(draw(st.lists(savings_kb, min_size=1, max_size=3, unique=True)))
        found += [
            Reduction(topic=f"/t{topic}", wanted=Tier.MARGINAL, steps=steps, saved_kb_per_s=float(saved))
            for steps, saved in enumerate(savings, start=1)
        ]
    return found


def every_choice(options: list[Reduction]) -> list[tuple[Reduction, ...]]:
    topics = {one.topic for one in options}
    per_topic = [[None, *(one for one in options if one.topic == topic)] for topic in sorted(topics)]
    return [tuple(one for one in chosen if one) for chosen in itertools.product(*per_topic)]


def size(chosen: tuple[Reduction, ...]) -> Size:
    return len(chosen), sum(one.steps**2 for one in chosen)


@given(options=reductions(), excess=st.integers(1, 120))
@settings(max_examples=200)
def test_the_change_found_is_the_smallest_one(options: list[Reduction], excess: int) -> None:
    enough = [
        chosen for chosen in every_choice(options) if sum(one.saved_kb_per_s for one in chosen) >= excess
    ]
    found = smallest(options, float(excess))
    assert (found is None) == (not enough)
    if found is not None:
        assert found in enough
        assert size(found) == min(map(size, enough))


@pytest.fixture
def highs_of_two_threads() -> Iterator[None]:
    """HiGHS as other code in the same process, say a notebook, may leave it."""
    highspy.Highs.resetGlobalScheduler(True)
    other = highspy.Highs()  # type: ignore[no-untyped-call]
    other.silent()
    other.setOptionValue("threads", 2)
    other.maximize(other.addVariable(0, 1))
    yield
    highspy.Highs.resetGlobalScheduler(True)


@pytest.mark.usefixtures("highs_of_two_threads")
def test_other_code_may_have_given_highs_more_threads() -> None:
    change = change_for({"/a": 33.0}, 30.0)
    assert change is not None
    assert shown(change) == {"/a": 30.0}


def change_for(wanted: dict[str, Tier | float], budget: float) -> Change | None:
    entry = TopicProfile(message_kb=1.0, tiers_hz=(10, 20, 30, 40, 50, 60))
    subproblem = Subproblem(
        label="block",
        path="rules.adirf",
        span=HERE,
        requirements={topic: requirement(topic, entry, one) for topic, one in wanted.items()},
        tier_statements=(),
    )
    solved: SolvedSubproblem = solve_subproblem(subproblem, 0.0, budget, model=Model.QUPER)
    return smallest_change(solved, budget, model=Model.QUPER)


def shown(change: Change) -> dict[str, Tier | float]:
    return {one.topic: one.wanted for one in change.reductions}


def test_a_number_is_lowered_to_what_just_fits() -> None:
    change = change_for({"/a": 33.0}, 30.0)
    assert change is not None
    assert shown(change) == {"/a": 30.0}
    assert fits(change.needs_kb_per_s, 30.0)


def test_several_topics_are_lowered_where_one_is_not_enough() -> None:
    change = change_for({"/a": Tier.DESIRABLE, "/b": Tier.DESIRABLE, "/c": Tier.MARGINAL}, 35.0)
    assert change is not None
    assert shown(change) == {"/a": Tier.MARGINAL, "/b": Tier.MARGINAL}
    assert change.needs_kb_per_s == 30.0


def test_nothing_is_proposed_where_nothing_fits() -> None:
    entry = TopicProfile(message_kb=1.0, tiers_hz=(10, 20, 30, 40, 50, 60), min_hz=5.0)
    subproblem = Subproblem(
        label="block",
        path="",
        span=HERE,
        requirements={"/a": requirement("/a", entry, Tier.MARGINAL)},
        tier_statements=(),
    )
    solved = solve_subproblem(subproblem, 0.0, 4.0, model=Model.QUPER)
    assert smallest_change(solved, 4.0, model=Model.QUPER) is None
