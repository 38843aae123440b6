# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Accuracies of levels, and what they need."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from optimizer.instances import accuracy_tiers
from smarttestudo.domain.profile import AccuracyTiers, rounded_up
from smarttestudo.domain.rate import Tier

MEASURED = AccuracyTiers(bounds=(0.5, 0.2, 0.1, 0.05, 0.02, 0.01), needs_hz=(0.9, 1.5, 2.6, 4.2, 8.5, 16.0))


def test_a_level_lies_between_two_accuracies_and_the_outer_ones_are_their_own() -> None:
    assert MEASURED.interval(Tier.UNACCEPTABLE) == (0.5, 0.5)
    assert MEASURED.interval(Tier.ACCEPTABLE) == (0.2, 0.1)
    assert MEASURED.interval(Tier.COMPETITIVE) == (0.05, 0.02)
    assert MEASURED.interval(Tier.EXCESSIVE) == (0.01, 0.01)


@given(tiers=accuracy_tiers(), bound=st.floats(1e-4, 20))
def test_between_two_accuracies_the_need_lies_on_a_line(tiers: AccuracyTiers, bound: float) -> None:
    assert tiers.needs_hz is not None
    if bound < tiers.bounds[-1]:
        assert tiers.needed_hz(bound) == math.inf
    elif bound not in tiers.bounds:
        line = np.interp(bound, tiers.bounds[::-1], tiers.needs_hz[::-1])
        assert tiers.needed_hz(bound) == pytest.approx(line)


def test_what_was_not_measured_is_not_known() -> None:
    assert AccuracyTiers(bounds=MEASURED.bounds).needed_hz(0.1) == math.inf


@given(tiers=accuracy_tiers(), rate_hz=st.floats(0, 250))
def test_the_tightest_bound_of_a_rate_needs_no_more_and_no_tighter_one_does(
    tiers: AccuracyTiers, rate_hz: float
) -> None:
    assert tiers.needs_hz is not None
    found = tiers.tightest_within(rate_hz)
    if rate_hz < tiers.needs_hz[0]:
        assert found == tiers.bounds[0]
        return
    assert tiers.needed_hz(found * (1 + 1e-9)) <= rate_hz * (1 + 1e-6) + 1e-6
    assert tiers.needed_hz(found * (1 - 1e-6)) >= rate_hz * (1 - 1e-9)


@given(bound=st.floats(1e-9, 1e9))
def test_a_rounded_bound_is_never_tighter_and_has_four_digits(bound: float) -> None:
    found = rounded_up(bound)
    assert bound * (1 - 1e-12) <= found <= bound * 1.0011
    assert float(f"{found:.4g}") == found
