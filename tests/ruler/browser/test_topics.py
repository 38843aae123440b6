# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The table of the thesis's Figure A.2 goes in, the rates of Figure A.3 come out."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from playwright.sync_api import expect

from ruler.browser.ruler_page import RulerPage
from ruler.browser.thesis import DEFAULT_RATES, enter_table

if TYPE_CHECKING:
    from playwright.sync_api import Browser

RULES = """\
begin
    Rule "Shelf"
    If (
        CheckValue /odom pose_x > 11
        AND CheckValue /odom pose_x < 15
        AND CheckValue /odom pose_y > 7
        AND CheckValue /odom pose_y < 11
    )
    Then
        SetFrequency /imu Competitive
        SetFrequency /camera/image_raw {level}
    EndIf
end
"""
BLOCK_RATES = ("SetFrequency /imu 200", "SetFrequency /camera/image_raw 35")


def test_the_table_of_the_thesis_gives_its_rates(ruler: RulerPage, project: Path, tmp_path: Path) -> None:
    enter_table(ruler, "275000", project)
    (project / "shelf.adirf").write_text(RULES.format(level="Excessive"))
    ruler.home()
    ruler.open("shelf.adirf")
    ruler.open_rates()
    expect(ruler.page.get_by_text("Everything fits into 275 000 KB/s")).to_be_visible()
    expect(ruler.page.get_by_text("219 881.72 KB/s").first).to_be_visible()
    ruler.button("Close").click()
    with ruler.page.expect_download() as waiting:
        ruler.tool("Optimize and Download").click()
    downloaded = tmp_path / waiting.value.suggested_filename
    waiting.value.save_as(downloaded)
    text = downloaded.read_text()
    for topic, rate_hz in DEFAULT_RATES.items():
        assert f"SetFrequency {topic} {rate_hz} Hz\n" in text
    for line in BLOCK_RATES:
        assert line in text
    check = [sys.executable, "-m", "smarttestudo", "check", str(downloaded)]
    assert subprocess.run(check, check=False).returncode == 0


def test_chosen_topic_parameters_are_those_of_everybody_and_named_when_they_are_gone(
    browser: Browser, ruler: RulerPage, project: Path
) -> None:
    (project / "shelf.adirf").write_text(RULES.format(level="Excessive"))
    (project / "mine.toml").write_text('[topics."/imu"]\nmessage_kb = 1\n')
    ruler.home()
    ruler.open("shelf.adirf")
    with ruler.page.expect_response("**/api/profile/for"):
        ruler.page.get_by_label("Topic parameters").select_option("mine.toml")
    with browser.new_context() as elsewhere:
        other = RulerPage(elsewhere.new_page(), ruler.url)
        other.home()
        other.open("shelf.adirf")
        choice = other.page.get_by_label("Topic parameters")
        expect(choice).to_have_value("mine.toml")
        (project / "mine.toml").unlink()
        other.home()
        other.open("shelf.adirf")
        expect(other.page.get_by_role("status").filter(has_text="mine.toml is gone")).to_be_visible()
        expect(choice).not_to_have_value("mine.toml")
        choice.select_option("none")
        expect(other.page.get_by_text("mine.toml is gone")).to_have_count(0)
        assert other.complaints == []
