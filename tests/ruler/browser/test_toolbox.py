# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The whole session of the thesis with the mouse, its blocks dragged from the list."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from playwright.sync_api import Locator

from ruler.browser.ruler_page import RulerPage, lowest
from ruler.browser.thesis import DEFAULT_RATES, FIGURE_6_6, enter_table

CHECKS = (("pose_x", ">", "11"), ("pose_x", "<", "15"), ("pose_y", ">", "7"), ("pose_y", "<", "11"))
RATES = (("/imu", "Competitive"), ("/camera/image_raw", "Excessive"))
DOWNLOADED = ("SetFrequency /imu 200", "SetFrequency /camera/image_raw 35")


def test_the_session_of_the_thesis_with_blocks_dragged_from_the_list(
    ruler: RulerPage, project: Path, tmp_path: Path
) -> None:
    enter_table(ruler, "275000", project)
    ruler.home()
    ruler.button("New Rule File").click()
    ruler.page.get_by_label("Name").fill("shelf")
    ruler.button("Create").click()
    _drag_rule(ruler)
    for number, (name, operator, value) in enumerate(CHECKS):
        if number:
            _drag_below(ruler, "Checks", "/odom, pose_x", _lowest(ruler, "/odom, pose"))
        if name != "pose_x":
            ruler.change("Edit property: pose_x", name)
        if operator == "<":
            _choose_operator(ruler, operator)
        ruler.change("Edit value: 0", value)
    for number, (topic, level) in enumerate(RATES):
        if number:
            ruler.field("Add rate").click()
        ruler.change("Edit topic to send" if number else "Edit topic to send: /odom", topic)
        ruler.change("Edit rate" if number else "Edit rate: 10", level)
    ruler.expect_lines("SetFrequency /camera/image_raw Excessive")
    ruler.save()
    assert (project / "shelf.adirf").read_text() == FIGURE_6_6

    with ruler.page.expect_download() as waiting:
        ruler.tool("Optimize and Download").click()
    downloaded = tmp_path / waiting.value.suggested_filename
    waiting.value.save_as(downloaded)
    text = downloaded.read_text()
    assert all(f"SetFrequency {topic} {rate_hz} Hz\n" in text for topic, rate_hz in DEFAULT_RATES.items())
    assert all(line in text for line in DOWNLOADED)
    check = [sys.executable, "-m", "smarttestudo", "check", str(downloaded)]
    assert subprocess.run(check, check=False).returncode == 0


def _drag_rule(ruler: RulerPage) -> None:
    ruler.page.get_by_role("treeitem", name="Rules").click()
    rule = ruler.page.get_by_role("listbox", name="Rules blocks").get_by_role("option").first
    ruler.drag(rule, ruler.page.get_by_role("treeitem", name="Actions"), 400, 20)
    ruler.expect_lines("CheckValue /odom pose_x > 0", "SetFrequency /odom 10")


def _drag_below(ruler: RulerPage, category: str, name: str, above: Locator) -> None:
    """Drag a block of a category to directly below another one."""
    ruler.page.get_by_role("treeitem", name=category).click()
    blocks = ruler.page.get_by_role("listbox", name=f"{category} blocks")
    ruler.drag(blocks.get_by_role("option", name=name).first, above, 0, 0)


def _choose_operator(ruler: RulerPage, operator: str) -> None:
    ruler.field("dropdown: >").click()
    ruler.page.get_by_role("option", name=operator, exact=True).click()


def _lowest(ruler: RulerPage, name: str) -> Locator:
    return lowest(ruler.blocks.get_by_role("figure", name=name))
