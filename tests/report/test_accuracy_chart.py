# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The drawing of messages against accuracy: every number at its place, in the report and in figures."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given
from hypothesis import strategies as st

from report.demo_like_report import demo_like_accuracy
from report.test_report import bare_report
from smarttestudo.accuracy.accuracy_curve import AccuracyCurve, AccuracyPoint, BoundCost, FixedPicture, Motion
from smarttestudo.accuracy.arms import PacedPicture
from smarttestudo.report.accuracy_curve import accuracy_chart, draw_accuracy
from smarttestudo.report.document import render_report

NUMBERS: dict[str, Any] = {
    "messages": st.integers(1, 10**7),
    "rmse": st.just(0.0),
    "worst": st.one_of(st.sampled_from([0.0, 5e-324, 1e-310]), st.floats(1e-9, 1e9)),
    "unknown": st.just(0),
}
COSTS = st.builds(
    BoundCost,
    within=st.builds(PacedPicture, **NUMBERS),
    fixed=st.builds(FixedPicture, hz=st.floats(0.1, math.inf), **NUMBERS),
)
CURVES = st.builds(
    AccuracyCurve,
    topic=st.just("/odom"),
    property_name=st.just("position"),
    unit=st.sampled_from(["m", ""]),
    messages=st.just(10**7),
    motion=st.just(Motion(mean_per_s=1.0, max_per_s=2.0)),
    points=st.lists(
        st.builds(
            AccuracyPoint, bound=st.floats(1e-3, 1e3), hold=COSTS, reckoned=st.one_of(st.none(), COSTS)
        ),
        min_size=1,
        max_size=5,
    ).map(tuple),
)


def drawn(curve: AccuracyCurve) -> ET.Element:
    chart = accuracy_chart(curve)
    assert chart is not None
    return ET.fromstring(draw_accuracy(chart).html)


def places(line: ET.Element) -> Iterator[tuple[float, float]]:
    for point in line.get("points", "").split():
        x, y = point.split(",")
        yield float(x), float(y)


def test_each_bound_lies_where_its_messages_and_worst_error_are() -> None:
    drawing = drawn(demo_like_accuracy())
    lines = {line.get("class"): list(places(line)) for line in drawing.iter("polyline")}
    assert lines.keys() == {"before", "after", "before reckoned", "after reckoned"}
    held = lines["after"]
    assert len(held) == 5
    # From 73 to 764 messages, and from 0.198 to 0.0099 m: as logarithms, evenly to the right and down.
    spread = math.log(764 / 73)
    for (x, y), (messages, worst) in zip(held, [(73, 0.198), (139, 0.099)], strict=False):
        share = math.log(messages / 73) / spread
        assert x == pytest.approx(held[0][0] + share * (held[-1][0] - held[0][0]), abs=1e-5)
        fallen = math.log(0.198 / worst) / math.log(20)
        assert y == pytest.approx(held[0][1] + fallen * (held[-1][1] - held[0][1]), abs=1e-5)


@given(CURVES)
def test_whatever_the_numbers_every_place_is_within_the_chart(curve: AccuracyCurve) -> None:
    chart = accuracy_chart(curve)
    costs = [cost for point in curve.points for cost in (point.hold, point.reckoned) if cost]
    if chart is None:
        assert not any(error.worst > 1e-300 for cost in costs for error in (cost.within, cost.fixed))
        return
    # A single label gives no scale.
    assert 2 <= len(chart.messages.ticks) <= 7
    assert 2 <= len(chart.errors.ticks) <= 7
    for line in ET.fromstring(draw_accuracy(chart).html).iter("polyline"):
        for x, y in places(line):
            assert 0 <= x <= 1
            assert 0 <= y <= 1


def test_where_every_message_passes_there_is_no_drawing_and_still_a_table() -> None:
    nothing = PacedPicture(messages=300, rmse=0.0, worst=0.0, unknown=0)
    fixed = FixedPicture(hz=math.inf, messages=300, rmse=0.0, worst=0.0, unknown=0)
    cost = BoundCost(within=nothing, fixed=fixed)
    curve = replace(demo_like_accuracy(), points=(AccuracyPoint(bound=0.01, hold=cost, reckoned=None),))
    assert accuracy_chart(curve) is None
    page = render_report(bare_report(accuracy_curve=curve))
    assert "What an accuracy costs" in page
    assert 'class="accuracy"' not in page
