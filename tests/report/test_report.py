# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The report of a run: whole by itself, safe to open, bounded, and saying what happened."""

from __future__ import annotations

import base64
import hashlib
import math
import re
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from report.demo_like_report import SOURCES, demo_like_report, small_report
from report.golden_files import assert_reads_as, page_lines
from smarttestudo.bags.comparison import Comparison, compare
from smarttestudo.bags.incident_record import IncidentMark
from smarttestudo.bags.robot_path import PathPoint
from smarttestudo.bags.statistics import RecordingSpan, TopicStatistics, TraceAccumulator
from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.floor_plan import FloorPlan, FloorZone, Rectangle
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.remote_robots import RuleText
from smarttestudo.domain.texts import visible
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.report.document import render_report
from smarttestudo.report.markup import tag
from smarttestudo.report.page import style
from smarttestudo.report.rule_timeline import DEFAULTS, OTHERS, STYLED_BLOCKS
from smarttestudo.report.run_report import (
    Fact,
    RunReport,
    SeriesPoint,
    TopicHistory,
    TopicSeries,
    bandwidth_series,
    rate_series,
)
from smarttestudo.report.time_chart import MOST_LAYERS

GOLDEN = Path(__file__).parent / "golden"
LARGEST_BYTES = 500_000
HOSTILE = (
    "<script>alert(1)</script><img src=x onerror=alert(2)> \" ' & </style> </svg> ]]> \x1b[31m \u202e \ud800"
)


SCRIPT = re.compile(r"<script([^>]*)>(.*?)</script>", re.DOTALL)
ONE_HZ = TopicHistory(
    rate_hz=(SeriesPoint(t_s=1.0, lowest=1, mean=1, highest=1),),
    kb_per_s=(SeriesPoint(t_s=1.0, lowest=1, mean=1, highest=1),),
)


def tree(html: str) -> ET.Element:
    """The document without its scripts as XML, which is stricter than any browser."""
    return ET.fromstring(SCRIPT.sub("", html).removeprefix("<!DOCTYPE html>\n"))


def all_text(html: str) -> str:
    return " ".join(" ".join(tree(html.replace("<wbr/>", "")).itertext()).split())


def classes(html: str) -> set[str]:
    return {name for element in tree(html).iter() for name in element.get("class", "").split()}


def decided(t_s: float, topic: str, rate: Rate, rule: str | None = None, line: int | None = None) -> Decision:
    reason = Reason.DEFAULT if rule is None else Reason.BLOCK
    planned = PlannedRate(rate=rate, reason=reason, rule=rule, line=line)
    return Decision(t_s=t_s, stamp_ns=0, topic=topic, from_rate=None, planned=planned, values={})


def bare_report(**changes: object) -> RunReport:
    report = RunReport(
        title="A run", duration_s=10.0, comparison=Comparison(topics=()), series=(), decisions=()
    )
    return replace(report, **changes)  # type: ignore[arg-type]


def hostile_report() -> RunReport:
    """Every text of the page from a stranger."""
    half = TopicStatistics(
        messages=1, size_bytes=1, start_s=0.0, end_s=0.0, mean_hz=None, binned_hz=1.0, kb_per_s=1.0
    )
    decision = replace(
        decided(0.0, HOSTILE, Rate(2.0), HOSTILE, 3), values={f"{HOSTILE} {HOSTILE}": 1.0, HOSTILE: None}
    )
    return bare_report(
        title=HOSTILE,
        comparison=compare({HOSTILE: half}, {}),
        series=(TopicSeries(topic=HOSTILE, before=ONE_HZ, after=ONE_HZ),),
        decisions=(decision,),
        rules=(RuleText(name=HOSTILE, text=f"// {HOSTILE}\n{HOSTILE}"),),
        provenance=(Fact(label=HOSTILE, value=HOSTILE),),
        incident=IncidentMark(name=HOSTILE, at_s=5.0, text=HOSTILE),
        floor_plan=FloorPlan(
            zones=(FloorZone(name=HOSTILE, area=Rectangle(min_x_m=0, max_x_m=1, min_y_m=0, max_y_m=1)),)
        ),
    )


def many_rules_report() -> RunReport:
    """More rules than there are styles, of which two have one name."""
    rules = [("Hall", 3), ("Hall", 9), *((f"Rule {at}", 10 + at) for at in range(STYLED_BLOCKS))]
    decisions = [decided(float(at), "/odom", Rate(1.0), *rule) for at, rule in enumerate(rules)]
    return bare_report(decisions=tuple(decisions), series=(TopicSeries(topic="/odom"),))


