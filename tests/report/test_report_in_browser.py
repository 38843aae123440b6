# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The report in a real browser, from a file, without a network."""

from __future__ import annotations

import re
from itertools import combinations, pairwise
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from axe import WIDTHS_PX, violations
from report.test_report import html_of

BOXES = """texts => texts.map((text) => {
    const { left, right, height } = text.getBoundingClientRect();
    return [left, right, height];
})"""
SHARES_OF_WIDTH = """lines => lines.map((line) => {
    const ground = line.parentNode.querySelector(".ground").getBoundingClientRect();
    return (line.getBoundingClientRect().left - ground.left) / ground.width;
})"""

LETTERS_PX = """texts => texts.map((text) => {
    const { a, b } = text.getScreenCTM();
    return parseFloat(getComputedStyle(text).fontSize) * Math.hypot(a, b);
})"""
SCROLLS_SIDEWAYS = "({ scrollWidth, clientWidth }) => scrollWidth > clientWidth"
# Of each lane its name and its bars, as top and bottom, and how far the name is from the left of the window.
LANES = """lanes => lanes.map((lane) => {
    const name = lane.querySelector(".lane-name").getBoundingClientRect();
    const bar = lane.querySelector(".bar").getBoundingClientRect();
    return [name.left, name.top, name.bottom, bar.left, bar.top, bar.bottom];
})"""
CUT_OFF = """names => names.filter((name) => {
    const { left, right } = name.getBoundingClientRect();
    return left < 0 || right > document.documentElement.clientWidth;
}).map((name) => name.textContent)"""


class Opened:
    """A report in a tab, and everything that its browser complained of or asked for."""

    def __init__(self, browser: Browser, folder: Path, name: str = "demo", *, scripts: bool = True) -> None:
        path = folder / "report.html"
        path.write_text(html_of(name), "utf-8")
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
        """A chart by its kind, and where there are several its number among them: ``rate 0``."""
        kind, _, number = name.partition(" ")
        return self.page.locator(f'figure[data-chart="{kind}"]').nth(int(number or 0))

    def point_at(self, chart: str, share: float) -> None:
        """Put the mouse over a chart, at a share of its width."""
        area = self.chart(chart).locator(".ground")
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
    return Opened(browser, tmp_path)


@pytest.mark.journey
def test_a_report_opens_without_a_complaint_and_asks_for_nothing(opened: Opened) -> None:
    expect(opened.page.locator(".time-bar")).to_be_visible()
    assert opened.page.locator("svg.over-time:visible").count() == 11
    assert opened.complaints == []
    assert len(opened.requests) == 1


def test_strangers_texts_do_nothing_in_a_browser(browser: Browser, tmp_path: Path) -> None:
    opened = Opened(browser, tmp_path, "hostile")
    expect(opened.page.locator(".time-bar")).to_be_visible()
    assert opened.complaints == []
    assert len(opened.requests) == 1


@pytest.mark.journey
def test_the_cursor_is_at_one_time_in_all_charts_on_the_map_and_in_words(opened: Opened) -> None:
    opened.point_at("rate 0", 0.5)
    expect(opened.words).to_contain_text("Scaffolding")
    expect(opened.chart("rate 6").locator(".readout")).to_have_text("195 → 10 Hz")
    expect(opened.chart("total").locator(".readout")).to_contain_text("KB/s")
    lines = opened.page.locator(".cursor.known").evaluate_all(SHARES_OF_WIDTH)
    assert len(lines) == 11
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
    opened.point_at("lanes", 0.995)
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
    opened.page.locator("summary", has_text="Decisions").press("Enter")
    opened.page.get_by_role("button", name="Show 31.2 s").first.press("Enter")
    expect(opened.words).to_contain_text("31.3 s")
    opened.page.locator("summary", has_text="Frequency").press("Enter")
    table = opened.page.get_by_role("table", name="Frequency")
    heading = table.get_by_role("columnheader", name="Change")
    heading.get_by_role("button").press("Enter")
    expect(heading).to_have_attribute("aria-sort", "ascending")
    cells = table.locator("tbody td:nth-child(4)").all_inner_texts()
    changes = [float(text.replace("−", "-")) for text in cells]
    assert changes == sorted(changes)
    assert len(changes) == 9


def test_without_scripts_every_drawing_and_number_is_there(browser: Browser, tmp_path: Path) -> None:
    opened = Opened(browser, tmp_path, scripts=False)
    assert opened.page.locator("svg.over-time:visible").count() == 11
    expect(opened.page.locator(".time-bar")).to_have_count(0)
    for heading in opened.page.locator("summary").all():
        heading.click()
    words = opened.page.locator("body").inner_text().replace("\N{NO-BREAK SPACE}", " ")
    for text in (
        "−89 % bandwidth, /odom error 1.3 cm, at fixed rates 0.4 cm",
        "31.2",
        "180 380.00",
        "20 861.96",
    ):
        assert text in words
    assert opened.requests == [opened.page.url]


def test_paper_has_the_drawings_of_the_screen_and_the_stretch_that_they_show(opened: Opened) -> None:
    opened.page.get_by_role("slider").fill("100")
    opened.page.get_by_role("button", name="Zoom in").click()
    opened.page.emulate_media(media="print")
    assert opened.page.locator("svg.over-time:visible").count() == 11
    expect(opened.page.get_by_role("table", name="Frequency")).to_be_visible()
    assert opened.chart("total").locator(".times text").all_text_contents()[0] == "50"
    expect(opened.page.locator(".time-bar")).to_be_hidden()


