# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One run against another: pairs, changes, sums and errors."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.bags.comparison import (
    Comparison,
    Target,
    change_percent,
    compare,
    mean_target,
    target_spans,
)
from smarttestudo.bags.statistics import TopicStatistics
from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.rate import Rate
from smarttestudo.report.summary import bandwidth_text, length_text, summary_sentence


def carrying(hz: float, kb_per_s: float | None = 1.0) -> TopicStatistics:
    return TopicStatistics(
        messages=100,
        size_bytes=1000,
        start_s=0.0,
        end_s=10.0,
        mean_hz=hz,
        binned_hz=hz,
        kb_per_s=kb_per_s,
    )


def decided(t_s: float, rate: Rate) -> Decision:
    planned = PlannedRate(rate=rate, reason=Reason.DEFAULT)
    return Decision(t_s=t_s, stamp_ns=0, topic="/odom", from_rate=None, planned=planned, values={})


def test_rates_and_bandwidth_change_in_percent_of_the_first_run() -> None:
    (pair,) = compare({"/odom": carrying(25.0, 20.0)}, {"/odom": carrying(5.0, 1.0)}).topics
    assert pair.change_percent == -80
    assert pair.bandwidth_change_percent == -95


@pytest.mark.parametrize("name", ["/testudo/odom", "/odom_receive", "/odom"])
def test_a_relayed_topic_pairs_with_its_source(name: str) -> None:
    (pair,) = compare({"/odom": carrying(25.0)}, {name: carrying(5.0)}).topics
    assert (pair.topic, pair.change_percent) == ("/odom", -80)


def test_of_several_partners_the_relay_wins_and_the_others_stand_alone() -> None:
    after = {"/odom": carrying(25.0), "/odom_receive": carrying(9.0), "/testudo/odom": carrying(5.0)}
    found = compare({"/odom": carrying(25.0)}, after)
    assert [(pair.topic, pair.before is None) for pair in found.topics] == [
        ("/odom", False),
        ("/odom (B)", True),
        ("/odom_receive", True),
    ]
    assert found.topics[0].change_percent == -80


def test_what_one_run_does_not_have_is_missing_not_zero() -> None:
    found = compare({"/a": carrying(1.0, 8.0)}, {"/b": carrying(2.0, 4.0)}, {"/a": None})
    for pair in found.topics:
        assert (pair.change_percent, pair.bandwidth_change_percent, pair.error_percent) == (None, None, None)
    assert found.bandwidth_change_percent == -50


def test_the_sum_is_over_every_topic_with_a_known_bandwidth() -> None:
    before = {"/a": carrying(1.0, 8.0), "/b": carrying(1.0, 2.0), "/c": carrying(1.0, None)}
    after = {"/a": carrying(1.0, 1.0), "/b": carrying(1.0, 1.5)}
    found = compare(before, after)
    assert (found.before_kb_per_s, found.after_kb_per_s) == (10.0, 2.5)
    assert found.bandwidth_change_percent == -75


def test_nothing_known_has_no_sum() -> None:
    assert compare({"/c": carrying(1.0, None)}, {}).before_kb_per_s is None
    assert Comparison(topics=()).bandwidth_change_percent is None


def test_a_change_from_nothing_has_no_percentage() -> None:
    assert change_percent(0.0, 5.0) is None
    assert change_percent(5.0, 0.0) == -100


def test_a_target_above_the_source_asks_for_the_source_only() -> None:
    """/scan at 5 Hz under a rule that asks for 10 in a third of the time is no error."""
    spans = target_spans([decided(0.0, Rate(3.0)), decided(20.0, Rate(10.0))], 30.0)
    target = mean_target(spans, 5.0)
    assert target is not None
    assert target.planned_hz == pytest.approx(16 / 3)
    assert target.attainable_hz == pytest.approx(11 / 3)
    (pair,) = compare({"/scan": carrying(5.0)}, {"/scan": carrying(11 / 3)}, {"/scan": target}).topics
    assert pair.error_percent == pytest.approx(0.0, abs=1e-9)


def test_full_asks_for_the_source_and_is_unknown_without_one() -> None:
    spans = target_spans([decided(0.0, Rate.full()), decided(5.0, Rate(2.0))], 10.0)
    assert mean_target(spans, 8.0) == Target(planned_hz=5.0, attainable_hz=5.0)
    assert mean_target(spans, None) is None
    assert mean_target((), 8.0) is None


@given(
    st.lists(st.tuples(st.floats(0, 100), st.floats(0, 100)), min_size=1, max_size=8),
    st.floats(0.1, 50),
    st.floats(1, 120),
)
def test_mean_targets_equal_a_sum_over_small_steps(
    changes: list[tuple[float, float]], source_hz: float, end_s: float
) -> None:
    steps = sorted({round(t_s, 1): hz for t_s, hz in changes}.items())
    end_s = round(end_s, 1)
    found = mean_target(target_spans([decided(t_s, Rate(hz)) for t_s, hz in steps], end_s), source_hz)
    ticks = [tick / 10 + 0.05 for tick in range(round(end_s * 10)) if tick / 10 + 0.05 > steps[0][0]]
    planned = [next(hz for t_s, hz in reversed(steps) if t_s <= at_s) for at_s in ticks]
    if not ticks:
        assert found is None
        return
    assert found is not None
    assert found.planned_hz == pytest.approx(sum(planned) / len(planned), rel=1e-9)
    attainable = [min(hz, source_hz) for hz in planned]
    assert found.attainable_hz == pytest.approx(sum(attainable) / len(attainable), rel=1e-9)


def test_a_run_in_one_sentence() -> None:
    found = compare({"/a": carrying(1.0, 100.0)}, {"/a": carrying(1.0, 19.0)})
    assert summary_sentence(found) == "−81 % bandwidth"


def test_what_is_not_known_is_not_said() -> None:
    pair = compare({"/a": carrying(1.0, 100.0)}, {"/a": carrying(1.0, 19.0)})
    alone = compare({"/a": carrying(1.0, 100.0)}, {})
    assert summary_sentence(pair) == "−81 % bandwidth"
    assert summary_sentence(alone) == "100.0 KB/s"


@pytest.mark.parametrize(
    ("length_m", "text"),
    [(0.0, "0.0 mm"), (0.0043, "4.3 mm"), (0.0213, "2.1 cm"), (1.26, "1.3 m"), (250.0, "250.0 m")],
)
def test_a_length_is_told_in_the_unit_that_reads_best(length_m: float, text: str) -> None:
    assert length_text(length_m) == text


def test_two_lengths_are_told_in_one_unit() -> None:
    assert length_text(0.0043, beside_m=0.019) == "0.4 cm"


@pytest.mark.parametrize(
    ("kb_per_s", "text"),
    [(None, "–"), (0.0, "0.0 KB/s"), (999.94, "999.9 KB/s"), (192_252.7, "192.3 MB/s")],
)
def test_bandwidth_is_told_in_the_unit_that_reads_best(kb_per_s: float | None, text: str) -> None:
    assert bandwidth_text(kb_per_s) == text