@cache
def html_of(name: str) -> str:
    """The page of one of three reports."""
    reports = {"demo": demo_like_report(), "hostile": hostile_report(), "bare": bare_report()}
    return render_report(reports[name])


EACH = pytest.mark.parametrize("name", ["demo", "hostile", "bare"])


@EACH
def test_a_report_refers_to_nothing_outside(name: str) -> None:
    document = tree(html_of(name))
    assert not {"link", "img", "iframe", "object", "embed", "base", "form", "a", "use", "image"} & {
        element.tag for element in document.iter()
    }
    for element in document.iter():
        for key in element.attrib:
            assert not key.lower().startswith("on")
            assert key not in {"src", "href", "style", "action", "srcset", "data"}


def test_a_report_names_no_address_but_that_of_the_language_of_its_drawings() -> None:
    html = html_of("demo")
    addresses = re.findall(r"https?:[^\s\"')]*|url\(|@import", html)
    assert set(addresses) == {"http://www.w3.org/2000/svg"}


@EACH
def test_the_browser_is_told_to_run_the_reports_own_script_and_to_load_nothing(name: str) -> None:
    html = html_of(name)
    (policy,) = [
        element.get("content", "")
        for element in tree(html).iter("meta")
        if element.get("http-equiv") == "Content-Security-Policy"
    ]
    (data_kind, _), (script_kind, script) = SCRIPT.findall(html)
    (style,) = re.findall(r"<style>(.*?)</style>", html, re.DOTALL)
    assert 'type="application/json"' in data_kind
    assert script_kind == ""
    assert policy == (
        f"default-src 'none'; script-src '{digest(script)}'; style-src '{digest(style)}'; "
        "base-uri 'none'; form-action 'none'"
    )


