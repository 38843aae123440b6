# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page of a run: whole by itself, safe to open, bounded, and saying what happened."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from html.parser import HTMLParser
from importlib.resources import files
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.rate import Rate
from smarttestudo.visualizer.comparison import Comparison, compare
from smarttestudo.visualizer.report import (
    Fact,
    FloorPlan,
    PageInput,
    PathPoint,
    Rectangle,
    RuleText,
    TopicSeries,
    Zone,
    render_page,
)
from smarttestudo.visualizer.report.markup import tag
from smarttestudo.visualizer.report.rule_styles import DEFAULTS, OTHERS, STYLED_BLOCKS
from smarttestudo.visualizer.rate_series import RatePoint
from smarttestudo.visualizer.statistics import TopicStatistics
from smarttestudo.visualizer.table import printable
from visualizer.demo_like_page import SOURCES, demo_like_page

LARGEST_BYTES = 500_000
HOSTILE = (
    "<script>alert(1)</script><img src=x onerror=alert(2)> \" ' & </style> </svg> ]]> \x1b[31m \u202e \ud800"
)


def tree(html: str) -> ET.Element:
    """The document as XML, which is stricter than any browser."""
    return ET.fromstring(html.removeprefix("<!DOCTYPE html>\n"))


def all_text(html: str) -> str:
    return " ".join(" ".join(tree(html).itertext()).split())


def classes(html: str) -> set[str]:
    return {name for element in tree(html).iter() for name in element.get("class", "").split()}


def decided(t_s: float, topic: str, rate: Rate, rule: str | None = None, line: int | None = None) -> Decision:
    reason = Reason.DEFAULT if rule is None else Reason.BLOCK
    planned = PlannedRate(rate=rate, reason=reason, rule=rule, line=line)
    return Decision(t_s=t_s, stamp_ns=0, topic=topic, from_rate=None, planned=planned, values={})


def bare_page(**changes: object) -> PageInput:
    page = PageInput(
        title="A run", duration_s=10.0, comparison=Comparison(topics=()), series=(), decisions=()
    )
    return replace(page, **changes)  # type: ignore[arg-type]


def hostile_page() -> PageInput:
    """Every text of the page from a stranger."""
    half = TopicStatistics(
        messages=1, size_bytes=1, start_s=0.0, end_s=0.0, mean_hz=None, binned_hz=1.0, kb_per_s=1.0
    )
    decision = replace(
        decided(0.0, HOSTILE, Rate(2.0), HOSTILE, 3), values={f"{HOSTILE} {HOSTILE}": 1.0, HOSTILE: None}
    )
    return bare_page(
        title=HOSTILE,
        comparison=compare({HOSTILE: half}, {}),
        series=(TopicSeries(topic=HOSTILE, before=(RatePoint(t_s=1.0, lowest_hz=1, highest_hz=1),)),),
        decisions=(decision,),
        rules=(RuleText(path=HOSTILE, text=f"// {HOSTILE}\n{HOSTILE}"),),
        provenance=(Fact(label=HOSTILE, value=HOSTILE),),
        floor_plan=FloorPlan(
            zones=(Zone(name=HOSTILE, area=Rectangle(min_x_m=0, max_x_m=1, min_y_m=0, max_y_m=1)),)
        ),
    )


PAGES = {"demo": demo_like_page, "hostile": hostile_page, "bare": bare_page}


@pytest.mark.parametrize("page", PAGES.values(), ids=PAGES.keys())
def test_a_page_needs_nothing_from_outside_and_runs_nothing(page: type[PageInput]) -> None:
    document = tree(render_page(page()))
    assert not {"script", "link", "img", "iframe", "object", "embed", "base", "form", "a", "use", "image"} & {
        element.tag for element in document.iter()
    }
    for element in document.iter():
        for name in element.attrib:
            assert not name.lower().startswith("on")
            assert name not in {"src", "href", "style", "action", "srcset", "data"}


def test_a_page_names_no_address_at_all() -> None:
    html = render_page(demo_like_page())
    assert not re.search(r"https?:|url\(|@import|//[a-z]+\.", html)


def test_the_browser_is_told_to_load_nothing() -> None:
    policies = [
        element.get("content")
        for element in tree(render_page(bare_page())).iter("meta")
        if element.get("http-equiv") == "Content-Security-Policy"
    ]
    assert policies == ["default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"]


@pytest.mark.parametrize("page", PAGES.values(), ids=PAGES.keys())
def test_a_page_can_be_written_as_utf_8_and_is_small(page: type[PageInput]) -> None:
    assert len(render_page(page()).encode("utf-8")) < LARGEST_BYTES


def test_strangers_texts_are_shown_as_they_are() -> None:
    html = render_page(hostile_page())
    shown = " ".join(printable(HOSTILE).split())
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
    assert reader.text == printable(text)
    assert reader.elements == [{"aria-label": printable(text)}]


def test_the_same_run_gives_the_same_page() -> None:
    assert render_page(demo_like_page()) == render_page(demo_like_page())


def test_the_first_lines_say_what_happened() -> None:
    opening = all_text(render_page(demo_like_page()).replace("\N{NO-BREAK SPACE}", " ")).partition(
        "Rate of each"
    )[0]
    assert "A TurtleBot3 patrols a warehouse" in opening
    assert "−89 % bandwidth, 24 decisions" in opening
    assert "Default 192.3 MB/s SmartTestudo 20.9 MB/s" in opening


