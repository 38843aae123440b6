# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The whole case of the thesis (figures 6.6, A.2, A.3) from the home screen: rule, table, rates on disk."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from playwright.sync_api import Download, expect

from optimizer import golden
from ruler.browser.counted_page import CountedPage
from ruler.browser.ruler_page import RulerPage
from ruler.browser.thesis import (
    DEFAULT_RATES,
    FIGURE_6_6,
    LEVELS,
    build_rule,
    build_rule_without_a_mouse,
)

MOST_CLICKS = 30
TITLES = ("Topic", "Message size (KB)", *LEVELS)
TABLE = "\n".join(
    "\t".join(cells)
    for cells in (
        TITLES,
        *([topic, f"{size_kb:g}", *map(str, tiers)] for topic, (size_kb, tiers) in golden.TOPICS.items()),
    )
)
"""Figure A.2 as a spreadsheet copies it, titles included."""
BUDGET_KB_PER_S = "275000"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project without a file."""
    (tmp_path / "project").mkdir()
    return tmp_path / "project"


def test_the_whole_case_needs_few_clicks(ruler: RulerPage, project: Path, tmp_path: Path) -> None:
    me = CountedPage(ruler.page)
    me.click("button", "New Rule File")
    expect(ruler.page.get_by_label("Name")).to_be_focused()
    me.type("shelf")
    me.press("Enter")
    build_rule(me)
    ruler.expect_lines("SetFrequency /camera/image_raw Excessive")
    me.click("link", "Create")
    me.sees("shelf.toml, new, not saved")
    expect(ruler.page.get_by_label("Topic of row 3")).to_have_value("/odom")
    me.paste(TABLE)
    me.sees("Pasted 9 topics")
    me.click("textbox", "Budget: total bandwidth (KB/s)")
    me.type(BUDGET_KB_PER_S)
    me.click("button", "Save")
    me.sees("Saved shelf.toml")
    me.click("link", "Back to shelf.adirf")
    expect(ruler.page.get_by_role("combobox", name="Topic parameters")).to_have_value("shelf.toml")
    me.click("button", "Save")
    me.sees("Saved shelf.adirf")
    with ruler.page.expect_download() as waiting:
        me.click("button", "Optimize and Download")
    _expect_rates_of_the_thesis(ruler, waiting.value, tmp_path)
    assert (project / "shelf.adirf").read_text() == FIGURE_6_6
    assert me.clicks <= MOST_CLICKS, me.done


def test_the_whole_case_is_done_with_the_keyboard_alone(
    ruler: RulerPage, project: Path, tmp_path: Path
) -> None:
    me = CountedPage(ruler.page)
    me.walk("Tab", "New Rule File")
    me.press("Enter")
    expect(ruler.page.get_by_label("Name")).to_be_focused()
    me.type("shelf")
    me.press("Enter")
    expect(ruler.button("New rule")).to_be_enabled()
    build_rule_without_a_mouse(me)
    ruler.expect_lines("SetFrequency /camera/image_raw Excessive")
    me.press("Control+s")
    me.sees("Saved shelf.adirf")
    me.walk("Tab", "Create")
    me.press("Enter")
    me.sees("shelf.toml, new, not saved")
    expect(ruler.page.get_by_label("Topic of row 3")).to_have_value("/odom")
    me.paste(TABLE)
    me.sees("Pasted 9 topics")
    me.walk_to_field("Budget: total bandwidth (KB/s)")
    me.type(BUDGET_KB_PER_S)
    me.press("Control+s")
    me.sees("Saved shelf.toml")
    me.walk("Shift+Tab", "Back to shelf.adirf")
    me.press("Enter")
    expect(ruler.page.get_by_role("combobox", name="Topic parameters")).to_have_value("shelf.toml")
    me.walk("Tab", "Optimize and Download")
    with ruler.page.expect_download() as waiting:
        me.press("Enter")
    _expect_rates_of_the_thesis(ruler, waiting.value, tmp_path)
    assert (project / "shelf.adirf").read_text() == FIGURE_6_6
    assert me.clicks == 0


def _expect_rates_of_the_thesis(ruler: RulerPage, download: Download, tmp_path: Path) -> None:
    """What was downloaded has the numbers of Figure A.3, and the load is the thesis's."""
    expect(ruler.page.get_by_text("219 881.72 of 275 000 KB/s").first).to_be_visible()
    downloaded = tmp_path / download.suggested_filename
    download.save_as(downloaded)
    text = downloaded.read_text()
    for topic, rate_hz in DEFAULT_RATES.items():
        assert f"SetFrequency {topic} {rate_hz} Hz\n" in text
    for line in ("SetFrequency /imu 200", "SetFrequency /camera/image_raw 35"):
        assert line in text
    check = [sys.executable, "-m", "smarttestudo", "check", str(downloaded)]
    assert subprocess.run(check, check=False).returncode == 0
