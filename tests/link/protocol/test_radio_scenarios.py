# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""In virtual time an operator observes over a radio what its file says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from link.protocol.radio_way import RadioWay, observed, stream_ends
from link.protocol.simulated_link import MS
from thin_link.emulated_path import PathConditions
from thin_link.scenario import load_scenario, scenario_paths

SCENARIOS = {name: load_scenario(path) for name, path in scenario_paths().items()}
LOSSLESS = [name for name, one in SCENARIOS.items() if not any(at.loss for _, at in one.course)]


@pytest.mark.parametrize("name", LOSSLESS)
def test_over_a_radio_that_loses_nothing_all_that_its_file_says_is_observed(name: str) -> None:
    scenario = SCENARIOS[name]
    ends = stream_ends(scenario)
    seen = observed(ends, ends.up, scenario)
    missed = {one.wanted: one.value for one in scenario.judge(seen) if not one.is_met}
    assert missed == {}
    assert ends.up.path.counts.overflowed == 0


def test_a_way_delivers_when_the_model_says_also_after_the_link_became_slower_or_faster() -> None:
    events = list[tuple[int, Callable[[int], None]]]()
    arrived = list[tuple[int, int]]()
    begin = PathConditions(rate_bits_per_s=8e6)
    slower = replace(begin, rate_bits_per_s=0.8e6)
    course = [(0.0, begin), (0.0015, slower), (0.0065, begin)]
    way = RadioWay[int](
        course, 1, lambda *event: events.append(event), lambda *arrival: arrived.append(arrival)
    )
    for number in range(3):
        way.put(number, 1_000, 0)
    while events:
        at_ns, act = events.pop(events.index(min(events, key=lambda event: event[0])))
        act(at_ns)
    # One at 8 Mbit/s, the half of the second at a tenth of that, and the third at 8 again.
    assert arrived == [(0, MS), (1, 6_500_000), (2, 7_500_000)]
