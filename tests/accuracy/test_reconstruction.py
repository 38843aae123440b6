# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The error of a field is the one of the books: sine, step, ramp, angles; and that of a naive count."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from accuracy.loss_signals import (
    every,
    held_sine_rmse,
    line_sine_rmse,
    sampled,
    sent_and_received,
    sent_series,
    series,
    sine,
)
from smarttestudo.accuracy.loss_report import FieldError
from smarttestudo.accuracy.reconstruction import field_error
from smarttestudo.accuracy.samples import Series
from smarttestudo.domain.units import NS_PER_S


def error_of(sent: Series, received: Series, end_ns: int | None = None) -> FieldError:
    error = field_error(sent, received, sent.stamps_ns[-1] if end_ns is None else end_ns)
    assert error is not None
    return error


@pytest.mark.parametrize("count", [1, 2, 5, 20, 50])
@pytest.mark.parametrize("amplitude", [1.0, 0.2])
def test_a_sine_has_the_error_of_the_closed_form(count: int, amplitude: float) -> None:
    sent = sampled(sine(0.5, amplitude), hz=100, seconds=10)
    error = error_of(sent, every(count, sent))
    step = math.tau * 0.5 / 100
    assert error.hold.rmse == pytest.approx(amplitude * held_sine_rmse(step, count), rel=1e-9)
    assert error.interpolated.rmse == pytest.approx(amplitude * line_sine_rmse(step, count), rel=1e-9)
    assert error.hold.relative_rmse == pytest.approx(error.hold.rmse / sent.value_range)


def test_a_finely_sampled_sine_nears_that_of_continuous_time() -> None:
    sent = sampled(sine(0.1), hz=1000, seconds=10)
    error = error_of(sent, every(1000, sent))
    assert error.hold.rmse == pytest.approx(
        math.sqrt(1 - math.sin(math.tau / 10) / (math.tau / 10)), rel=2e-3
    )


@pytest.mark.parametrize(("seen_at_s", "late_s"), [(3, 0), (4, 1), (7, 4)])
def test_a_step_is_wrong_for_as_long_as_it_is_not_received(seen_at_s: int, late_s: int) -> None:
    sent = series([s * NS_PER_S for s in range(11)], [0.0] * 3 + [5.0] * 8)
    received = series([0, seen_at_s * NS_PER_S], [0.0, 5.0])
    hold = error_of(sent, received).hold
    assert hold.rmse == pytest.approx(5 * math.sqrt(late_s / 10))
    assert hold.maximum == (5 if late_s else 0)


def test_a_delay_on_the_link_counts_by_its_length_not_by_messages() -> None:
    sent = series([0, NS_PER_S, 2 * NS_PER_S], [0.0, 1.0, 1.0])
    received = series([0, NS_PER_S + 2_000_000], [0.0, 1.0])
    assert error_of(sent, received).hold.rmse == pytest.approx(math.sqrt(0.002 / 2))


def test_a_value_held_while_the_robot_is_silent_is_wrong_until_the_end() -> None:
    sent = series([0, 1], [0.0, 1.0])
    assert error_of(sent, series([0], [0.0]), end_ns=10).hold.rmse == pytest.approx(math.sqrt(0.9))


@given(
    slope=st.integers(-50, 50),
    stamps_ns=st.lists(st.integers(0, 60), min_size=2, unique=True).map(sorted),
)
def test_a_ramp_is_interpolated_without_error(slope: int, stamps_ns: list[int]) -> None:
    sent = series(stamps_ns, [float(slope * stamp_ns) for stamp_ns in stamps_ns])
    received = series([stamps_ns[0], stamps_ns[-1]], [sent.values[0], sent.values[-1]])
    assert error_of(sent, received).interpolated.maximum == pytest.approx(0, abs=1e-9)


def test_an_angle_takes_the_shorter_way_round() -> None:
    sent = series([0, 1, 2, 3], [170.0, 179.0, -178.0, -170.0], wraps=True)
    error = error_of(sent, series([0, 3], [170.0, -170.0], wraps=True))
    assert error.hold.maximum == 12
    assert error.interpolated.maximum == pytest.approx(7 / 3)
    assert sent.value_range == 20


