# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Figures as files: all that were asked for, the same each time, readable without colour."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from report.demo_like_report import small_report
from smarttestudo.bags.comparison import Comparison
from smarttestudo.bags.statistics import IntervalHistogram
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.files.whole_file import OutputFileError
from smarttestudo.report.figures.charts import rates_figure, total_figure
from smarttestudo.report.figures.draw import draw_figures
from smarttestudo.report.figures.styles import HATCHES, rule_line
from smarttestudo.report.rule_timeline import DEFAULTS, OTHERS, STYLED_BLOCKS, RuleStyle
from smarttestudo.report.run_report import FigureKind, RunReport, SeriesPoint, TopicHistory, TopicSeries
from smarttestudo.report.time_chart import MOST_LAYERS, rate_charts
from smarttestudo.report.time_drawing import SMALL, draw_chart

EMPTY = RunReport(title="", duration_s=0.0, comparison=Comparison(topics=()), series=(), decisions=())


def drawn_report() -> RunReport:
    """Two topics of the demo with intervals, so that drawing it takes little time."""
    report = small_report()
    histogram = IntervalHistogram()
    for stamp_ns in range(0, 100 * 40_000_000, 40_000_000):
        histogram.record(stamp_ns)
    series = tuple(
        replace(one, before=replace(one.before, intervals=histogram.bins())) for one in report.series[:2]
    )
    return replace(report, series=series, budget_kb_per_s=30.0)


@pytest.mark.full
def test_each_figure_is_a_png_and_an_svg_of_the_same_bytes_each_time(tmp_path: Path) -> None:
    report = drawn_report()
    once, again = (draw_figures(report, list(FigureKind), tmp_path / name) for name in ("once", "again"))
    assert {path.name for path in once} == {
        f"{kind.value}.{form}" for kind in FigureKind for form in ("png", "svg")
    }
    for one, other in zip(once, again, strict=True):
        assert one.read_bytes() == other.read_bytes()
        assert one.stat().st_size > 5000


def test_a_figure_shows_the_lines_and_labels_of_the_report() -> None:
    report = drawn_report()
    figure = rates_figure(report)
    assert figure is not None
    for axes, chart in zip(figure.axes, rate_charts(report), strict=True):
        drawing = ET.fromstring(draw_chart(chart, SMALL, 1000).html)
        lines = [one.get("points", "").split() for one in drawing.iter("polyline")]
        for drawn, points in zip(axes.lines, lines, strict=False):
            heights = [float(point.partition(",")[2]) for point in points]
            assert np.asarray(drawn.get_ydata()).tolist() == pytest.approx(heights, rel=1e-4)
        labels = [one.text for one in drawing.iter("text") if one.get("text-anchor") == "end"]
        assert [label.get_text() for label in axes.get_yticklabels()] == labels[:-1]


@pytest.mark.parametrize(("budget", "labels"), [(30.0, {"budget  30.0 KB/s"}), (None, set())])
def test_a_budget_is_a_line_across_the_load(budget: float | None, labels: set[str]) -> None:
    figure = total_figure(replace(drawn_report(), budget_kb_per_s=budget))
    assert figure is not None
    drawn = [str(line.get_label()) for axes in figure.axes for line in axes.lines]
    assert {label for label in drawn if label.startswith("budget")} == labels


def test_only_what_was_asked_for_and_can_be_drawn_is_written(tmp_path: Path) -> None:
    assert draw_figures(EMPTY, list(FigureKind), tmp_path / "none") == []
    written = draw_figures(drawn_report(), {FigureKind.PATH}, tmp_path)
    assert [path.name for path in written] == ["path.png", "path.svg"]


def test_names_from_strangers_are_drawn_as_they_are(tmp_path: Path) -> None:
    history = TopicHistory(rate_hz=(SeriesPoint(t_s=1.0, lowest=1, mean=1, highest=1),))
    names = ("/$x^$", "/{a}", "/<script>")
    report = replace(
        EMPTY, duration_s=2.0, series=tuple(TopicSeries(topic=name, before=history) for name in names)
    )
    draw_figures(report, {FigureKind.RATES}, tmp_path)
    assert "<script>" not in (tmp_path / "rates.svg").read_text()


@pytest.mark.full
@pytest.mark.parametrize("kind", [FigureKind.RATES, FigureKind.TOTAL, FigureKind.INTERVALS])
def test_a_figure_is_no_wider_for_a_name_without_end(tmp_path: Path, kind: FigureKind) -> None:
    report = drawn_report()
    widths = []
    for name in (f"/{'w' * 59}", f"/{'w' * 999}"):
        first, *others = report.series
        draw_figures(replace(report, series=(replace(first, topic=name), *others)), {kind}, tmp_path)
        with Image.open(tmp_path / f"{kind.value}.png") as image:
            widths.append(image.width)
    assert widths[1] == pytest.approx(widths[0], rel=0.1)


def test_a_folder_that_cannot_be_made_is_told_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "figures").touch()
    cause = "the figures cannot be written: a file is there in place of a folder; name another place"
    with pytest.raises(OutputFileError, match=rf"figures: error: {cause}"):
        draw_figures(drawn_report(), {FigureKind.PATH}, tmp_path / "figures")


def test_styles_differ_by_more_than_their_colour() -> None:
    own = [RuleStyle(css_class=f"by-rule-{index}", name="") for index in range(1, STYLED_BLOCKS + 1)]
    lines = [rule_line(style) for style in (*own, DEFAULTS, OTHERS)]
    assert len({(line.dash, line.width) for line in lines}) == len(lines)
    assert len(HATCHES) == MOST_LAYERS + 1
    assert all(one != other for one, other in pairwise(HATCHES))


@given(st.lists(st.integers(1, 10**12), min_size=1, max_size=50))
def test_every_interval_lies_in_the_bin_that_counts_it(intervals_ns: list[int]) -> None:
    histogram = IntervalHistogram()
    stamp_ns = 0
    histogram.record(stamp_ns)
    for interval_ns in intervals_ns:
        stamp_ns += interval_ns
        histogram.record(stamp_ns)
    bins = histogram.bins()
    assert sum(one.count for one in bins) == len(intervals_ns)
    for one in bins:
        inside = [
            interval_ns
            for interval_ns in intervals_ns
            if one.from_s * (1 - 1e-9) <= interval_ns / NS_PER_S < one.to_s * (1 + 1e-9)
        ]
        assert len(inside) >= one.count
