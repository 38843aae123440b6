# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One contract for every solver, and their agreement."""

from __future__ import annotations

import math
from collections.abc import Iterator

import highspy
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from optimizer.instances import demands
from optimizer.naive import gain
from smarttestudo.optimizer.greedy import GreedySolver
from smarttestudo.optimizer.problem import Budget, Demand, Piece, Solver, fits, used_kb_per_s
from smarttestudo.optimizer.solver.highs_solver import HighsSolver


def demand(topic: str, size_kb: float, least_hz: float, *pieces: tuple[float, float]) -> Demand:
    return Demand(
        topic=topic, size_kb=size_kb, least_hz=least_hz, pieces=tuple(Piece(*piece) for piece in pieces)
    )


def whole(limit_kb_per_s: float) -> list[Budget]:
    return [Budget(limit_kb_per_s=limit_kb_per_s)]


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
    found = HighsSolver().allocate([demand("/a", 1, 0, (10, 1))], whole(4))
    assert found is not None
    assert found.rates_hz == pytest.approx({"/a": 4})


@pytest.mark.parametrize("solver", [GreedySolver(), HighsSolver()], ids=["greedy", "highs"])
class TestEverySolver:
    def test_gives_the_best_gain_per_kb_first(self, solver: Solver) -> None:
        asked = [demand("/a", 2, 1, (10, 1)), demand("/b", 1, 0, (4, 1))]
        found = solver.allocate(asked, whole(12))
        assert found is not None
        assert found.rates_hz == pytest.approx({"/a": 4, "/b": 4})
        assert gain(asked, found.rates_hz) == pytest.approx(7)
        assert found.price == pytest.approx(0.5)

    def test_gives_everything_where_it_fits_exactly(self, solver: Solver) -> None:
        found = solver.allocate([demand("/a", 0.1, 0, (3, 1)), demand("/b", 0.2, 0, (3, 1))], whole(0.9))
        assert found is not None
        assert found.rates_hz == pytest.approx({"/a": 3, "/b": 3})

    def test_takes_lowest_rates_that_meet_the_budget_exactly(self, solver: Solver) -> None:
        found = solver.allocate([demand(f"/{i}", 0.1, 1, (5, 1)) for i in range(3)], whole(0.3))
        assert found is not None
        assert found.rates_hz == pytest.approx({"/0": 1, "/1": 1, "/2": 1})

    def test_has_no_answer_where_the_lowest_rates_do_not_fit(self, solver: Solver) -> None:
        assert solver.allocate([demand("/a", 2, 1)], whole(1.9)) is None

    def test_gives_nothing_for_a_budget_of_zero(self, solver: Solver) -> None:
        found = solver.allocate([demand("/a", 2, 0, (5, 1))], whole(0))
        assert found is not None
        assert found.rates_hz == {"/a": 0}

    def test_does_not_spend_on_what_is_worth_nothing(self, solver: Solver) -> None:
        found = solver.allocate([demand("/a", 2, 1, (5, 0))], whole(100))
        assert found is not None
        assert found.rates_hz == {"/a": 1}
        assert found.price == 0

    def test_knows_that_no_topics_fit_any_budget(self, solver: Solver) -> None:
        found = solver.allocate([], whole(0))
        assert found is not None
        assert found.rates_hz == {}


def test_highs_keeps_several_budgets_at_once() -> None:
    asked = [demand("/a", 1, 0, (10, 2)), demand("/b", 1, 0, (10, 1))]
    budgets = [Budget(limit_kb_per_s=12), Budget(limit_kb_per_s=3, topics=frozenset({"/a"}))]
    found = HighsSolver().allocate(asked, budgets)
    assert found is not None
    assert found.rates_hz == pytest.approx({"/a": 3, "/b": 9})
    assert gain(asked, found.rates_hz) == pytest.approx(15)


def test_the_greedy_solver_refuses_several_budgets() -> None:
    with pytest.raises(ValueError, match="one budget"):
        GreedySolver().allocate([], [*whole(1), *whole(2)])


def test_equal_topics_share_what_is_left() -> None:
    found = GreedySolver().allocate([demand(name, 3, 0, (8, 1)) for name in ("/b", "/a")], whole(24))
    assert found is not None
    assert found.rates_hz == {"/a": 4, "/b": 4}


@given(asked=demands(), share=st.floats(-0.1, 1.1))
@settings(max_examples=300)
# Over the budget by float noise before a piece that costs no more than that.
@example([demand("/t0", 1.0, 0.1, (1e-9, 0.5))], -0.0625)
def test_greedy_and_highs_find_the_same_gain(asked: list[Demand], share: float) -> None:
    least = used_kb_per_s((one.size_kb, one.least_hz) for one in asked)
    most = used_kb_per_s((one.size_kb, one.most_hz) for one in asked)
    budget = whole(max(0.0, least + share * (most - least)))
    greedy, highs = GreedySolver().allocate(asked, budget), HighsSolver().allocate(asked, budget)
    assert (greedy is None) == (highs is None)
    if greedy is not None and highs is not None:
        gains = [gain(asked, one.rates_hz) for one in (greedy, highs)]
        assert math.isclose(*gains, rel_tol=1e-7, abs_tol=1e-6)
        used = used_kb_per_s((one.size_kb, greedy.rates_hz[one.topic]) for one in asked)
        assert fits(used, budget[0].limit_kb_per_s)
