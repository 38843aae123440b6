# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page over many recordings: sums against naive ones, its size, and how it looks in a browser."""

from __future__ import annotations

import gc
import html
import random
import re
import tracemalloc
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from playwright.sync_api import Browser, Page, expect

from axe import WIDTHS_PX, violations
from report.fleet_totals_factory import DAY_S, MONDAY_S, fleet_report, recording, recordings, span_from
from report.golden_files import assert_reads_as, page_lines
from report.test_report_in_browser import assert_readable
from smarttestudo.report.fleet.numbers import RecordingNumbers
from smarttestudo.report.fleet.page import render_fleet_report
from smarttestudo.report.fleet.totals import MOST_COLUMNS, MOST_ROWS, FleetTotals, Step, Trend

GOLDEN = Path(__file__).parent / "golden"
made = st.builds(
    recording,
    robot=st.integers(0, 3),
    day=st.integers(0, 2000),
    shift=st.integers(0, 100),
    is_pair=st.just(True),
    topics=st.integers(0, 6),
)


def lost(one: RecordingNumbers) -> int:
    return sum(topic.messages - topic.received.messages for topic in one.topics if topic.received)


def total_of(numbers: list[RecordingNumbers], *, are_pairs: bool = True) -> FleetTotals:
    totals = FleetTotals(are_pairs=are_pairs)
    for one in numbers:
        totals.add(one)
    return totals


@given(st.lists(made, max_size=30))
def test_the_columns_add_up_to_all_recordings_in_the_order_of_time(numbers: list[RecordingNumbers]) -> None:
    totals = total_of(numbers)
    columns = totals.trend.columns()
    expected, of_topics = Counter[str](), Counter[str]()
    for one in numbers:
        for topic in one.topics:
            expected[topic.topic] += topic.messages
    for column in columns:
        for name, sums in column.topics.items():
            of_topics[name] += sums.messages
        assert column.total.messages == sum(sums.messages for sums in column.robots.values())
    assert of_topics == expected == Counter({name: one.messages for name, one in totals.topics.items()})
    assert totals.all.lost == sum(map(lost, numbers))
    assert sum(column.total.recordings for column in columns) == len(numbers)
    if totals.trend.step is Step.DAY:
        assert [column.first for column in columns] == sorted(column.first for column in columns)


@given(st.integers(1, 400), st.integers(1, 300), st.randoms(use_true_random=False))
def test_columns_are_bounded_whatever_the_days(days: int, each: int, order: random.Random) -> None:
    numbers = [recording(0, day * each, topics=1) for day in range(days)]
    order.shuffle(numbers)
    trend = Trend()
    for one in numbers:
        trend.add(one)
    columns = trend.columns()
    assert len(columns) <= MOST_COLUMNS
    assert sum(column.total.recordings for column in columns) == days
    ends = [end for column in columns for end in (column.first, column.last)]
    assert ends == sorted(ends)


@pytest.mark.parametrize(
    ("count", "step", "columns"),
    [(1, Step.RECORDING, 1), (MOST_COLUMNS, Step.RECORDING, 60), (MOST_COLUMNS + 1, Step.HOUR, 11)],
)
def test_a_day_has_a_column_for_each_recording_or_hour(count: int, step: Step, columns: int) -> None:
    trend = Trend()
    for number in range(count):
        trend.add(recording(0, 0, shift=number, topics=1))
    assert (trend.step, len(trend.columns()), trend.day) == (step, columns, "2026-11-02")


def test_three_years_of_days_are_joined_in_time() -> None:
    trend = Trend()
    for day in range(3000):
        trend.add(recording(0, day, topics=1))
    columns = trend.columns()
    assert len(columns) <= MOST_COLUMNS
    assert sum(len(column.steps) for column in columns) == 3000
    assert sum(column.total.recordings for column in columns) == 3000


def test_the_worst_recordings_are_those_that_a_sort_puts_first() -> None:
    numbers = list(recordings(1500))
    by_loss = sorted(
        numbers, key=lambda one: (-lost(one), -sum(t.received.size_bytes for t in one.topics if t.received))
    )
    assert total_of(numbers).worst == by_loss[:MOST_ROWS]
    alone = [replace(one, b=None) for one in recordings(300, is_pair=False)]
    assert total_of(alone, are_pairs=False).worst == alone[:MOST_ROWS]


@pytest.mark.full
def test_the_page_over_twice_as_many_recordings_is_as_large() -> None:
    sizes = [len(render_fleet_report(fleet_report(count))) for count in (3_000, 6_000)]
    assert sizes[1] < 1.1 * sizes[0]