def test_a_zoomed_chart_names_its_times_and_the_bars_that_have_room(opened: Opened) -> None:
    name = opened.chart("lanes").locator(".bar-name:visible", has_text="4 Hz").first
    expect(name).to_be_visible()
    opened.page.get_by_role("slider").fill("190")
    for _ in range(3):
        opened.page.get_by_role("button", name="Zoom in").click()
    expect(name).to_have_count(0)
    names = opened.chart("lanes").locator(".bar-name:visible").evaluate_all(BOXES)
    ground = opened.chart("lanes").locator(".ground").evaluate_all(BOXES)
    assert all(ground[0][0] <= left < right <= ground[0][1] for left, right, _ in names)
    assert len(names) == 10
    times = [
        text.removesuffix(" s") for text in opened.chart("total").locator(".times text").all_text_contents()
    ]
    assert min(map(float, times)) >= 166
    assert max(map(float, times)) <= 200


@pytest.mark.parametrize("scripts", [True, False], ids=["scripts", "no-scripts"])
def test_the_page_has_no_sideways_scroll_and_letters_to_read_at_each_width(
    browser: Browser, tmp_path: Path, scripts: bool
) -> None:
    page = Opened(browser, tmp_path, scripts=scripts).page
    for width in WIDTHS_PX:
        assert_readable(page, width)


def assert_readable(page: Page, width: int) -> None:
    """Letters of 11 px or more, nothing cut off and nothing to scroll sideways in a window of ``width``."""
    page.set_viewport_size({"width": width, "height": 800})
    texts = page.locator("svg text:visible")
    assert min(texts.evaluate_all(LETTERS_PX)) >= 11
    assert texts.evaluate_all(CUT_OFF) == []
    assert not page.locator("html").evaluate(SCROLLS_SIDEWAYS)
    assert not any(figure.evaluate(SCROLLS_SIDEWAYS) for figure in page.locator("figure.chart").all())


def test_on_a_telephone_a_chart_fits_a_lane_has_its_name_above_and_a_wide_table_scrolls(
    opened: Opened,
) -> None:
    lanes = opened.chart("lanes").locator(".lane")
    beside = lanes.evaluate_all(LANES)
    assert all(bar_top <= top and bottom <= bar_bottom for _, top, bottom, _, bar_top, bar_bottom in beside)
    opened.page.set_viewport_size({"width": 390, "height": 800})
    above = lanes.evaluate_all(LANES)
    assert len(above) == 10
    assert all(
        bottom <= bar_top and left == pytest.approx(bar_left, abs=1.5)
        for left, _, bottom, bar_left, bar_top, _ in above
    )
    assert all(upper[-1] <= lower[1] for upper, lower in pairwise(above))
    opened.point_at("lanes", 0.5)
    cursor = opened.chart("lanes").locator(".cursor").bounding_box()
    assert cursor is not None
    lowest_bar = lanes.evaluate_all(LANES)[-1][-1]
    assert lowest_bar < cursor["y"] + cursor["height"] < lowest_bar + 10
    opened.chart("total").scroll_into_view_if_needed()
    boxes = opened.chart("total").locator(".times text").evaluate_all(BOXES)
    assert all(height >= 11 for _, _, height in boxes)
    assert all(right < left for (_, right, _), (left, _, _) in pairwise(boxes))
    assert boxes[-1][1] <= 390
    opened.page.locator("summary", has_text="Frequency").click()
    table = opened.page.get_by_role("table", name="Frequency")
    table.locator("xpath=..").evaluate("(figure) => { figure.scrollLeft = figure.scrollWidth; }")
    cells = table.locator("tbody tr").first.locator("td")
    first, last = cells.first.bounding_box(), cells.last.bounding_box()
    assert first is not None
    assert last is not None
    assert first["x"] >= 0
    assert last["x"] + last["width"] <= 390


def test_a_report_is_read_on_a_few_screens_and_the_time_bar_leaves_a_telephone_its_room(
    opened: Opened,
) -> None:
    for width, most_screens in ((1440, 5.5), (390, 8)):
        opened.page.set_viewport_size({"width": width, "height": 844})
        height = opened.page.evaluate("document.documentElement.scrollHeight")
        assert height < 844 * most_screens
        bar = opened.page.locator(".time-bar").bounding_box()
        assert bar is not None
        assert bar["height"] <= 64


def test_charts_below_each_other_show_the_same_time_at_the_same_place(opened: Opened) -> None:
    for width in WIDTHS_PX:
        opened.page.set_viewport_size({"width": width, "height": 844})
        grounds = opened.page.locator(".over-time .ground").evaluate_all(BOXES)
        assert len({(round(left), round(right)) for left, right, _ in grounds}) == 1


def test_names_on_the_map_cover_none_of_each_other_on_a_telephone(opened: Opened) -> None:
    opened.page.set_viewport_size({"width": 390, "height": 844})
    boxes = opened.page.locator(".zone-name, .marker-name").evaluate_all(
        "texts => texts.map((text) => { const b = text.getBoundingClientRect(); "
        "return [b.left, b.right, b.top, b.bottom]; })"
    )
    assert len(boxes) == 4
    for one, other in combinations(boxes, 2):
        apart = one[1] <= other[0] or other[1] <= one[0] or one[3] <= other[2] or other[3] <= one[2]
        assert apart


def test_axe_finds_nothing(browser: Browser, tmp_path: Path) -> None:
    page = Opened(browser, tmp_path).page
    for heading in page.locator("summary").all():
        heading.click()
    assert violations(page) == []
