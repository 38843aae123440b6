# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The table of the thesis's Figure A.2 goes in, the rates of Figure A.3 come out."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from playwright.sync_api import expect

from ruler.browser.ruler_page import RulerPage
from ruler.browser.thesis import DEFAULT_RATES, enter_table

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
    ruler.button("Optimize and Download").click()
    expect(ruler.page.get_by_text("Everything fits into 275 000 KB/s")).to_be_visible()
    expect(ruler.page.get_by_text("219 882 KB/s").first).to_be_visible()
    with ruler.page.expect_download() as waiting:
        ruler.button("Download rates").click()
    downloaded = tmp_path / waiting.value.suggested_filename
    waiting.value.save_as(downloaded)
    text = downloaded.read_text()
    for topic, rate_hz in DEFAULT_RATES.items():
        assert f"SetFrequency {topic} {rate_hz} Hz\n" in text
    for line in BLOCK_RATES:
        assert line in text
    check = [sys.executable, "-m", "smarttestudo", "check", str(downloaded)]
    assert subprocess.run(check, check=False).returncode == 0


def test_what_does_not_fit_is_explained_and_mended_with_one_click(ruler: RulerPage, project: Path) -> None:
    enter_table(ruler, "15000", project)
    (project / "shelf.adirf").write_text(RULES.format(level="Excessive"))
    ruler.home()
    ruler.open("shelf.adirf")
    ruler.button("Optimize and Download").click()
    expect(ruler.page.get_by_role("alert")).to_contain_text(re.compile(r"needs at least 157\s665\.72 KB/s"))
    expect(ruler.button("Download rates")).to_be_disabled()
    ruler.page.get_by_role("alert").get_by_role("button").first.click()
    expect(ruler.page.get_by_text("Everything fits into")).to_be_visible()
    expect(ruler.button("Download rates")).to_be_enabled()