@pytest.mark.full
def test_the_page_over_20_000_recordings_has_less_than_400_kb() -> None:
    assert len(render_fleet_report(fleet_report(20_000)).encode()) < 400_000


@pytest.mark.full
def test_memory_does_not_grow_with_the_number_of_recordings() -> None:
    totals = FleetTotals(are_pairs=True)
    tracemalloc.start()
    try:
        kept = []
        for number, one in enumerate(recordings(600)):
            # The same ten days again and again.
            totals.add(replace(one, span=span_from(MONDAY_S + number % 10 * DAY_S)))
            if number in (199, 599):
                gc.collect()
                # Threads that other tests left in this process hold memory of their own.
                ours = tracemalloc.take_snapshot().filter_traces([tracemalloc.Filter(True, "*/report/*")])
                kept.append(sum(trace.size for trace in ours.traces))
    finally:
        tracemalloc.stop()
    assert kept[1] < 1.2 * kept[0]


def test_thousands_of_topics_robots_and_lines_are_cut_and_counted() -> None:
    totals = FleetTotals(are_pairs=True)
    for number in range(300):
        one = recording(number, 0, topics=5)
        own = replace(one.topics[0], topic=f"/topic_{number}")
        totals.add(replace(one, topics=(own,), notices=("odd",)))
        totals.failures.add(f"bag_{number}: error: the file is empty")
    text = render_fleet_report(replace(fleet_report(1), totals=totals))
    for more in ("200 more recordings", "200 more topics", "200 more robots", "200 more notes"):
        assert f"… and {more}" in text
    assert "bag_99: error" in text
    assert "bag_100: error" not in text
    assert len(text) < 400_000


@pytest.mark.parametrize("is_pair", [True, False], ids=["pairs", "recordings"])
def test_the_page_reads_as_in_the_golden_file(*, is_pair: bool) -> None:
    name = "fleet-pairs" if is_pair else "fleet-recordings"
    text = render_fleet_report(fleet_report(12, is_pair=is_pair))
    assert_reads_as(GOLDEN / f"{name}.html", page_lines(text))


def test_the_page_loads_nothing_and_refers_to_reports_beside_it_alone() -> None:
    text = html.unescape(render_fleet_report(fleet_report(12)))
    named = set(re.findall(r"(?:src|href|url)\s*[=(]\s*[\"']?([^\"'\s)>]*)", text))
    assert named == {"#unreadable", "ada-01-0a1b2c3d.html", "ada-11-0a1b2c3d.html"}
    assert "default-src 'none'" in text


class Opened:
    """The page in a tab, and all that its browser complained of or asked for."""

    def __init__(self, browser: Browser, folder: Path, *, scripts: bool = True, is_pair: bool = True) -> None:
        path = folder / "report.html"
        path.write_text(render_fleet_report(fleet_report(60, is_pair=is_pair)), "utf-8")
        context = browser.new_context(offline=True, java_script_enabled=scripts)
        self.page: Page = context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(path.as_uri())


@pytest.mark.journey
def test_a_command_is_copied_and_tables_sort(browser: Browser, tmp_path: Path) -> None:
    opened = Opened(browser, tmp_path)
    table = opened.page.get_by_role("table", name="Robots")
    table.get_by_role("button", name="Robot", exact=True).click()
    expect(table.locator("tbody tr").first.locator("td").first).to_have_text("ada-00")
    row = opened.page.get_by_role("table", name="Recordings").locator("tbody tr").first
    row.get_by_text("Its report").click()
    expect(row.locator("code")).to_contain_text("testudo bag report /data/fleet/ada-11/")
    row.get_by_role("button", name="Copy").click()
    expect(row.get_by_role("button")).to_have_text("Copied")
    assert opened.complaints == []
    assert len(opened.requests) == 1


@pytest.mark.parametrize("scripts", [True, False], ids=["scripts", "no-scripts"])
def test_the_page_has_no_sideways_scroll_and_letters_to_read_at_each_width(
    browser: Browser, tmp_path: Path, scripts: bool
) -> None:
    page = Opened(browser, tmp_path, scripts=scripts, is_pair=scripts).page
    for width in WIDTHS_PX:
        assert_readable(page, width)


def test_axe_finds_nothing(browser: Browser, tmp_path: Path) -> None:
    assert violations(Opened(browser, tmp_path).page) == []
