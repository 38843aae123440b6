# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Maps and charts put things where they belong."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.bags.comparison import Comparison
from smarttestudo.bags.robot_path import PathPoint
from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.floor_plan import FloorPlan, FloorZone, Rectangle
from smarttestudo.domain.rate import Rate
from smarttestudo.report.axes import Scale, multiples, number, round_step
from smarttestudo.report.floor_map import draw_floor_map, floor_map, path_pieces, thinned
from smarttestudo.report.rule_timeline import DecidingBlock, RuleSpan, RuleStyles, block_at
from smarttestudo.report.run_report import RunReport, SeriesPoint, TopicHistory, TopicSeries
from smarttestudo.report.time_chart import Run, rate_charts, stacked_chart
from smarttestudo.report.time_drawing import SMALL, WIDE, draw_chart

BLOCK = DecidingBlock(rule="Hall", line=3)
SPANS = (RuleSpan(start_s=0.0, end_s=5.0, block=None), RuleSpan(start_s=5.0, end_s=9.0, block=BLOCK))


def constant(hz: int) -> TopicHistory:
    return TopicHistory(
        rate_hz=tuple(SeriesPoint(t_s=at + 0.5, lowest=hz, mean=hz, highest=hz) for at in range(10))
    )


def chart(before_hz: int, after_hz: int, target: Rate | None = None) -> ET.Element:
    series = TopicSeries(topic="/imu", before=constant(before_hz), after=constant(after_hz))
    (drawn,) = rate_charts(report_of(series, () if target is None else (decided(target),)))
    return ET.fromstring(draw_chart(drawn, SMALL, 100).html)


def report_of(series: TopicSeries, decisions: tuple[Decision, ...] = ()) -> RunReport:
    return RunReport(
        title="", duration_s=10.0, comparison=Comparison(topics=()), series=(series,), decisions=decisions
    )


def decided(rate: Rate) -> Decision:
    planned = PlannedRate(rate=rate, reason=Reason.DEFAULT, rule=None, line=None)
    return Decision(t_s=0.0, stamp_ns=0, topic="/imu", from_rate=None, planned=planned, values={})


def height(drawing: ET.Element, line: str) -> float:
    """The place in pixels from the top of the drawing at which a line begins."""
    plot = next(one for one in drawing.iter("svg") if one.get("class") == "plot")
    found = next(one for one in plot.iter("polyline") if one.get("class") == line)
    value = float(found.get("points", "").split()[0].partition(",")[2])
    _, top, _, tall = map(float, plot.get("viewBox", "").split())
    return float(plot.get("y", "")) + (-value - top) / tall * float(plot.get("height", ""))


def labels(drawing: ET.Element) -> dict[str, float]:
    """Heights of the texts, without those under the time axis."""
    texts = (text for text in drawing.iter("text") if text.get("text-anchor") != "middle")
    return {text.text or "": float(text.get("y", "0")) for text in texts}


def map_of(path: list[tuple[float, float]], *zones: FloorZone) -> ET.Element:
    points = [PathPoint(t_s=float(at), x_m=x_m, y_m=y_m) for at, (x_m, y_m) in enumerate(path)]
    floor = floor_map(FloorPlan(zones=zones), points, SPANS, RuleStyles(SPANS))
    assert floor is not None
    return ET.fromstring(draw_floor_map(floor).html)


rising = st.lists(st.floats(0, 1e6), min_size=2, max_size=5, unique=True).map(sorted)


@given(rising, st.floats(-1e6, 2e6), st.floats(-1e6, 2e6))
def test_a_scale_never_turns_back_and_stays_within_its_places(
    values: list[float], one: float, other: float
) -> None:
    places = tuple(float(index) for index in range(len(values)))
    scale = Scale(values=tuple(values), places=places)
    low, high = sorted((one, other))
    assert places[0] <= scale(low) <= scale(high) <= places[-1]
    assert [scale(value) for value in values] == list(places)


@given(st.floats(1e-6, 1e9))
def test_steps_are_the_next_1_2_or_5(wanted: float) -> None:
    step = round_step(wanted)
    assert step >= wanted * (1 - 1e-6)
    assert step / wanted < 2.5 + 1e-6
    assert round(step / 10 ** math.floor(math.log10(step) + 1e-9), 6) in {1, 2, 5}


def test_ticks_are_multiples_within_the_range() -> None:
    assert multiples(5.0, -13.2, 10.0) == [-10.0, -5.0, 0.0, 5.0, 10.0]


def test_a_rate_far_below_its_source_can_still_be_read() -> None:
    drawing = chart(195, 10)
    foot, ten, source = labels(drawing)["0"], labels(drawing)["10"], labels(drawing)["195"]
    assert source < ten < foot
    assert foot - ten > (foot - source) / 2
    assert height(drawing, "before") < height(drawing, "after") < foot - 20
    assert sum(line.get("class") == "gap" for line in drawing.iter("line")) == 2


