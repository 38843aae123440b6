# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules are tried on a folder of recordings: the worst one stands first and leads to its try."""

from __future__ import annotations

import re
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Route, expect

from axe import violations
from bags.bag_factory import small_mission, write_bag
from ruler.browser.ruler_page import RulerPage

RULES = """\
begin
    SetFrequency /odom 5
    SetFrequency /image 0.25
    Rule "Far"
    If (CheckValue /odom pose_y > 2)
    Then
        SetFrequency /scan 1
    EndIf
end
"""
RUN = "Run the rules on them"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Three drives, the longer ones with a longer time without a picture, and one that cannot be read."""
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "far.adirf").write_text(RULES)
    for name, seconds in (("a_short", 1), ("b_long", 4), ("d_middle", 2)):
        write_bag(folder / "runs" / name, small_mission(seconds))
    (folder / "runs" / "c_broken").mkdir()
    (folder / "runs" / "c_broken" / "metadata.yaml").write_text("no bag")
    return folder


def test_a_folder_is_tried_worst_first_and_a_row_leads_to_its_try(ruler: RulerPage) -> None:
    page = ruler.page
    ruler.open("far.adirf")
    ruler.tool("Try on a recording").click()
    recording = page.get_by_role("combobox", name="Recording")
    expect(recording.get_by_role("option").first).to_have_text("project: all 4 recordings")
    recording.select_option("runs/: all 4 recordings")
    with _held(ruler, "runs/c_broken"):
        ruler.button(RUN).click()
        expect(_progress(page.get_by_role("status"))).to_have_text("2 of 4 recordings of runs/ tried.")
        bar = page.get_by_role("progressbar", name="Replaying the recordings of runs/")
        assert 0.5 <= float(bar.get_attribute("value") or 0) < 0.75
        assert _names(_rows(ruler)) == ["b_long", "a_short"]
    expect(_progress(page.get_by_role("status"))).to_have_text(
        "4 of 4 recordings of runs/ tried, 1 without a result."
    )
    expect(bar).to_have_count(0)
    expect(page.get_by_role("group").filter(has_text="could not be tried")).to_contain_text(
        re.compile(
            "1 recording could not be tried.*c_broken: The folder holds no .db3 or .mcap file. Give a "
        )
    )
    assert _names(_rows(ruler)) == ["b_long", "d_middle", "a_short"]
    expect(_rows(ruler).last).to_contain_text("Total of 3 recordings")
    assert violations(page) == []

    sort = page.get_by_role("columnheader", name="Less sent (%)")
    sort.get_by_role("button").press("Enter")
    expect(sort).to_have_attribute("aria-sort", "ascending")
    less = _column(ruler, 1)
    assert less == sorted(less, key=float)
    sort.get_by_role("button").press("Enter")
    expect(sort).to_have_attribute("aria-sort", "descending")
    assert _column(ruler, 1) == less[::-1]

    sent, percent, loss, error, missed = _cells(_rows(ruler).filter(has_text="b_long"))
    ruler.button("b_long").press("Enter")
    headline = page.get_by_role("status").filter(has_text="% less sent")
    expect(headline).to_contain_text(f"{percent} % less sent; {loss}")
    facts = page.get_by_text("The rules decided")
    for words in (f"{sent} KB/s.", f"Largest error (RMSE): {error}.", f"Thresholds missed: {missed}."):
        expect(facts).to_contain_text(words)
    expect(recording).to_have_value("runs/b_long")

    back = ruler.button("Back to the recordings of runs/")
    expect(back).to_be_focused()
    back.press("Enter")
    expect(sort).to_have_attribute("aria-sort", "descending")
    expect(ruler.button("b_long")).to_be_focused()


def test_a_run_goes_on_with_its_rules_and_keeps_what_is_done_where_it_is_cancelled(ruler: RulerPage) -> None:
    page = ruler.page
    ruler.open("far.adirf")
    ruler.tool("Try on a recording").click()
    page.get_by_role("combobox", name="Recording").select_option("runs/")
    asked: list[str] = []
    with _held(ruler, "runs/b_long", asked):
        ruler.button(RUN).click()
        expect(_rows(ruler)).to_have_count(2)
        ruler.text.get_by_text("SetFrequency /odom 5").click()
        page.keyboard.press("End")
        page.keyboard.type("0")
        stale = page.get_by_text("Stale: rules changed since.")
        expect(stale).to_contain_text("This run goes on with the rules and recordings that it began with.")
    expect(_rows(ruler)).to_have_count(4)
    expect(stale).to_contain_text("Run the rules again to see what they do now.")
    assert len(asked) == 4
    assert all("/odom 5\\n" in text for text in asked)

    with _held(ruler, "runs/b_long"):
        ruler.button(RUN).click()
        expect(_progress(page.get_by_role("status"))).to_contain_text("1 of 4")
        page.get_by_role("link", name="Home").click()
        ruler.open("far.adirf")
        ruler.tool("Try on a recording").click()
        ruler.button("Cancel").click()
    expect(page.get_by_text("Cancelled.", exact=True)).to_be_visible()
    expect(_progress(page.get_by_role("status"))).to_have_text(
        "1 of 4 recordings of runs/ tried. The others were not: it was ended before. What was tried stays."
    )
    assert _names(_rows(ruler)) == ["a_short"]
    expect(page.get_by_text("Stale:")).to_have_count(0)


def test_a_telephone_tries_a_folder(ruler: RulerPage) -> None:
    ruler.page.set_viewport_size({"width": 390, "height": 844})
    ruler.open("far.adirf")
    ruler.tool("Try on a recording").click()
    ruler.page.get_by_role("combobox", name="Recording").select_option("runs/")
    ruler.button(RUN).click()
    expect(_rows(ruler)).to_have_count(4)
    assert ruler.page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0
    assert violations(ruler.page) == []
    # Anywhere in a row is as good as on its name, which is over all of it.
    _rows(ruler).filter(has_text="d_middle").get_by_role("cell").nth(1).click(force=True)
    expect(ruler.page.get_by_text("The rules decided")).to_be_visible()


def _rows(ruler: RulerPage) -> Locator:
    """The rows with numbers, the total last."""
    table = ruler.page.get_by_role("table", name="Recordings")
    return table.get_by_role("row").filter(has=ruler.page.get_by_role("rowheader"))


def _names(rows: Locator) -> list[str]:
    return rows.get_by_role("rowheader").all_inner_texts()[:-1]


def _cells(row: Locator) -> list[str]:
    return row.get_by_role("cell").all_inner_texts()


def _column(ruler: RulerPage, number: int) -> list[str]:
    cells = "(rows, at) => rows.map(row => row.querySelectorAll('td')[at].innerText)"
    column: list[str] = _rows(ruler).evaluate_all(cells, number)
    return column[:-1]


def _progress(status: Locator) -> Locator:
    return status.filter(has_text=re.compile(r"^\d+ of \d+ recordings"))


@contextmanager
def _held(ruler: RulerPage, bag: str, asked: list[str] | None = None) -> Iterator[None]:
    """Hold the try on ``bag`` back while the block lasts; ``asked`` gets what is asked until all is done."""
    waiting: list[Route] = []

    def hold(route: Route) -> None:
        body = route.request.post_data or ""
        if asked is not None:
            asked.append(body)
        if f'"bag":"{bag}"' in body and not is_over.is_set():
            waiting.append(route)
        else:
            route.continue_()

    is_over = threading.Event()
    ruler.page.route("**/api/try/headline", hold)
    yield
    is_over.set()
    for route in waiting:
        route.continue_()
