# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Ages are those of the sawtooth, to the nanosecond."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.accuracy.loss_report import Age
from smarttestudo.accuracy.measure import age_of
from smarttestudo.domain.units import NS_PER_S

STAMPS = st.lists(st.integers(0, 60), min_size=1, max_size=15).map(sorted)


def age(stamps_ns: list[int], *, sent_from_ns: int = 0, end_ns: int) -> Age:
    found = age_of(stamps_ns, sent_from_ns=sent_from_ns, end_ns=end_ns)
    assert found is not None
    return found


def test_an_even_topic_is_half_a_period_old() -> None:
    even = age([n * NS_PER_S // 2 for n in range(21)], end_ns=10 * NS_PER_S)
    assert even == Age(mean_s=0.25, p95_s=0.475, max_s=0.5)


def test_one_long_silence_weighs_by_its_square() -> None:
    silent = age([0, NS_PER_S, 9 * NS_PER_S], end_ns=10 * NS_PER_S)
    assert silent.mean_s == pytest.approx((1 + 64 + 1) / 20)
    assert silent.max_s == 8
    assert silent.p95_s == pytest.approx(7.5)


def test_the_time_before_the_first_message_is_said_apart() -> None:
    late = age([4 * NS_PER_S], sent_from_ns=NS_PER_S, end_ns=10 * NS_PER_S)
    assert (late.unseen_s, late.max_s) == (3, 6)


def test_nothing_received_has_no_age() -> None:
    assert age_of([], sent_from_ns=0, end_ns=5) is None
    assert age_of([7], sent_from_ns=0, end_ns=5) is None


@given(STAMPS, st.integers(1, 20))
def test_ages_are_those_of_a_naive_look_at_every_nanosecond(stamps_ns: list[int], after_ns: int) -> None:
    end_ns = stamps_ns[-1] + after_ns
    ours = age(stamps_ns, end_ns=end_ns)
    times = np.arange(stamps_ns[0], end_ns) + 0.5
    naive = times - np.array(stamps_ns)[np.searchsorted(stamps_ns, times, "right") - 1]
    assert ours.mean_s * NS_PER_S == pytest.approx(naive.mean())
    assert ours.max_s * NS_PER_S == pytest.approx(naive.max() + 0.5)
    assert ours.p95_s * NS_PER_S == pytest.approx(np.quantile(naive, 0.95, method="inverted_cdf"), abs=1)


@given(STAMPS, st.data())
def test_who_receives_more_never_has_older_messages(stamps_ns: list[int], data: st.DataObject) -> None:
    rest = [stamp for stamp in stamps_ns[1:] if data.draw(st.booleans())]
    end_ns = stamps_ns[-1] + 3
    more, fewer = age(stamps_ns, end_ns=end_ns), age([stamps_ns[0], *rest], end_ns=end_ns)
    assert more.mean_s <= fewer.mean_s + 1e-15
    assert more.p95_s <= fewer.p95_s + 1e-15
    assert more.max_s <= fewer.max_s