def test_rates_near_each_other_share_an_axis_without_a_gap() -> None:
    drawing = chart(10, 7)
    assert not [line for line in drawing.iter("line") if line.get("class") == "gap"]
    foot = labels(drawing)["0"] - 3.5
    rises = [foot - height(drawing, line) for line in ("after", "before")]
    assert rises[0] / rises[1] == pytest.approx(0.7, abs=0.01)


@pytest.mark.parametrize(
    ("target", "steps"), [(Rate(4.0), 1), (Rate.off(), 1), (Rate.full(), 0), (Rate(1e6), 1)]
)
def test_a_planned_rate_is_a_step_and_full_is_none(target: Rate, steps: int) -> None:
    drawing = chart(5, 5, target)
    (line,) = (one for one in drawing.iter("path") if one.get("class") == "target")
    assert line.get("d", "").count("M") == steps
    assert labels(drawing)["0"] - height(drawing, "after") > 30


@given(st.floats(1e-6, 1e9) | st.floats(-1e9, -1e-6) | st.just(0.0))
def test_a_number_on_a_drawing_has_no_exponent_and_six_right_digits(value: float) -> None:
    assert "e" not in number(value)
    assert float(number(value)) == pytest.approx(value, rel=1e-5, abs=1e-6)


def test_the_layers_of_a_stack_stand_on_each_other() -> None:
    points = [
        TopicHistory(kb_per_s=(SeriesPoint(t_s=1.0, lowest=kb, mean=kb, highest=kb),)) for kb in (20, 5)
    ]
    low, high = (TopicSeries(topic=f"/{index}", before=one) for index, one in enumerate(points))
    report = replace(report_of(low), series=(high, low))
    drawing = ET.fromstring(draw_chart(stacked_chart(report, Run.BEFORE), WIDE, 100).html)
    tops = {one.get("data-name"): one.get("points", "").split()[0] for one in drawing.iter("polygon")}
    assert tops == {"/0": "1,20", "/1": "1,25"}


def test_one_metre_is_as_long_in_x_as_in_y() -> None:
    drawing = map_of([(0, 0), (30, 0), (30, 10)])
    line = next(one for one in drawing.iter("polyline") if one.get("class") == "path-edge")
    (x0, y0), (x1, _), (_, y2) = (map(float, place.split(",")) for place in line.get("points", "").split())
    assert (x1 - x0) / 30 == pytest.approx((y0 - y2) / 10, rel=0.01)
    assert y2 < y0


def test_a_robot_that_stands_still_has_a_map() -> None:
    assert "Start, end" in labels(map_of([(3.0, 4.0), (3.0, 4.0)]))


def test_start_and_end_are_named_where_they_are() -> None:
    drawing = map_of([(0.0, 0.0), (3.0, 4.0)])
    assert labels(drawing)["End"] < labels(drawing)["Start"] - 100


def test_a_zones_name_keeps_out_of_the_paths_way() -> None:
    zone = FloorZone(name="Hall", area=Rectangle(min_x_m=0, max_x_m=10, min_y_m=0, max_y_m=10))
    free = map_of([(5.0, 5.0), (6.0, 5.0)], zone)
    crossed = map_of([(step / 20, 9.8) for step in range(100)], zone)
    (free_at,), (crossed_at,) = (
        [
            (float(text.get("x", "")), float(text.get("y", "")))
            for text in one.iter("text")
            if text.text == "Hall"
        ]
        for one in (free, crossed)
    )
    assert crossed_at[0] > free_at[0] + 100
    assert crossed_at[1] == pytest.approx(free_at[1], abs=1)


def test_times_are_written_where_the_robot_was() -> None:
    drawing = map_of([(float(at), 0.0) for at in range(61)])
    times = [text.text for text in drawing.iter("text") if text.get("class") == "passing-time"]
    assert times == ["20 s", "40 s"]


paths = st.lists(
    st.builds(PathPoint, t_s=st.floats(0, 9), x_m=st.floats(-9, 9), y_m=st.floats(-9, 9)), max_size=30
).map(lambda path: sorted(path, key=lambda point: point.t_s))


@given(paths)
def test_pieces_join_to_the_whole_path_and_each_has_its_block(path: list[PathPoint]) -> None:
    pieces = list(path_pieces(path, SPANS))
    for before, after in pairwise(pieces):
        assert before.points[-1] == after.points[0]
    own = [
        (point, piece.block)
        for piece in pieces
        for point in piece.points[: None if piece is pieces[-1] else -1]
    ]
    assert own == [(point, block_at(SPANS, point.t_s)) for point in path]


@given(paths.filter(bool), st.integers(2, 10))
def test_a_thinned_path_keeps_its_ends_and_its_bound(path: list[PathPoint], max_points: int) -> None:
    kept = thinned(path, max_points)
    assert len(kept) <= max_points + 2
    assert (kept[0], kept[-1]) == (path[0], path[-1])
