# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an engineer leans on while writing: findings on blocks, recipes, documentation."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import expect

from ruler.browser.ruler_page import RulerPage

CLASH = """\
begin
    SetFrequency /odom 10

    Rule "Aisle"
    If (CheckValue /odom pose_x > 1 AND CheckValue /odom speed < -1)
    Then
        SetFrequency /odom 4
    EndIf

    Rule "Bay"
    If CheckValue /odom pose_x > 5
    Then
        SetFrequency /odom 2
    EndIf

    Rule "Dock"
    If CheckValue /odom pose_y > 5
    Then
        SetFrequency /odom 8
    EndIf
end
"""


@pytest.mark.journey
def test_a_finding_marks_the_very_check_that_it_is_about(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project, "clash", CLASH)
    check = ruler.blocks.get_by_role("figure", name="/odom, speed").locator("xpath=..")
    check.locator(".finding-mark").first.click()
    found = ruler.page.get_by_role("dialog", name="What was found here")
    expect(found).to_contain_text("speed is never below 0 m/s")


@pytest.mark.journey
def test_a_project_starts_from_a_recipe_and_its_rules_are_in_the_list_of_blocks(
    ruler: RulerPage, project: Path
) -> None:
    ruler.button("New Rule File").click()
    dialog = ruler.page.get_by_role("dialog")
    dialog.get_by_label("Start from a recipe").select_option("Weak link")
    expect(dialog.get_by_text("heartbeat")).to_be_visible()
    dialog.get_by_label("Name").fill("evening")
    dialog.get_by_role("button", name="Create").click()
    ruler.expect_lines('Rule "Weak link" Priority 50')
    # The likeliest topic parameters have topics that the recipe leaves out.
    ruler.page.get_by_label("Topic parameters").select_option("")
    expect(ruler.page.get_by_text("No findings: the rules can be used as they are.")).to_be_visible()
    ruler.page.get_by_role("treeitem", name="Recipes").click()
    listed = ruler.page.get_by_role("listbox", name="Recipes blocks")
    for name in ("Low battery", "Emergency", "Corridor", "Weak link", "LiDAR silent"):
        expect(listed.get_by_role("option", name=f"rule, {name}, ")).to_be_attached()


def _open(ruler: RulerPage, project: Path, name: str, text: str) -> None:
    (project / f"{name}.adirf").write_text(text)
    ruler.home()
    ruler.open(f"{name}.adirf")
    ruler.blocks.get_by_role("button", name="Remove this").first.wait_for()
