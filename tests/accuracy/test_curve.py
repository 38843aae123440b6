# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The curve is the loss at each rate; its breakpoints are where the closed form of a sine says."""

from __future__ import annotations

import itertools
import math
import struct
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from accuracy.loss_signals import held_sine_rmse, sine
from smarttestudo.accuracy.curve import (
    LEVELS,
    LossCurve,
    curve_rates_hz,
    loss_curve,
    measure_curves,
    proposed_breakpoints,
)
from smarttestudo.accuracy.reconstruction import field_error
from smarttestudo.accuracy.samples import Field, TopicSamples
from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.units import NS_PER_S

SECONDS = 100
HZ = 100
SINE_HZ = 0.1


def recorded(signal_hz: float = SINE_HZ, *, amplitude: float = 1.0) -> TopicSamples:
    """``data`` is a sine, ``still`` never changes; messages of 500 bytes at 100 Hz."""
    samples = TopicSamples(Channel(topic="/a", type_name="std_msgs/msg/Float64"))
    samples.look_at([Field(name="data"), Field(name="still")], None)
    for number in range(HZ * SECONDS + 1):
        samples.add(number * NS_PER_S // HZ, 500)
        samples.read(SimpleNamespace(data=sine(signal_hz, amplitude)(number / HZ), still=7.0))
    return samples


def curve_of(samples: TopicSamples) -> LossCurve:
    curve = loss_curve(samples, samples.stamps_ns[-1])
    assert curve is not None
    return curve


def test_the_curve_of_a_sine_is_its_closed_form() -> None:
    curve = curve_of(recorded())
    assert [field.name for field in curve.fields] == ["data"]
    assert [point.rate_hz for point in curve.points] == [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100]
    for point in curve.points[3:]:
        (error,) = point.errors
        assert error is not None
        closed = held_sine_rmse(math.tau * SINE_HZ / HZ, round(HZ / point.rate_hz))
        # The phase moves by up to one message at a time, so the intervals differ by that much.
        assert error.hold.rmse == pytest.approx(closed, rel=0.05, abs=1e-12)


def test_a_rate_carries_its_messages_and_at_most_one_more() -> None:
    for point in curve_of(recorded()).points:
        messages = round(point.rate_hz * SECONDS)
        assert round(point.kb_per_s * SECONDS / 0.5) in {messages, messages + 1}


def test_nothing_is_lost_at_the_source_even_of_bursts() -> None:
    samples = TopicSamples(Channel(topic="/a", type_name="std_msgs/msg/Float64"))
    samples.look_at([Field(name="data")], None)
    for number in range(100):
        samples.add(number * NS_PER_S // HZ + number // 50 * 10 * NS_PER_S, 500)
        samples.read(SimpleNamespace(data=float(number)))
    (error,) = curve_of(samples).points[-1].errors
    assert error is not None
    assert (error.hold.maximum, error.interpolated.maximum) == (0, 0)


def test_at_the_breakpoints_the_error_of_a_sine_is_20_10_5_2_1_percent() -> None:
    samples = recorded()
    breakpoints = curve_of(samples).breakpoints
    assert breakpoints is not None
    sent, end_ns = samples.series(Field(name="data")), samples.stamps_ns[-1]
    for tier_hz, level in zip(breakpoints.tiers_hz, LEVELS, strict=False):
        passed = samples.at_rate(tier_hz, end_ns).series(Field(name="data"))
        error = field_error(sent, passed, end_ns)
        assert error is not None
        assert error.hold.relative_rmse == pytest.approx(level, rel=0.05)
    assert breakpoints.tiers_hz[-1] == HZ
    assert (
        breakpoints.origin == "RMSE of holding: 20, 10, 5, 2, 1 % of the range (worst: data), 0 at source_hz"
    )


def test_breakpoints_do_not_depend_on_the_unit_of_the_field() -> None:
    assert curve_of(recorded()).breakpoints == curve_of(recorded(amplitude=1e-6)).breakpoints


def test_a_faster_signal_needs_faster_tiers() -> None:
    slow, fast = (curve_of(recorded(hz)).breakpoints for hz in (0.05, 0.5))
    assert slow is not None
    assert fast is not None
    assert all(s < f for s, f in itertools.islice(zip(slow.tiers_hz, fast.tiers_hz, strict=True), 5))


def test_between_two_rates_the_error_counts_as_linear_in_the_period() -> None:
    proposal = proposed_breakpoints([(1.0, 0.25, "x"), (2.0, 0.05, "y")], 10.0)
    assert proposal is not None
    # Periods of 1, 0.5 and 0.1 s with 25, 5 and 0 %: 20 % at 0.875 s, 10 % at 0.625 s, 5 % at 0.5 s …
    assert proposal.tiers_hz == (1.14, 1.6, 2.0, 3.85, 5.56, 10.0)
    assert "(worst: x, y)" in proposal.origin


def test_an_error_that_falls_again_at_a_lower_rate_counts_as_it_was() -> None:
    lucky = proposed_breakpoints([(1.0, 0.0, "x"), (2.0, 0.3, "x")], 10.0)
    assert lucky == proposed_breakpoints([(1.0, 0.3, "x"), (2.0, 0.3, "x")], 10.0)


def test_the_slowest_source_with_six_breakpoints_has_one_for_each_step() -> None:
    slowest = proposed_breakpoints([(0.001, 0.5, "x")], 0.006)
    assert slowest is not None
    assert slowest.tiers_hz == (0.001, 0.002, 0.003, 0.004, 0.005, 0.006)
    assert proposed_breakpoints([(0.001, 0.5, "x")], 0.005) is None


@given(
    losses=st.lists(st.tuples(st.floats(1e-3, 1e4), st.floats(0, 3), st.just("x")), max_size=12),
    source_hz=st.floats(1e-3, 1e4),
)
def test_breakpoints_rise_from_a_thousandth_to_the_source(
    losses: list[tuple[float, float, str]], source_hz: float
) -> None:
    proposal = proposed_breakpoints(losses, source_hz)
    if proposal is not None:
        tiers = proposal.tiers_hz
        assert len(tiers) == 6
        assert tiers[0] >= 0.001
        assert all(before < after for before, after in itertools.pairwise(tiers))
        assert tiers[-1] == float(f"{source_hz:.3g}")


@given(source_hz=st.floats(0.01, 1e4), duration_s=st.floats(1, 1e5))
def test_rates_of_a_curve_rise_to_the_source(source_hz: float, duration_s: float) -> None:
    rates = curve_rates_hz(source_hz, duration_s)
    assert list(rates) == sorted(set(rates))
    assert rates[-1] == source_hz


def test_what_never_changes_has_no_curve() -> None:
    samples = TopicSamples(Channel(topic="/a", type_name="std_msgs/msg/Float64"))
    samples.look_at([Field(name="data")], None)
    for number in range(10):
        samples.add(number * NS_PER_S, 8)
        samples.read(SimpleNamespace(data=1.0))
    assert loss_curve(samples, 9 * NS_PER_S) is None


def test_a_field_that_was_added_half_way_has_a_curve_beside_the_others(tmp_path: Path) -> None:
    with create_recording(tmp_path / "bag") as writer:
        for at in range(200):
            definition, values = "float64 level\n", [math.sin(at / 20)]
            if at >= 100:
                definition, values = f"{definition}float64 voltage\n", [*values, math.cos(at / 20)]
            channel = Channel(topic="/level", type_name="demo/msg/Level", definition=definition)
            payload = b"\0\1\0\0" + struct.pack(f"<{len(values)}d", *values)
            writer.write(channel, at * NS_PER_S // 10, payload)
    measured = measure_curves(tmp_path / "bag")
    (curve,) = measured.curves
    assert measured.notices == ()
    assert [field.name for field in curve.fields] == ["level", "voltage"]
