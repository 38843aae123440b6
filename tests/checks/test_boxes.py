# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The search for boxes and the index over them."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarttestudo.domain.signal import Signal
from smarttestudo.language.boxes import (
    Box,
    BoxIndex,
    Effort,
    IndexEntry,
    TooComplexError,
    border_between,
    boxes_where,
    common_box,
    find_box,
    hull_of,
)
from smarttestudo.language.normal_form import Every, Form, InRegion, Some, holds, merged, negation
from smarttestudo.language.region import Region
from smarttestudo.language.syntax import Operator

SIGNALS = [Signal("/odom", name) for name in ("a", "b", "c")]
VALUES = [value / 2 for value in range(-1, 8)]
STATES = [dict(zip(SIGNALS, values, strict=True)) for values in itertools.product(VALUES, repeat=3)]

withins = st.builds(
    lambda signal, operator, value: InRegion(signal, Region.where(operator, value)),
    st.sampled_from(SIGNALS),
    st.sampled_from(list(Operator)),
    st.sampled_from([0.0, 1.0, 2.0, 3.0]),
)
forms: st.SearchStrategy[Form] = st.recursive(
    withins,
    lambda inner: st.builds(
        lambda join, parts: join(tuple(parts)),
        st.sampled_from([Every, Some]),
        st.lists(inner, min_size=2, max_size=3),
    ),
    max_leaves=6,
)


def everything(_: Signal) -> Region:
    return Region.everything()


def contains(box: Box, state: dict[Signal, float]) -> bool:
    return all(region.contains(state[signal]) for signal, region in box.items())


@given(forms)
@settings(max_examples=60)
def test_boxes_are_disjoint_and_together_all_states_where_a_form_holds(form: Form) -> None:
    boxes = list(boxes_where([form], everything, Effort(100_000)))
    for state in STATES:
        assert sum(contains(box, state) for box in boxes) == holds(form, state)


@given(forms)
@settings(max_examples=60)
def test_merging_and_double_negation_keep_the_meaning_and_negation_turns_it_round(form: Form) -> None:
    for state in STATES[::7]:
        assert holds(merged(form), state) == holds(form, state)
        assert holds(negation(form), state) != holds(form, state)
        assert holds(negation(negation(form)), state) == holds(form, state)


@given(forms)
@settings(max_examples=60)
def test_a_search_that_ran_out_of_effort_says_so_instead_of_guessing(form: Form) -> None:
    exact = find_box([form], everything, Effort(100_000))
    for looks in range(0, 40, 3):
        try:
            found = find_box([form], everything, Effort(looks))
        except TooComplexError:
            continue
        assert (found is None) == (exact is None)


def test_a_question_spends_what_all_questions_share() -> None:
    shared = Effort(10)
    Effort(8, shared).spend(7)
    with pytest.raises(TooComplexError):
        Effort(8, shared).spend(7)


def test_a_condition_with_a_thousand_million_cases_is_answered_at_once() -> None:
    above = Region.where(Operator.GREATER, 0)
    clauses = [
        Some((InRegion(Signal(f"/a{i}", "x"), above), InRegion(Signal(f"/b{i}", "x"), above)))
        for i in range(30)
    ]
    assert find_box([Every(tuple(clauses))], everything, Effort(50_000)) is not None


small = st.integers(0, 12).map(float)
intervals = st.tuples(small, small).map(
    lambda pair: Region.where(Operator.GREATER, min(pair)).intersection(
        Region.where(Operator.LESS, max(pair) + 1)
    )
)
half_lines = st.builds(Region.where, st.sampled_from([Operator.GREATER, Operator.LESS_EQUAL]), small)
boxes = st.dictionaries(st.sampled_from(SIGNALS), intervals | half_lines, max_size=3)


@given(st.lists(st.tuples(boxes, st.integers(0, 2)), max_size=60), boxes)
def test_the_index_finds_every_box_that_a_look_at_all_finds(
    entries: list[tuple[Box, int]], query: Box
) -> None:
    index = BoxIndex(
        [
            IndexEntry(owner=number, kind=kind, box=box, hull=hull_of(box))
            for number, (box, kind) in enumerate(entries)
        ]
    )
    near = [entry.owner for entry in index.near(hull_of(query).get, Effort(10_000), other_than=1)]
    assert len(near) == len(set(near))
    expected = {
        number
        for number, (box, kind) in enumerate(entries)
        if kind != 1 and (common_box(box, query) is not None or border_between(box, query) is not None)
    }
    assert expected <= set(near)


def test_a_query_among_ten_thousand_zones_looks_at_few() -> None:
    def zone(x: float, y: float) -> Box:
        return {
            signal: Region.where(Operator.GREATER, low).intersection(Region.where(Operator.LESS, low + 1))
            for signal, low in ((SIGNALS[0], x), (SIGNALS[1], y))
        }

    zones = [zone(x, y) for x in range(100) for y in range(100)]
    index = BoxIndex([IndexEntry(owner=i, kind=i, box=box, hull=hull_of(box)) for i, box in enumerate(zones)])
    looks = Effort(400)
    near = list(index.near(hull_of(zone(40.25, 60.25)).get, looks))
    assert {entry.owner for entry in near} == {x * 100 + y for x in (40, 41) for y in (60, 61)}


def test_boxes_meet_at_a_border_of_one_signal_and_not_at_a_corner() -> None:
    def square(x: float, y: float) -> Box:
        return {
            SIGNALS[0]: Region.where(Operator.GREATER, x).intersection(Region.where(Operator.LESS, x + 1)),
            SIGNALS[1]: Region.where(Operator.GREATER, y).intersection(Region.where(Operator.LESS, y + 1)),
        }

    border = border_between(square(0, 0), square(1, 0.5))
    assert border is not None
    assert (border.signal, border.value) == (SIGNALS[0], 1.0)
    assert border_between(square(0, 0), square(1, 1)) is None
    assert border_between(square(0, 0), square(1.5, 0)) is None
    assert border_between(square(0, 0), square(0.5, 0)) is None


def test_the_hull_of_a_box_leaves_out_what_is_not_bounded() -> None:
    hull = hull_of(
        {SIGNALS[0]: Region.where(Operator.NOT_EQUAL, 3), SIGNALS[1]: Region.where(Operator.LESS, 3)}
    )
    assert hull == {SIGNALS[1]: (-math.inf, 3)}


def test_a_query_after_the_effort_is_spent_looks_at_one_node() -> None:
    boxes: list[Box] = [
        {Signal(f"/topic_{i}", "x"): Region.where(Operator.GREATER, 1.0)} for i in range(1000)
    ]
    index = BoxIndex([IndexEntry(owner=i, kind=i, box=box, hull=hull_of(box)) for i, box in enumerate(boxes)])
    asked: list[Signal] = []

    def interval_of(signal: Signal) -> tuple[float, float]:
        asked.append(signal)
        return 0.0, 0.0

    effort = Effort(3)
    for _ in range(2):
        with pytest.raises(TooComplexError):
            list(index.near(interval_of, effort))
    assert len(asked) <= 3 + 8
