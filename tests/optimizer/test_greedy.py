# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The greedy allocation, and its agreement with a linear program."""

from __future__ import annotations

import math

import highspy
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from optimizer.instances import demands
from optimizer.naive import gain
from smarttestudo.optimizer.problem import Demand, Piece, allocate, fits, used_kb_per_s


def demand(topic: str, size_kb: float, least_hz: float, *pieces: tuple[float, float]) -> Demand:
    return Demand(
        topic=topic, size_kb=size_kb, least_hz=least_hz, pieces=tuple(Piece(*piece) for piece in pieces)
    )


def test_gives_the_best_gain_per_kb_first() -> None:
    asked = [demand("/a", 2, 1, (10, 1)), demand("/b", 1, 0, (4, 1))]
    found = allocate(asked, 12)
    assert found is not None
    assert found.rates_hz == pytest.approx({"/a": 4, "/b": 4})
    assert gain(asked, found.rates_hz) == pytest.approx(7)
    assert found.price == pytest.approx(0.5)


def test_gives_everything_where_it_fits_exactly() -> None:
    found = allocate([demand("/a", 0.1, 0, (3, 1)), demand("/b", 0.2, 0, (3, 1))], 0.9)
    assert found is not None
    assert found.rates_hz == pytest.approx({"/a": 3, "/b": 3})


def test_takes_lowest_rates_that_meet_the_budget_exactly() -> None:
    found = allocate([demand(f"/{i}", 0.1, 1, (5, 1)) for i in range(3)], 0.3)
    assert found is not None
    assert found.rates_hz == pytest.approx({"/0": 1, "/1": 1, "/2": 1})


def test_has_no_answer_where_the_lowest_rates_do_not_fit() -> None:
    assert allocate([demand("/a", 2, 1)], 1.9) is None


def test_gives_nothing_for_a_budget_of_zero() -> None:
    found = allocate([demand("/a", 2, 0, (5, 1))], 0)
    assert found is not None
    assert found.rates_hz == {"/a": 0}


def test_does_not_spend_on_what_is_worth_nothing() -> None:
    found = allocate([demand("/a", 2, 1, (5, 0))], 100)
    assert found is not None
    assert found.rates_hz == {"/a": 1}
    assert found.price == 0


def test_knows_that_no_topics_fit_any_budget() -> None:
    found = allocate([], 0)
    assert found is not None
    assert found.rates_hz == {}


def test_equal_topics_share_what_is_left() -> None:
    found = allocate([demand(name, 3, 0, (8, 1)) for name in ("/b", "/a")], 24)
    assert found is not None
    assert found.rates_hz == {"/a": 4, "/b": 4}


@given(asked=demands(), share=st.floats(-0.1, 1.1))
@settings(max_examples=300)
# Over the budget by float noise before a piece that costs no more than that.
@example([demand("/t0", 1.0, 0.1, (1e-9, 0.5))], -0.0625)
def test_the_greedy_gain_is_that_of_a_linear_program(asked: list[Demand], share: float) -> None:
    least = used_kb_per_s((one.size_kb, one.least_hz) for one in asked)
    most = used_kb_per_s((one.size_kb, one.most_hz) for one in asked)
    budget = max(0.0, least + share * (most - least))
    found = allocate(asked, budget)
    assert (found is None) == (not fits(least, budget))
    if found is not None:
        assert math.isclose(
            gain(asked, found.rates_hz), best_gain(asked, budget - least), rel_tol=1e-7, abs_tol=1e-6
        )
        assert fits(used_kb_per_s((one.size_kb, found.rates_hz[one.topic]) for one in asked), budget)


def best_gain(asked: list[Demand], left_kb_per_s: float) -> float:
    """What the pieces can gain within what is left, by HiGHS."""
    pieces = [(one.size_kb, piece) for one in asked for piece in one.pieces]
    highs = highspy.Highs()  # type: ignore[no-untyped-call]
    highs.silent()
    highs.setOptionValue("primal_feasibility_tolerance", 1e-9)
    taken = [highs.addVariable(0, piece.width_hz) for _, piece in pieces]
    if not taken:
        return 0.0
    used = sum(size_kb * column for (size_kb, _), column in zip(pieces, taken, strict=True))
    highs.addConstr(used <= max(0.0, left_kb_per_s))
    highs.maximize(sum(piece.gain_per_hz * column for (_, piece), column in zip(pieces, taken, strict=True)))
    return float(highs.getInfo().objective_function_value)
