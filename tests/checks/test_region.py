# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Regions as sets of floating-point numbers."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from smarttestudo.language.region import Region
from smarttestudo.language.syntax import Operator

numbers = st.sampled_from([0.0, 1.0, math.nextafter(1.0, 2.0), -2.5, 1e300, 5e-324]) | st.floats(
    allow_nan=False, allow_infinity=False
)
probes = numbers | st.sampled_from([math.inf, -math.inf])
comparisons = st.tuples(st.sampled_from(list(Operator)), numbers).map(lambda pair: Region.where(*pair))
regions = st.recursive(
    comparisons,
    lambda inner: (
        st.tuples(inner, inner).map(lambda pair: pair[0].intersection(pair[1]))
        | st.tuples(inner, inner).map(lambda pair: pair[0].union(pair[1]))
        | inner.map(Region.complement)
    ),
    max_leaves=6,
)


def ends(*all_regions: Region) -> list[float]:
    """The numbers at which membership can change, with their neighbours."""
    cuts = {value for region in all_regions for value, _ in region.cuts} | {0.0, math.inf, -math.inf}
    return [
        near
        for value in cuts
        for near in (value, math.nextafter(value, math.inf), math.nextafter(value, -math.inf))
    ]


@given(regions, regions, probes)
def test_regions_combine_as_sets_do(first: Region, second: Region, probe: float) -> None:
    for value in (probe, *ends(first, second)):
        mine, theirs = first.contains(value), second.contains(value)
        assert first.intersection(second).contains(value) == (mine and theirs)
        assert first.union(second).contains(value) == (mine or theirs)
        assert first.complement().contains(value) == (not mine)


@given(regions)
def test_a_region_is_empty_exactly_when_no_number_is_in_it(region: Region) -> None:
    assert region.is_empty == (not any(region.contains(value) for value in ends(region)))


@given(regions, regions)
def test_a_region_is_within_another_exactly_when_all_its_numbers_are(first: Region, second: Region) -> None:
    inside = all(second.contains(value) for value in ends(first, second) if first.contains(value))
    assert first.is_within(second) == inside


@given(st.lists(regions, max_size=4), probes)
def test_many_regions_combine_as_two_do(many: list[Region], probe: float) -> None:
    assert Region.union_of(many).contains(probe) == any(one.contains(probe) for one in many)
    assert Region.intersection_of(many).contains(probe) == all(one.contains(probe) for one in many)


@given(regions)
def test_a_sample_lies_in_its_region(region: Region) -> None:
    assume(not region.is_empty)
    assert region.contains(region.sample())


@given(regions)
def test_a_sample_is_finite_wherever_a_finite_number_is_in_the_region(region: Region) -> None:
    assume(any(region.contains(value) and math.isfinite(value) for value in ends(region)))
    assert math.isfinite(region.sample())


@pytest.mark.parametrize(
    ("low", "high", "sample"),
    [
        ((Operator.GREATER, 11), (Operator.LESS, 15), 13),
        ((Operator.GREATER, 5.4), (Operator.LESS, 6), 5.7),
        ((Operator.GREATER, 0), (Operator.LESS, 1), 0.5),
        ((Operator.GREATER, -13), (Operator.LESS, 6), -4),
        ((Operator.GREATER_EQUAL, 3), (Operator.LESS_EQUAL, 3), 3),
        ((Operator.GREATER, 1000.25), (Operator.LESS, 1000.26), 1000.255),
        ((Operator.GREATER, 2), (Operator.GREATER, 1), 3),
        ((Operator.LESS, 6), (Operator.LESS, 7), 5),
        ((Operator.GREATER_EQUAL, 0.05), (Operator.NOT_EQUAL, 7), 4),
        ((Operator.NOT_EQUAL, 0), (Operator.GREATER, -1), -0.5),
        ((Operator.GREATER, 1e17), (Operator.NOT_EQUAL, 0), math.nextafter(1e17, math.inf)),
    ],
)
def test_samples_are_the_numbers_that_a_person_would_choose(
    low: tuple[Operator, float], high: tuple[Operator, float], sample: float
) -> None:
    assert Region.where(*low).intersection(Region.where(*high)).sample() == sample


def test_between_neighbouring_numbers_there_is_nothing() -> None:
    above = Region.where(Operator.GREATER, 1.0)
    below = Region.where(Operator.LESS, math.nextafter(1.0, 2.0))
    assert above.intersection(below).is_empty


def test_an_empty_region_has_no_sample() -> None:
    with pytest.raises(ValueError, match="holds no number"):
        Region.nothing().sample()
