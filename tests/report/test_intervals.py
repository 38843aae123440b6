# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import itertools
import math
import statistics

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.rate_meter import Intervals


@given(batches=st.lists(st.lists(st.integers(0, 10**13), max_size=20), max_size=4))
def test_messages_taken_in_at_once_count_as_one_by_one_to_the_last_digit(batches: list[list[int]]) -> None:
    one_by_one, at_once = Intervals(), Intervals()
    for batch in batches:
        for stamp_ns in batch:
            one_by_one.record(stamp_ns)
        at_once.record_all(batch)
    assert at_once.count == one_by_one.count
    assert (at_once.longest_s, at_once.jitter_s) == (one_by_one.longest_s, one_by_one.jitter_s)


@given(stamps=st.lists(st.integers(0, 10**13), max_size=40).map(sorted))
def test_gap_and_jitter_are_those_of_all_intervals_at_once(stamps: list[int]) -> None:
    intervals = Intervals()
    for stamp_ns in stamps:
        intervals.record(stamp_ns)
    gaps = [after - before for before, after in itertools.pairwise(stamps)]
    assert intervals.longest_s == (max(gaps) / 1e9 if gaps else None)
    if len(gaps) < 2:
        assert intervals.jitter_s is None
    else:
        assert intervals.jitter_s is not None
        assert math.isclose(intervals.jitter_s, statistics.pstdev(gaps) / 1e9, rel_tol=1e-6, abs_tol=1e-9)
