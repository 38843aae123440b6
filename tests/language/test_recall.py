# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is recalled of a text is what would be made of it, and little of it is made anew."""

from __future__ import annotations

from collections.abc import Sequence

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.language.recall import Recall

THINGS = tuple([number] for number in range(6))


def texts(longest: int) -> st.SearchStrategy[list[list[list[int]]]]:
    """Things of texts that follow each other; the same ones come often, as one object."""
    return st.lists(st.lists(st.sampled_from(THINGS), max_size=longest), min_size=2, max_size=6)


def pair(thing: list[int], number: int) -> tuple[int, int]:
    return thing[0], number


@given(texts(12), st.integers(0, 3))
def test_rows_that_are_recalled_have_the_values_that_they_would_be_given(
    texts: list[list[list[int]]], ahead: int
) -> None:
    recall = Recall()
    for things in texts:
        recall = Recall(recall)
        numbers = range(ahead, ahead + len(things))
        expected = [pair(*row) for row in zip(things, numbers, strict=True)]
        assert recall.each("pairs", pair, things, numbers) == expected
        assert recall.behind_change("pairs behind", pair, things, list(numbers)) == expected


@given(texts(200))
def test_runs_that_are_recalled_hold_all_things_in_their_order(texts: list[list[list[int]]]) -> None:
    recall = Recall()
    for things in texts:
        recall = Recall(recall)
        runs = recall.runs("runs", tuple, things)
        assert [thing for run in runs for thing in run] == things
        assert all(len(run) <= 64 for run in runs)


def test_of_many_things_few_runs_are_made_again_behind_one_that_comes_or_goes() -> None:
    made: list[int] = []

    def make(run: Sequence[list[int]]) -> int:
        made.append(len(run))
        return len(run)

    things = [[number] for number in range(5000)]
    recall = Recall()
    recall.runs("runs", make, things)
    for edit in range(300):
        made.clear()
        at = edit * 7 % 4000
        things = [*things[:at], [edit], *things[at:]] if edit % 3 else [*things[:at], *things[at + 1 :]]
        recall = Recall(recall)
        runs = recall.runs("runs", make, things)
        assert sum(runs) == len(things)
        assert sum(made) <= 128
    assert len(runs) < 300


def test_of_rows_only_those_that_differ_are_made_again() -> None:
    made: list[int] = []

    def make(thing: list[int]) -> int:
        made.append(thing[0])
        return thing[0]

    things = [[number] for number in range(1000)]
    recall = Recall()
    recall.each("rows", make, things)
    for edited in ([*things[:500], [-1], *things[500:]], [*things[:500], *things[501:]], things):
        made.clear()
        recall = Recall(recall)
        assert recall.each("rows", make, edited) == [thing[0] for thing in edited]
        assert len(made) <= 1
