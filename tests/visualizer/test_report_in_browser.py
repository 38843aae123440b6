# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The report in a real browser, from a file, without a network."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from real_browser import chromium
from smarttestudo.visualizer.report import RunReport, render_report
from visualizer.demo_like_report import demo_like_report
from visualizer.test_report import hostile_report

SHARES_OF_WIDTH = """lines => lines.map(
    (line) => new DOMMatrix(getComputedStyle(line).transform).e / line.parentNode.clientWidth,
)"""


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium() as browser:
        yield browser


class Opened:
    """A report in a tab, and everything that its browser complained of or asked for."""

    def __init__(self, browser: Browser, folder: Path, report: RunReport, *, scripts: bool = True) -> None:
        path = folder / "report.html"
        path.write_text(render_report(report), "utf-8")
        context = browser.new_context(
            offline=True, java_script_enabled=scripts, viewport={"width": 1280, "height": 900}
        )
        self.page: Page = context.new_page()
        self.complaints: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.complaints.append(message.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("dialog", lambda dialog: self.complaints.append(dialog.message))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(path.as_uri())

    def chart(self, name: str) -> Locator:
        return self.page.locator(f'figure[data-chart="{name}"]')

    def point_at(self, chart: str, share: float) -> None:
        """Put the mouse over a chart, at a share of its width."""
        area = self.chart(chart).locator(".u-over")
        area.scroll_into_view_if_needed()
        box = area.bounding_box()
        assert box is not None
        self.page.mouse.move(box["x"] + share * box["width"], box["y"] + box["height"] / 2)

    @property
    def words(self) -> Locator:
        return self.page.locator(".time-bar output")

    @property
    def robot(self) -> tuple[float, float]:
        marker = self.page.locator(".robot.known")
        return float(marker.get_attribute("cx") or "nan"), float(marker.get_attribute("cy") or "nan")


@pytest.fixture
def opened(browser: Browser, tmp_path: Path) -> Opened:
    return Opened(browser, tmp_path, demo_like_report())


def test_a_report_opens_without_a_complaint_and_asks_for_nothing(opened: Opened) -> None:
    expect(opened.page.locator(".time-bar")).to_be_visible()
    assert opened.page.locator("canvas").count() == 12
    assert opened.complaints == []
    assert len(opened.requests) == 1


def test_strangers_texts_do_nothing_in_a_browser(browser: Browser, tmp_path: Path) -> None:
    opened = Opened(browser, tmp_path, hostile_report())
    expect(opened.page.locator(".time-bar")).to_be_visible()
    assert opened.complaints == []
    assert len(opened.requests) == 1


def test_the_cursor_is_at_one_time_in_all_charts_on_the_map_and_in_words(opened: Opened) -> None:
    opened.point_at("rate 0", 0.5)
    expect(opened.words).to_contain_text("Scaffolding")
    expect(opened.chart("rate 6").locator(".readout")).to_have_text("195 → 10 Hz")
    expect(opened.chart("total").locator(".readout")).to_contain_text("KB/s")
    lines = opened.page.locator(".u-cursor-x").evaluate_all(SHARES_OF_WIDTH)
    assert len(lines) == 12
    assert max(lines) - min(lines) < 0.02
    middle = opened.robot
    opened.point_at("lanes", 0.9)
    expect(opened.words).not_to_contain_text("Scaffolding")
    assert opened.robot != middle


def test_pointing_at_the_path_moves_the_cursor_of_the_charts(opened: Opened) -> None:
    opened.point_at("rate 0", 0.5)
    before = opened.words.inner_text()
    opened.page.locator("svg.map .start").hover()
    expect(opened.words).not_to_have_text(before)
    expect(opened.words).to_contain_text("0.0 s")


def test_dragging_across_one_chart_zooms_all_and_a_button_shows_the_whole_run(opened: Opened) -> None:
    whole_run = opened.page.get_by_role("button", name="Whole run")
    expect(whole_run).to_be_disabled()
    opened.point_at("total", 0.25)
    opened.page.mouse.down()
    opened.point_at("total", 0.5)
    opened.page.mouse.up()
    expect(whole_run).to_be_enabled()
    expect(opened.page.locator("svg.map.zoomed .shown-path")).to_have_attribute("points", re.compile(","))
    opened.point_at("rate 0", 0.0)
    started = float(opened.words.inner_text().split(" s")[0])
    opened.point_at("stack", 0.995)
    ended = float(opened.words.inner_text().split(" s")[0])
    assert started == pytest.approx(50, abs=3)
    assert ended == pytest.approx(100, abs=3)
    whole_run.click()
    expect(whole_run).to_be_disabled()


def test_the_keyboard_reaches_the_time_the_tables_and_the_decisions(opened: Opened) -> None:
    slider = opened.page.get_by_role("slider")
    slider.focus()
    opened.page.keyboard.press("End")
    expect(opened.words).to_contain_text("200.0 s")
    opened.page.get_by_role("button", name="Show 31.2 s").first.press("Enter")
    expect(opened.words).to_contain_text("31.3 s")
    table = opened.page.get_by_role("table", name="Frequency")
    heading = table.get_by_role("columnheader", name="Change")
    heading.get_by_role("button").press("Enter")
    expect(heading).to_have_attribute("aria-sort", "ascending")
    cells = table.locator("tbody td:nth-child(4)").all_inner_texts()
    changes = [float(text.replace("−", "-")) for text in cells]
    assert changes == sorted(changes)
    assert len(changes) == 9


def test_without_scripts_every_drawing_and_number_is_there(browser: Browser, tmp_path: Path) -> None:
    opened = Opened(browser, tmp_path, demo_like_report(), scripts=False)
    assert opened.page.locator("svg.static:visible").count() == 12
    expect(opened.page.locator(".time-bar")).to_have_count(0)
    words = opened.page.locator("body").inner_text().replace("\N{NO-BREAK SPACE}", " ")
    for text in (
        "−89 % bandwidth, 24 decisions, /odom error 1.3 cm",
        "0.4 cm",
        "31.2",
        "180,380.00",
        "20,861.96",
    ):
        assert text in words
    assert opened.requests == [opened.page.url]


def test_on_paper_the_drawings_take_the_place_of_the_charts(opened: Opened) -> None:
    expect(opened.page.locator(".time-bar")).to_be_visible()
    assert opened.page.locator("svg.static:visible").count() == 0
    opened.page.emulate_media(media="print")
    assert opened.page.locator("svg.static:visible").count() == 12
    assert opened.page.locator("canvas:visible").count() == 0
    expect(opened.page.locator(".time-bar")).to_be_hidden()
