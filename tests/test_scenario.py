# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A radio as a file: what an engineer writes for his own, and what he is told of mistakes."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from smarttestudo.domain.errors import TestudoError
from thin_link.cases import Arrival, Beside, Seen
from thin_link.emulated_path import PathConditions
from thin_link.observations import EVENTS, JPEG, OBSERVED, SMALL
from thin_link.scenario import Interval, Scenario, load_scenario, scenario_paths

OWN = """\
title = "Our yard"
seconds = 30

[link]
rate_mbit_per_s = 4
delay_ms = 20

[[link.changes]]
at_s = 10
loss = 1  # behind the silo
blocks_udp = true

[offered]
share_of_rate = 1.2

[observed]
small_age_p95_ms = [0, 200]
"""


def loaded(folder: Path, text: str) -> Scenario:
    path = folder / "yard.toml"
    path.write_text(text, encoding="utf-8")
    return load_scenario(path)


def test_a_radio_of_one_s_own_is_a_file(tmp_path: Path) -> None:
    scenario = loaded(tmp_path, OWN)
    begin = PathConditions(rate_bits_per_s=4e6, delay_ms=20)
    assert scenario.name == "yard"
    assert scenario.course == [(0.0, begin), (10, replace(begin, loss=1, blocks_udp=True))]
    assert scenario.observed == {"small_age_p95_ms": Interval(least=0, most=200)}
    assert scenario.case().capacity_bytes(0, 30) == 5_000_000


def test_the_radio_in_the_documentation_can_be_measured(tmp_path: Path) -> None:
    page = Path(__file__).parents[1] / "docs" / "contributors" / "benchmark-link.md"
    found = re.search(r"```toml[^\n]*\n(.*?)```", page.read_text("utf-8"), re.DOTALL)
    assert found is not None
    assert [at_s for at_s, _ in loaded(tmp_path, found[1]).course] == [0, 10, 14]


@pytest.mark.parametrize("name", scenario_paths())
def test_what_is_offered_takes_the_share_of_the_rate(name: str) -> None:
    scenario = load_scenario(scenario_paths()[name])
    offered_bytes_per_s = sum(one.size_bytes * one.hz for one in scenario.topics)
    assert offered_bytes_per_s * 8 == pytest.approx(1.2 * scenario.conditions.rate_bits_per_s, rel=0.001)


def test_the_profiles_are_those_that_a_vendor_publishes() -> None:
    found = {name: load_scenario(path).conditions for name, path in scenario_paths().items()}
    figures = {
        name: (one.rate_bits_per_s / 1e6, one.delay_ms, one.jitter_ms, one.loss)
        for name, one in found.items()
        if name != "fall"
    }
    assert figures == {
        "clean": (2, 1, 0, 0),
        "starlink": (15, 30, 10, 0.02),
        "4g": (10, 50, 15, 0.03),
        "wifi-walls": (2, 15, 10, 0.08),
        "severe": (2, 100, 30, 0.05),
    }


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("delay_ms = 20", "dealy_ms = 20", "yard.toml:6: error: link.dealy_ms means nothing here"),
        ("delay_ms = 20", "delay_ms = -1", "yard.toml:6: error: link.delay_ms is no number from 0"),
        ("loss = 1 ", "loss = 1.5 ", "yard.toml:10: error: link.changes.loss is no number from 0 to 1"),
        ("true", "1", "yard.toml:11: error: link.changes.blocks_udp is neither true nor false"),
        ("at_s = 10", "at_s = -1", "yard.toml:9: error: link.changes.at_s is no number from 0"),
        ("[0, 200]", "200", "yard.toml:17: error: observed.small_age_p95_ms is no interval"),
        (
            "small_age_p95_ms",
            "small_age",
            "observed.small_age means nothing here; known keys: small_age_p",
        ),
        ('"Our yard"', "7", "yard.toml:1: error: title is no text"),
        ("[offered]", "[offer]", "error: offered is no table"),
        ("rate_mbit_per_s = 4", "", "yard.toml:4: error: link.rate_mbit_per_s is no number"),
    ],
)
def test_a_mistake_is_named_with_its_place(tmp_path: Path, before: str, after: str, said: str) -> None:
    with pytest.raises(TestudoError) as raised:
        loaded(tmp_path, OWN.replace(before, after))
    assert said in str(raised.value)


def seen(**changes: object) -> Seen:
    """Ten seconds in which all small topics arrive 30 ms old."""
    arrived = {
        one.name: [
            Arrival(number=number, sent_s=number / one.hz, at_s=number / one.hz + 0.03)
            for number in range(int(10 * one.hz))
        ]
        for one in (*SMALL, EVENTS)
    }
    usual = Seen(arrived=arrived, seconds=10, used=0.9, cpu_s_per_mb=0.1, published={EVENTS.name: 100})
    return replace(usual, **changes)  # type: ignore[arg-type]


def test_what_is_observed_of_a_run_in_which_all_goes_well() -> None:
    found = {name: one.of(seen()) for name, one in OBSERVED.items() if name != "large_whole"}
    assert found == {
        "small_age_p95_ms": pytest.approx(30),
        "small_age_max_ms": pytest.approx(30),
        # A message is at most a period and its way old when the next one comes.
        "small_stale_p95_ms": pytest.approx(30, abs=10),
        "small_delivered": 1.0,
        "used": 0.9,
        "full_missing": 0,
        "full_age_p95_ms": pytest.approx(30),
        "older_after_newer": 0,
    }


def test_what_is_observed_of_a_run_in_which_much_goes_wrong() -> None:
    whole = seen()
    odom, *_ = SMALL
    arrived = dict(whole.arrived)
    # Every second one is lost, and two change places.
    odd = [one for one in arrived[odom.name] if one.number % 2]
    arrived[odom.name] = [*odd[:3], odd[4], odd[3], *odd[5:]]
    arrived[EVENTS.name] = arrived[EVENTS.name][5:]
    arrived[JPEG.name] = [Arrival(number=0, sent_s=0, at_s=1)]
    bad = replace(whole, arrived=arrived, overflowed={EVENTS.name: 2}, begun={JPEG.name: 2})
    assert OBSERVED["small_delivered"].of(bad) == pytest.approx(0.5, abs=0.01)
    assert OBSERVED["older_after_newer"].of(bad) == 1
    assert OBSERVED["full_missing"].of(bad) == 3
    assert OBSERVED["large_whole"].of(bad) == 0.5
    assert OBSERVED["small_stale_p95_ms"].of(bad) == pytest.approx(66, abs=10)


def test_a_topic_that_never_comes_is_as_stale_as_the_run_is_long() -> None:
    silent = seen(arrived={})
    assert OBSERVED["small_stale_p95_ms"].of(silent) > 9_000
    assert OBSERVED["small_age_p95_ms"].of(silent) == float("inf")


def test_beside_something_else_a_robot_is_judged_by_its_share_alone() -> None:
    case = load_scenario(scenario_paths()["clean"]).case(Beside.FLOW)
    share, age = case.judge(seen(other_share=0.9))
    assert (share.wanted, share.is_met) == ("share of what goes beside 0.167 to 0.833", False)
    assert (age.wanted, age.is_met) == ("small topics, age p95 ms", True)
