# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Crossings of thresholds are seen in time, late, or not."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from accuracy.loss_signals import sent_and_received, series
from smarttestudo.accuracy.loss_report import CrossingLoss, Sightings
from smarttestudo.accuracy.measure import Threshold, changes, crossing_loss, thresholds_of
from smarttestudo.accuracy.samples import Series
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.signal import Signal
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.parser import parse
from smarttestudo.language.region import Region
from smarttestudo.language.rule_set import compile_rules
from smarttestudo.language.syntax import Operator

ABOVE_ZERO = Threshold(signal=Signal("/a", "x"), region=Region.where(Operator.GREATER, 0))
RULES = """begin
    Rule "Near"
    If (CheckValue /odom pose_y > 1 AND CheckValue /odom pose_y < 5.4 AND CheckValue /odom rate < 2)
    Then SetFrequency /odom 4
    Else SetFrequency /odom 1
    EndIf
    If (Not (CheckValue odom pose_y >= 5.4) OR CheckValue /status code = 3)
    Then SetFrequency /odom 5
    EndIf
    If (CheckValue /status code != 3) Then SetFrequency /odom 6
end
"""


def crossed(sent: Series, received: Series) -> CrossingLoss:
    return crossing_loss(ABOVE_ZERO, sent, received, received, sent.stamps_ns[-1])


def at_seconds(values: dict[float, float]) -> Series:
    return series([round(second * NS_PER_S) for second in values], list(values.values()))


def test_the_thresholds_are_the_checks_that_read_fields_each_once() -> None:
    rule_set = compile_rules([parse(RULES, "rules").file], resolve_topic)
    assert [str(threshold) for threshold in thresholds_of(rule_set)] == [
        "/odom pose_y > 1",
        "/odom pose_y < 5.4",
        "/status code = 3",
    ]


PULSE: dict[float, float] = {0: -1.0, 1: -1.0, 2: 1.0, 3: 1.0, 4: -1.0, 5: -1.0, 6: -1.0}


@pytest.mark.parametrize(
    ("received", "expected"),
    [
        (PULSE, Sightings(in_time=2, late=0, missed=0, late_mean_s=None, late_max_s=None)),
        (
            {0: -1.0, 3: 1.0, 6: -1.0},
            Sightings(in_time=0, late=2, missed=0, late_mean_s=1.5, late_max_s=2.0),
        ),
        (
            {0: -1.0, 2: 1.0, 5: -1.0},
            Sightings(in_time=1, late=1, missed=0, late_mean_s=1.0, late_max_s=1.0),
        ),
        ({0: -1.0, 2: 1.0}, Sightings(in_time=1, late=0, missed=1, late_mean_s=None, late_max_s=None)),
        ({0: -1.0, 4: -1.0}, Sightings(in_time=0, late=0, missed=2, late_mean_s=None, late_max_s=None)),
        ({}, Sightings(in_time=0, late=0, missed=2, late_mean_s=None, late_max_s=None)),
        ({2.3: 1.0, 4.3: -1.0}, Sightings(in_time=2, late=0, missed=0, late_mean_s=None, late_max_s=None)),
        ({4.3: 1.0, 5.5: -1.0}, Sightings(in_time=0, late=2, missed=0, late_mean_s=1.9, late_max_s=2.3)),
        ({1.9: 1.0, 3.9: -1.0}, Sightings(in_time=2, late=0, missed=0, late_mean_s=None, late_max_s=None)),
    ],
    ids=[
        "everything received",
        "each a message late",
        "the way back late",
        "the way back never",
        "there and back unseen: both are missed",
        "nothing received",
        "a link slower than the crossing but not than the next message",
        "a link slower than the pulse is long",
        "clocks that differ by less than a period",
    ],
)
def test_a_pulse_is_seen_in_time_late_or_not(received: dict[float, float], expected: Sightings) -> None:
    loss = crossed(at_seconds(PULSE), at_seconds(received))
    assert loss.crossings == 2
    assert loss.received == expected


def test_a_crossing_at_the_last_message_is_seen_by_who_receives_that() -> None:
    sent = at_seconds({0: -1.0, 1: -1.0, 2: 1.0})
    assert crossed(sent, sent).received.in_time == 1


def test_of_several_values_at_one_stamp_the_last_crosses() -> None:
    sent = series([0, NS_PER_S, NS_PER_S, 2 * NS_PER_S], [-1.0, 1.0, -1.0, -1.0])
    assert crossed(sent, sent).crossings == 0
    sent = series([0, NS_PER_S, NS_PER_S, 2 * NS_PER_S], [-1.0, -1.0, 1.0, 1.0])
    seen = crossed(sent, sent)
    assert (seen.crossings, seen.received.in_time) == (1, 1)


def test_an_unknown_value_crosses_nothing() -> None:
    assert changes(ABOVE_ZERO.field_region, series([0, 1, 2, 3], [math.nan, 1, math.nan, 2])) == [(1, True)]


@given(sent_and_received())
def test_a_crossing_is_seen_if_a_message_comes_that_changes_the_operators_mind(
    both: tuple[Series, Series],
) -> None:
    sent, received = both
    states = dict(changes(ABOVE_ZERO.field_region, sent))
    times = list(states)
    shown = {stamp: value > 0 for stamp, value in zip(received.stamps_ns, received.values, strict=True)}
    late = []
    in_time = 0
    for place, start_ns in enumerate(times[1:], start=1):
        until_ns = times[place + 1] if place + 1 < len(times) else sent.stamps_ns[-1] + 1
        before = [state for stamp, state in shown.items() if stamp < start_ns]
        seen = [stamp for stamp in shown if start_ns <= stamp < until_ns]
        if seen and before[-1] != states[start_ns]:
            in_time += seen[0] == start_ns
            late += [seen[0] - start_ns] if seen[0] > start_ns else []
    loss = crossed(sent, received).received
    assert (loss.in_time, loss.late) == (in_time, len(late))
    assert loss.in_time + loss.late + loss.missed == len(times) - 1
    assert loss.late_max_s == (pytest.approx(max(late) / NS_PER_S) if late else None)
    assert loss.late_mean_s == (pytest.approx(sum(late) / len(late) / NS_PER_S) if late else None)


@given(st.sampled_from(Operator), st.integers(-9, 9))
def test_a_threshold_is_called_by_its_check(operator: Operator, value: int) -> None:
    threshold = Threshold(signal=Signal("/a", "x"), region=Region.where(operator, value))
    assert str(threshold) == f"/a x {operator.value} {value}"