def test_an_angle_that_turns_and_turns_has_a_range_of_one_turn() -> None:
    sent = sampled(lambda t_s: (90 * t_s + 180) % 360 - 180, hz=10, seconds=20, wraps=True)
    assert sent.value_range == 360


@given(sent_series(known_only=False), st.integers(0, 20))
def test_who_receives_everything_errs_by_nothing(sent: Series, after_ns: int) -> None:
    error = field_error(sent, sent, sent.stamps_ns[-1] + after_ns)
    if error is not None:
        assert error.hold.rmse == error.hold.maximum == 0
        assert error.interpolated.rmse == error.interpolated.maximum == 0


@pytest.mark.parametrize("wraps", [False, True])
@given(data=st.data())
def test_errors_are_those_of_a_naive_look_at_every_nanosecond(wraps: bool, data: st.DataObject) -> None:
    sent, received = data.draw(sent_and_received(wraps=wraps))
    end_ns = sent.stamps_ns[-1] + data.draw(st.integers(1, 9))
    error = error_of(sent, received, end_ns)
    times = np.arange(sent.stamps_ns[0], end_ns)
    stamp_of = np.array(sent.stamps_ns)[np.searchsorted(sent.stamps_ns, times, "right") - 1]
    truth = np.array(sent.values)[np.searchsorted(sent.stamps_ns, times, "right") - 1]
    held = np.array(received.values)[np.searchsorted(received.stamps_ns, times, "right") - 1]
    binned = np.unwrap(received.values, period=360) if wraps else np.array(received.values)
    lines = np.interp(stamp_of, received.stamps_ns, binned)
    for shown, ours in ((held, error.hold), (lines, error.interpolated)):
        gap = (shown - truth + 180) % 360 - 180 if wraps else shown - truth
        assert ours.rmse == pytest.approx(np.sqrt(np.mean(gap**2)), rel=1e-9, abs=1e-9)
        assert ours.maximum == pytest.approx(np.abs(gap).max(), abs=1e-9)


@given(sent_and_received())
def test_no_error_is_larger_than_the_range(both: tuple[Series, Series]) -> None:
    error = error_of(*both)
    for size in (error.hold, error.interpolated):
        assert size.rmse <= size.maximum + 1e-9
        assert size.maximum <= both[0].value_range + 1e-9


@given(sent_and_received(), st.lists(st.integers(0, 14), unique=True))
def test_unknown_samples_cost_the_time_they_last_and_nothing_else(
    both: tuple[Series, Series], unknown: list[int]
) -> None:
    sent, received = both
    holes = [math.nan if index in unknown else value for index, value in enumerate(sent.values)]
    error = field_error(series(sent.stamps_ns, holes), received, sent.stamps_ns[-1])
    whole = error_of(sent, received)
    if error is not None:
        assert error.hold.maximum <= whole.hold.maximum
        assert error.interpolated.maximum <= whole.interpolated.maximum


def test_an_unknown_sample_received_leaves_the_last_known_one_standing() -> None:
    sent = series([0, 1, 2, 3], [1.0, 2.0, 3.0, 3.0])
    received = series([0, 1, 2], [1.0, math.nan, 3.0])
    assert received.unknown == 1
    assert error_of(sent, received).hold.rmse == pytest.approx(math.sqrt(1 / 3))


@pytest.mark.parametrize(
    ("sent", "received"),
    [
        (series([0, 1], [1.0, 2.0]), series([], [])),
        (series([0, 1], [1.0, 2.0]), series([0], [math.nan])),
        (series([0, 1], [math.nan, math.nan]), series([0], [1.0])),
        (series([0, 1], [1.0, 2.0]), series([7], [1.0])),
    ],
    ids=["nothing received", "nothing known received", "nothing known sent", "received after the end"],
)
def test_without_a_common_time_there_is_no_error(sent: Series, received: Series) -> None:
    assert field_error(sent, received, 1) is None


def test_at_the_end_of_all_stamps_the_error_is_what_it_is_today() -> None:
    values, count = [math.sin(i / 5) for i in range(50)], 50
    errors = []
    for origin_ns in (0, 2**63 - count * NS_PER_S):
        stamps_ns = [origin_ns + i * NS_PER_S for i in range(count)]
        sent = series(stamps_ns, values)
        errors.append(field_error(sent, every(5, sent), stamps_ns[-1]))
    assert errors[0] == errors[1]
