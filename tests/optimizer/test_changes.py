# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The smallest changes that make everything fit, against trying them all."""

from __future__ import annotations

import itertools
from functools import cache

from hypothesis import given, settings
from hypothesis import strategies as st

from optimizer.instances import requirement
from smarttestudo.domain.profile import TopicProfile
from smarttestudo.domain.rate import Tier
from smarttestudo.domain.source import Span
from smarttestudo.optimizer.changes import Change, Reduction, smallest_changes
from smarttestudo.optimizer.greedy import GreedySolver
from smarttestudo.optimizer.model import Model
from smarttestudo.optimizer.problem import fits
from smarttestudo.optimizer.requirements import Subproblem
from smarttestudo.optimizer.rule_rates import SolvedSubproblem, solve_subproblem
from smarttestudo.optimizer.solver.highs_solver import HighsChangeFinder

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
def test_the_changes_found_are_the_smallest_ones_in_order(options: list[Reduction], excess: int) -> None:
    enough = [
        chosen for chosen in every_choice(options) if sum(one.saved_kb_per_s for one in chosen) >= excess
    ]
    found = HighsChangeFinder().smallest(options, float(excess), 3)
    assert bool(found) == bool(enough)
    expected: list[set[str]] = []
    for chosen in found:
        open_to = [
            one for one in enough if not any(used <= {part.topic for part in one} for used in expected)
        ]
        assert chosen in open_to
        assert size(chosen) == min(map(size, open_to))
        expected.append({one.topic for one in chosen})


def changes_for(wanted: dict[str, Tier | float], budget: float) -> list[Change]:
    entry = TopicProfile(message_kb=1.0, tiers_hz=(10, 20, 30, 40, 50, 60))
    subproblem = Subproblem(
        label="block",
        path="rules.adirf",
        span=HERE,
        requirements={topic: requirement(topic, entry, one) for topic, one in wanted.items()},
        tier_statements=(),
    )
    solved: SolvedSubproblem = solve_subproblem(
        subproblem, 0.0, budget, model=Model.QUPER, solver=GreedySolver()
    )
    return smallest_changes(solved, budget, model=Model.QUPER, finder=HighsChangeFinder())


def shown(change: Change) -> dict[str, Tier | float]:
    return {one.topic: one.wanted for one in change.reductions}


def test_a_number_is_lowered_to_what_just_fits() -> None:
    (change,) = changes_for({"/a": 33.0}, 30.0)
    assert shown(change) == {"/a": 30.0}
    assert fits(change.needs_kb_per_s, 30.0)


def test_several_topics_are_lowered_where_one_is_not_enough() -> None:
    change, *_ = changes_for({"/a": Tier.DESIRABLE, "/b": Tier.DESIRABLE, "/c": Tier.MARGINAL}, 35.0)
    assert shown(change) == {"/a": Tier.MARGINAL, "/b": Tier.MARGINAL}
    assert change.needs_kb_per_s == 30.0


def test_three_changes_are_shown_however_many_would_do() -> None:
    changes = changes_for({f"/{letter}": Tier.DESIRABLE for letter in "abcde"}, 90.0)
    assert len(changes) == 3
    assert len({topic for change in changes for topic in shown(change)}) == 3


def test_nothing_is_proposed_where_nothing_fits() -> None:
    entry = TopicProfile(message_kb=1.0, tiers_hz=(10, 20, 30, 40, 50, 60), min_hz=5.0)
    subproblem = Subproblem(
        label="block",
        path="",
        span=HERE,
        requirements={"/a": requirement("/a", entry, Tier.MARGINAL)},
        tier_statements=(),
    )
    solved = solve_subproblem(subproblem, 0.0, 4.0, model=Model.QUPER, solver=GreedySolver())
    assert smallest_changes(solved, 4.0, model=Model.QUPER, finder=HighsChangeFinder()) == []