def digest(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


@EACH
def test_a_report_can_be_written_as_utf_8_and_is_small(name: str) -> None:
    assert len(html_of(name).encode("utf-8")) < LARGEST_BYTES


def test_strangers_texts_are_shown_as_they_are() -> None:
    html = html_of("hostile")
    shown = " ".join(visible(HOSTILE).split())
    assert "\x1b" not in html
    assert "\u202e" not in html
    # Title, heading, chart, two tables, zone, two legends, decision (4), rules (3), fact (2).
    assert all_text(html).count(shown) >= 17


class Reader(HTMLParser):
    """What a browser makes of one element: its text and its attribute."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.elements: list[dict[str, str | None]] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append(dict(attrs))

    def handle_data(self, data: str) -> None:
        self.text += data


@given(st.text(st.characters(codec=None, exclude_characters="\n\t"), max_size=30) | st.just(HOSTILE))
def test_any_text_comes_back_from_a_browser_as_it_was(text: str) -> None:
    reader = Reader()
    reader.feed(tag("p", text, aria_label=text).html)
    reader.close()
    assert reader.text == visible(text)
    assert reader.elements == [{"aria-label": visible(text)}]


def test_pages_read_as_in_the_golden_files() -> None:
    pages = {"demo": small_report(), "bare": bare_report(), "rules": many_rules_report()}
    for name, report in pages.items():
        assert_reads_as(GOLDEN / f"page-{name}.html", page_lines(render_report(report)))


def test_every_class_on_the_page_has_a_look() -> None:
    styles = {f"by-rule-{index}" for index in range(1, STYLED_BLOCKS + 1)}
    made_by_scripts = {"time-bar", "scripted", "robot", "known", "zoomed", "shown-path", "cursor", "chosen"}
    shares = {f"share-{index}" for index in range(1, MOST_LAYERS + 2)}
    used = (
        classes(html_of("demo")) | made_by_scripts | shares | styles | {DEFAULTS.css_class, OTHERS.css_class}
    )
    assert {name for name in used if f".{name}" not in style()} == set()


@pytest.mark.parametrize("place", [math.nan, math.inf, -math.inf, 1e300])
def test_an_impossible_place_is_left_out_of_the_map(place: float) -> None:
    path = (
        PathPoint(t_s=0.0, x_m=0.0, y_m=0.0),
        PathPoint(t_s=1.0, x_m=place, y_m=1.0),
        PathPoint(t_s=2.0, x_m=3.0, y_m=4.0),
    )
    without = (path[0], path[2])
    assert render_report(bare_report(path=path)) == render_report(bare_report(path=without))
    assert 'class="map"' not in render_report(bare_report(path=path[1:2]))


@pytest.mark.full
def test_a_long_run_makes_no_larger_page() -> None:
    """A day at 25 Hz with a decision every second."""
    seconds = 86_400
    path = tuple(
        PathPoint(t_s=at / 10, x_m=math.cos(at / 500) * at / 1e4, y_m=math.sin(at / 500) * at / 1e4)
        for at in range(seconds * 2)
    )
    decisions = tuple(
        decided(at + 0.1 * index, topic, Rate(float(at % 7)), ("A", "B", None)[at % 3], 1 + at % 3)
        for index, topic in enumerate(SOURCES)
        for at in range(0, seconds, 60)
    )
    points = tuple(
        SeriesPoint(t_s=at * 43.2, lowest=at % 5, mean=at % 5 + 3.14159, highest=at % 5 + 9)
        for at in range(2000)
    )
    history = TopicHistory(rate_hz=points, kb_per_s=points)
    names = (*SOURCES, *(f"/sensors/device_{number}/measured_values" for number in range(30)))
    statistics = TopicStatistics(
        messages=1, size_bytes=1, start_s=0.0, end_s=0.0, mean_hz=None, binned_hz=1.0, kb_per_s=1.0
    )
    both = dict.fromkeys(names, statistics)
    report = bare_report(
        duration_s=float(seconds),
        path=path,
        comparison=compare(both, both),
        decisions=decisions,
        series=tuple(TopicSeries(topic=topic, before=history, after=history) for topic in names),
        total=TopicSeries(topic="All topics", before=history, after=history),
        rules=(RuleText(name="long.adirf", text="// word\n" * 100_000),),
    )
    html = render_report(report)
    assert "… and 12 760 more in the decisions file." in html
    assert "The file goes on; this is its beginning." in html
    assert "In the tables: 15 more topics." in html
    assert len(html.encode()) < LARGEST_BYTES


def test_a_spike_of_one_second_is_seen_in_the_chart_of_a_day() -> None:
    trace = TraceAccumulator()
    for second in range(86_400):
        for _ in range(40 if second == 70_000 else 2):
            trace.add(second * NS_PER_S, 100)
    span = RecordingSpan(start_ns=0, end_ns=86_400 * NS_PER_S)
    history = TopicHistory(rate_hz=rate_series(trace, span), kb_per_s=bandwidth_series([trace], span))
    series = TopicSeries(topic="/estop", before=history)
    html = render_report(bare_report(duration_s=86_400.0, series=(series,), total=series))
    drawing = next(one for one in tree(html).iter("svg") if one.get("class") == "over-time strip-chart")
    (area,) = (one for one in drawing.iter("polygon") if one.get("class") == "before")
    rates_hz = [float(point.partition(",")[2]) for point in area.get("points", "").split()]
    assert (min(rates_hz), max(rates_hz)) == (2, 40)


numbers = st.floats(allow_nan=True, allow_infinity=True)
points = st.builds(
    SeriesPoint,
    t_s=st.floats(0, 10),
    lowest=st.integers(0, 9),
    mean=st.just(9),
    highest=st.integers(9, 10**6),
)
series = st.tuples(points, points, points) | st.just(())
histories = st.builds(TopicHistory, rate_hz=series, kb_per_s=series)
rates = st.builds(Rate, st.floats(0, 1e6)) | st.just(Rate.full()) | st.just(Rate.off())
pages = st.builds(
    bare_report,
    duration_s=st.floats(0, 1e6),
    path=st.lists(st.builds(PathPoint, t_s=st.floats(0, 10), x_m=numbers, y_m=numbers), max_size=6).map(
        tuple
    ),
    decisions=st.lists(
        st.builds(
            decided, st.floats(0, 10), st.sampled_from(["/a", "/b"]), rates, st.none() | st.text(max_size=3)
        ),
        max_size=6,
    ).map(tuple),
    series=st.lists(
        st.builds(TopicSeries, topic=st.sampled_from(["/a", "/c"]), before=histories, after=histories),
        max_size=2,
    ).map(tuple),
)


@settings(max_examples=100)
@given(pages)
def test_whatever_the_run_every_coordinate_is_a_finite_number(report: RunReport) -> None:
    for svg in tree(render_report(report)).iter("svg"):
        for element in svg.iter():
            for name in (
                "x",
                "y",
                "x1",
                "x2",
                "y1",
                "y2",
                "cx",
                "cy",
                "width",
                "height",
                "points",
                "d",
                "viewBox",
            ):
                assert not re.search("nan|inf|e", element.get(name, ""), re.IGNORECASE)
