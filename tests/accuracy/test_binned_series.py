# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loss stretch by stretch is that of a naive count, ns by ns, and its worst is the worst of all."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from accuracy.loss_signals import series
from smarttestudo.accuracy.measure import age_of
from smarttestudo.accuracy.reconstruction import BinnedSeries, TimeBins, binned_age, binned_error, field_error
from smarttestudo.accuracy.samples import Series
from smarttestudo.domain.units import NS_PER_S

bins = st.builds(
    lambda width, before: TimeBins(first_ns=-before, width_ns=width, count=(60 + before) // width + 1),
    st.integers(1, 30),
    st.integers(0, 9),
)


def worst(binned: BinnedSeries) -> float:
    return max((value for value in binned if value is not None), default=0.0)


@given(
    sent_ns=st.lists(st.integers(0, 60), min_size=1, max_size=12, unique=True).map(sorted),
    every=st.integers(1, 4),
    late_ns=st.integers(0, 3),
    bins=bins,
)
def test_the_error_in_each_stretch_is_the_largest_of_its_moments(
    sent_ns: list[int], every: int, late_ns: int, bins: TimeBins
) -> None:
    sent = series(sent_ns, [float(stamp_ns * stamp_ns % 17) for stamp_ns in sent_ns])
    received = series([stamp_ns + late_ns for stamp_ns in sent_ns[::every]], list(sent.values[::every]))
    binned = binned_error(sent, received, 60, bins)
    for index, value in enumerate(binned):
        errors = [_error(sent, received, now_ns) for now_ns in _moments(bins, index)]
        assert value == max((error for error in errors if error is not None), default=None)
    total = field_error(sent, received, 60)
    assert worst(binned) == (total.hold.maximum if total else 0.0)


@given(
    received_ns=st.lists(st.integers(0, 60), max_size=12, unique=True).map(sorted),
    bins=bins,
)
def test_the_age_in_each_stretch_is_the_greatest_of_its_moments(
    received_ns: list[int], bins: TimeBins
) -> None:
    binned = binned_age(received_ns, 60, bins)
    age = age_of(received_ns, sent_from_ns=0, end_ns=60)
    assert worst(binned) == (age.max_s if age else 0.0)
    for index, value in enumerate(binned):
        # A tooth is highest just before its message or the stretch's end, which may be 1 ns after a moment.
        ages_ns = [
            now_ns - newest_ns
            for now_ns in _moments(bins, index)
            for newest_ns in (_newest(received_ns, now_ns), _newest(received_ns, now_ns - 1))
            if newest_ns is not None
        ]
        if not ages_ns:
            assert value is None
        else:
            assert value is not None
            assert max(ages_ns) <= round(value * NS_PER_S) <= max(ages_ns) + 1


def _newest(received_ns: list[int], now_ns: int) -> int | None:
    return max((stamp_ns for stamp_ns in received_ns if stamp_ns <= now_ns), default=None)


def _moments(bins: TimeBins, index: int) -> range:
    start_ns = bins.first_ns + index * bins.width_ns
    return range(max(start_ns, 0), min(start_ns + bins.width_ns, 61))


def _error(sent: Series, received: Series, now_ns: int) -> float | None:
    true, shown = (
        [value for stamp_ns, value in zip(one.stamps_ns, one.values, strict=True) if stamp_ns <= now_ns]
        for one in (sent, received)
    )
    return abs(true[-1] - shown[-1]) if true and shown else None