def test_every_topic_has_a_chart_and_every_decision_a_line() -> None:
    page = demo_like_page()
    document = tree(render_page(page))
    charts = [element for element in document.iter("svg") if element.get("class") == "rate"]
    assert len(charts) == len(SOURCES)
    decisions = next(one for one in document.iter("figure") if "decisions" in one.get("class", ""))
    lines = [" ".join(" ".join(row.itertext()).split()) for row in decisions.iter("tr")]
    assert len(lines) == 1 + len(page.decisions)
    assert lines[1] == (
        "0.0 /odom start → 10 Hz Scaffolding · line 25 · unknown /odom pose_x = unknown, pose_y = unknown"
    )
    assert "31.2 /odom 10 Hz → 4 Hz Warehouse Corridor · line 14 /odom pose_x = 2.1, pose_y = 2.1" in lines


def test_the_path_is_drawn_in_the_looks_of_the_deciding_rules() -> None:
    document = tree(render_page(demo_like_page()))
    floor = next(element for element in document.iter("svg") if element.get("class") == "map")
    looks = [
        element.get("class", "").removeprefix("path ")
        for element in floor.iter("polyline")
        if element.get("class", "").startswith("path ")
    ]
    assert looks == ["by-rule-2", "by-default", "by-rule-1", "by-rule-2", "by-default"]
    zones = [element.get("class") for element in floor.iter("rect") if "zone" in element.get("class", "")]
    assert zones == ["zone by-rule-1", "zone by-rule-2"]


def test_every_class_on_the_page_has_a_look() -> None:
    style = files("smarttestudo.visualizer.report").joinpath("report.css").read_text(encoding="utf-8")
    looks = {f"by-rule-{index}" for index in range(1, STYLED_BLOCKS + 1)}
    used = classes(render_page(demo_like_page())) | looks | {DEFAULTS.css_class, OTHERS.css_class}
    assert {name for name in used if f".{name}" not in style} == set()


def test_more_rules_than_looks_share_one_and_are_still_named_in_the_decisions() -> None:
    decisions = tuple(
        decided(float(at), "/odom", Rate(1.0), f"Rule {at}", at) for at in range(STYLED_BLOCKS + 2)
    )
    html = render_page(bare_page(decisions=decisions, series=(TopicSeries(topic="/odom"),)))
    assert OTHERS.name in all_text(html)
    assert all(f"Rule {at} " in all_text(html) for at in range(STYLED_BLOCKS + 2))


def test_blocks_of_one_name_are_told_apart_by_their_lines() -> None:
    decisions = (decided(0.0, "/odom", Rate(1.0), "Hall", 3), decided(5.0, "/odom", Rate(1.0), "Hall", 9))
    html = render_page(bare_page(decisions=decisions, series=(TopicSeries(topic="/odom"),)))
    assert {"Hall (line 3)", "Hall (line 9)"} <= {element.text for element in tree(html).iter("span")}


def test_a_run_without_place_rules_or_series_has_a_page_too() -> None:
    text = all_text(render_page(bare_page()))
    assert "0 decisions" in text
    assert "Frequency" in text


@pytest.mark.parametrize("place", [math.nan, math.inf, -math.inf, 1e300])
def test_an_impossible_place_is_left_out_of_the_map(place: float) -> None:
    path = (
        PathPoint(t_s=0.0, x_m=0.0, y_m=0.0),
        PathPoint(t_s=1.0, x_m=place, y_m=1.0),
        PathPoint(t_s=2.0, x_m=3.0, y_m=4.0),
    )
    without = (path[0], path[2])
    assert render_page(bare_page(path=path)) == render_page(bare_page(path=without))
    assert 'class="map"' not in render_page(bare_page(path=path[1:2]))


def test_a_long_run_makes_no_larger_page() -> None:
    """A day at 25 Hz with a decision every second."""
    seconds = 86_400
    path = tuple(
        PathPoint(t_s=at / 10, x_m=math.cos(at / 500) * at / 1e4, y_m=math.sin(at / 500) * at / 1e4)
        for at in range(seconds * 2)
    )
    decisions = tuple(
        decided(float(at), "/odom", Rate(float(at % 7)), ("A", "B", None)[at % 3], 1 + at % 3)
        for at in range(0, seconds, 10)
    )
    points = tuple(RatePoint(t_s=at * 288.0, lowest_hz=at % 5, highest_hz=at % 5 + 9) for at in range(300))
    series = tuple(TopicSeries(topic=topic, before=points, after=points) for topic in SOURCES)
    page = bare_page(
        duration_s=float(seconds),
        path=path,
        decisions=decisions,
        series=series,
        rules=(RuleText(path="long.adirf", text="// word\n" * 100_000),),
    )
    html = render_page(page)
    assert "… and 8,140 more in the decisions file." in html
    assert "The file goes on; this is its beginning." in html
    assert len(html.encode()) < LARGEST_BYTES


numbers = st.floats(allow_nan=True, allow_infinity=True)
points = st.builds(
    RatePoint, t_s=st.floats(0, 10), lowest_hz=st.integers(0, 9), highest_hz=st.integers(9, 10**6)
)
rates = st.builds(Rate, st.floats(0, 1e6)) | st.just(Rate.full()) | st.just(Rate.off())
pages = st.builds(
    bare_page,
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
        st.builds(
            TopicSeries,
            topic=st.sampled_from(["/a", "/c"]),
            before=st.lists(points, max_size=4).map(tuple),
            after=st.lists(points, max_size=4).map(tuple),
        ),
        max_size=2,
    ).map(tuple),
)


@settings(max_examples=100)
@given(pages)
def test_whatever_the_run_every_coordinate_is_a_finite_number(page: PageInput) -> None:
    for svg in tree(render_page(page)).iter("svg"):
        for element in svg.iter():
            for name in ("x", "y", "x1", "x2", "y1", "y2", "cx", "cy", "width", "height", "points", "d"):
                assert not re.search("nan|inf|e", element.get(name, ""), re.IGNORECASE)
