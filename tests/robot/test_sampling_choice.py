# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A topic is sampled where its source is much faster than its target, and not a moment longer."""

from __future__ import annotations

import math

from smarttestudo.robot.sampling import BEGIN_RATIO, END_RATIO, PAUSE_NS, SamplingChoice

SECOND = 1_000_000_000
LOOK = SECOND // 5


class Source:
    """A source in virtual time, looked at five times a second."""

    def __init__(self) -> None:
        self.now_ns = 0
        self.sent = 0.0
        self.choice = SamplingChoice(0)

    def run(self, source_hz: float, target_hz: float, seconds: float = 3.0) -> list[bool]:
        looks = []
        for _ in range(round(seconds * SECOND / LOOK)):
            self.now_ns += LOOK
            self.sent += source_hz * LOOK / SECOND
            looks.append(self.choice.should_sample(int(self.sent), target_hz, self.now_ns))
        return looks


def test_a_source_far_above_its_target_is_sampled_once_its_rate_was_measured() -> None:
    source = Source()
    looks = source.run(1000, 50)
    assert not any(looks[:5])
    assert all(looks[6:])
    assert source.choice.source_hz == 1000


def test_a_source_near_its_target_is_never_sampled() -> None:
    assert not any(Source().run(100, 50, seconds=30))
    assert not any(Source().run(100, math.inf, seconds=30))


def test_a_slow_source_is_never_sampled_however_slow_its_target() -> None:
    assert not any(Source().run(10, 0.1, seconds=30))


def test_a_fast_source_that_is_off_is_sampled() -> None:
    assert Source().run(1000, 0)[-1]


def test_between_the_two_ratios_everything_stays_as_it_is() -> None:
    between = (BEGIN_RATIO + END_RATIO) / 2
    assert not any(Source().run(100 * between, 100, seconds=30))
    sampled = Source()
    sampled.run(100 * BEGIN_RATIO, 100)
    assert all(sampled.run(100 * between, 100, seconds=30))


def test_a_raised_target_ends_sampling_at_the_next_look() -> None:
    source = Source()
    source.run(1000, 50)
    assert not source.run(1000, 500)[0]


def test_after_its_end_sampling_pauses_for_ten_seconds() -> None:
    source = Source()
    source.run(1000, 50)
    source.run(1000, 500, seconds=0.2)
    again = source.run(1000, 50, seconds=12)
    assert not any(again[: PAUSE_NS // LOOK - 1])
    assert again[-1]


def test_a_source_that_slows_down_is_heard_in_full_again() -> None:
    source = Source()
    source.run(1000, 50)
    assert not source.run(60, 50)[-1]


def test_a_clock_that_jumps_back_only_begins_the_measurement_anew() -> None:
    source = Source()
    source.run(1000, 50)
    source.now_ns -= 60 * SECOND
    assert all(source.run(1000, 50))
    assert source.choice.source_hz == 1000
