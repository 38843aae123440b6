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


@pytest.mark.journey
def test_a_folder_is_tried_worst_first_and_a_row_leads_to_its_try(ruler: RulerPage) -> None:
    page = ruler.page
    ruler.open("far.adirf")
    ruler.open_pane("Try on a recording")
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
def _held(ruler: RulerPage, bag: str) -> Iterator[None]:
    """Hold the try on ``bag`` back while the block lasts."""
    waiting: list[Route] = []

    def hold(route: Route) -> None:
        body = route.request.post_data or ""
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
