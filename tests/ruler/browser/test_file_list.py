# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The list of files says what rules take and what their last try said; a robot's incidents flood no list."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from bags.bag_factory import small_mission, write_bag
from ruler.browser.ruler_page import RulerPage, served

if TYPE_CHECKING:
    from playwright.sync_api import Browser

RULES = "begin\n    SetFrequency /odom 5\n    SetFrequency /scan 1\nend\n"
PROFILE = """\
budget_kb_per_s = 20
[topics."/odom"]
message_kb = 0.7
[topics."/scan"]
message_kb = 9
"""
INCIDENTS = 65


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Rules with their topic parameters, a recording, and what a robot recorded on its own."""
    folder = tmp_path / "project"
    (folder / "inc").mkdir(parents=True)
    (folder / "far.adirf").write_text(RULES)
    (folder / "far.toml").write_text(PROFILE)
    write_bag(folder / "monday", small_mission(2))
    for number in range(INCIDENTS):
        shutil.copytree(folder / "monday", folder / "inc" / f"20261123T0101{number:02}000Z-near_miss")
    return folder


@pytest.mark.journey
def test_load_and_last_try_are_in_the_list_also_after_a_restart(
    browser: Browser, project: Path, ruler_port: int
) -> None:
    with browser.new_context() as context, served(project, ruler_port) as url:
        ruler = RulerPage(context.new_page(), url)
        ruler.home()
        row = ruler.page.get_by_role("region", name="Rules").get_by_role("listitem")
        expect(row).to_contain_text("worst case 12.5 of 20 KB/s")
        ruler.open("far.adirf")
        ruler.open_pane("Try on a recording")
        ruler.page.get_by_role("combobox", name="Recording").select_option("monday")
        with ruler.page.expect_response("**/api/file/tried"):
            ruler.button("Run the rules on it").click()
    with browser.new_context() as context, served(project, ruler_port) as url:
        ruler = RulerPage(context.new_page(), url)
        ruler.home()
        row = ruler.page.get_by_role("region", name="Rules").get_by_role("listitem")
        expect(row).to_contain_text(re.compile(r"tried .* on monday: [\d.]+ KB/s, [\d.]+\s% less"))
        expect(row).to_contain_text("worst case 12.5 of 20 KB/s")


def test_incidents_of_a_robot_stay_in_their_folder(ruler: RulerPage) -> None:
    expect(ruler.page.get_by_text("near_miss")).to_have_count(0)
    ruler.open("far.adirf")
    ruler.open_pane("Try on a recording")
    choices = ruler.page.get_by_role("combobox", name="Recording").get_by_role("option")
    expect(choices.first).to_be_attached()
    assert choices.all_inner_texts()[:3] == [
        "project: all 66 recordings",
        "inc/: all 65 recordings",
        "monday",
    ]
    ruler.page.get_by_role("link", name="Recordings", exact=True).click()
    listed = ruler.page.get_by_role("region", name="Recordings")
    expect(listed.get_by_text("monday")).to_be_visible()
    expect(listed.get_by_text("near_miss").first).to_be_hidden()
    listed.get_by_text("inc/").click()
    expect(listed.get_by_role("button", name="New rules from inc/")).to_have_count(INCIDENTS)
