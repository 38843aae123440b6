# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an engineer leans on while writing: findings on blocks, recipes, documentation, many rules."""

from __future__ import annotations

import re
from pathlib import Path

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
MANY = 200


def many_rules() -> str:
    rules = (
        f'    Rule "Zone {number}"\n    If CheckValue /odom pose_x > {number}\n    Then\n'
        f"        SetFrequency /odom 4\n    EndIf\n"
        for number in range(MANY)
    )
    return "begin\n    SetFrequency /odom 10\n\n" + "\n".join(rules) + "end\n"


def test_clashing_rules_are_a_pair_with_a_way_to_both(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project, "clash", CLASH)
    pair = ruler.page.get_by_role("group", name="Statements that this is about").first
    pair.get_by_role("button", name="Show Rule Bay").click()
    expect(ruler.text).to_be_focused()
    expect(ruler.text.locator(".spot").first).to_contain_text("Bay")
    pair.get_by_role("button", name="Show Rule Dock").click()
    expect(ruler.text.locator(".spot").first).to_contain_text("Dock")


def test_a_finding_marks_the_very_check_that_it_is_about(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project, "clash", CLASH)
    check = ruler.blocks.get_by_role("figure", name="/odom, speed").locator("xpath=..")
    check.get_by_role("button", name="Open Warning").click()
    expect(ruler.blocks.get_by_text("speed is never below 0 m/s")).to_be_visible()


def test_a_finding_leads_to_why_it_matters_offline(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project, "clash", CLASH)
    with ruler.page.expect_popup() as opened:
        ruler.page.get_by_role("link", name="Why?").first.click()
    page = opened.value
    heading = page.get_by_role("heading", name="condition-never-holds")
    expect(heading).to_be_in_viewport()
    page.get_by_role("navigation", name="Contents").get_by_role("link", name="Properties and units").click()
    expect(page.get_by_role("heading", name="Properties and units")).to_be_in_viewport()
    row = page.get_by_role("row").filter(has_text="signed turning rate").first
    expect(row).to_contain_text("rad/s")


def test_a_project_starts_from_a_recipe_and_its_rules_are_in_the_list_of_blocks(
    ruler: RulerPage, project: Path
) -> None:
    ruler.button("Weak link").click()
    dialog = ruler.page.get_by_role("dialog")
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
        expect(listed.get_by_role("option", name=f"rule, {name}, priority")).to_be_attached()


def test_a_name_makes_its_folder_and_one_that_is_not_shown_is_refused_with_the_real_cause(
    ruler: RulerPage, project: Path
) -> None:
    ruler.button("New Rule File").click()
    dialog = ruler.page.get_by_role("dialog")
    dialog.get_by_label("Name").fill(".a/b c")
    dialog.get_by_role("button", name="Create").click()
    expect(dialog.get_by_role("alert")).to_contain_text("The Ruler shows no files of such a folder")
    ruler.complaints.clear()
    dialog.get_by_label("Name").fill("a/b c")
    dialog.get_by_role("button", name="Create").click()
    ruler.blocks.wait_for()
    assert (project / "a" / "b c.adirf").read_text() == "begin\nend\n"


def test_what_is_not_saved_is_still_there_after_a_look_at_the_first_screen(ruler: RulerPage) -> None:
    ruler.open("warehouse.adirf")
    ruler.button("New rate").click()
    expect(ruler.tool("Save")).to_be_enabled()
    ruler.page.get_by_role("link", name="Home").click()
    expect(ruler.page.get_by_role("listitem").filter(has_text="warehouse.adirf")).to_contain_text("not saved")
    ruler.open("warehouse.adirf")
    expect(ruler.tool("Save")).to_be_enabled()
    ruler.tool("Undo").click()
    expect(ruler.tool("Save")).to_be_disabled()


def test_the_bar_on_top_keeps_its_height_whatever_it_tells(ruler: RulerPage, project: Path) -> None:
    ruler.page.set_viewport_size({"width": 1280, "height": 800})
    name = "the_patrol_of_monday_morning_in_the_warehouse"
    _open(ruler, project, name, CLASH)
    height = "document.querySelector('header').offsetHeight"
    before = ruler.page.evaluate(height)
    assert before < 60
    last = ruler.tool("Optimize and Download").bounding_box()
    assert last is not None
    assert last["x"] + last["width"] <= 1280
    ruler.button("New rate").click()
    expect(ruler.tool("Save")).to_be_enabled()
    assert ruler.page.evaluate(height) == before
    expect(ruler.page.get_by_role("heading", name=name)).to_have_attribute("title", f"{name}.adirf")


def test_of_very_many_rules_a_part_is_blocks_and_follows_what_is_looked_at(
    ruler: RulerPage, project: Path
) -> None:
    _open(ruler, project, "many", many_rules())
    ruler.page.get_by_role("option", name="Zone 19", exact=False).first.click()
    ruler.blocks.get_by_role("button", name="Edit name of the rule: Zone 19", exact=True).click()
    ruler.type_value("Gate")
    ruler.expect_lines('Rule "Gate"')
    ruler.text.click()
    for key in ("Control+End", "ArrowUp", "ArrowUp"):
        ruler.page.keyboard.press(key)
    expect(ruler.blocks.get_by_role("button", name=f"Unfold Zone {MANY - 1}")).to_be_in_viewport()
    ruler.button("New rate").click()
    ruler.page.keyboard.press("Escape")
    outline = ruler.page.get_by_role("listbox", name="Rules in the order of the text")
    expect(outline.get_by_role("option")).to_have_count(MANY + 2)
    assert ruler.page.locator(".blocklyBlockCanvas .blocklyDraggable").count() < MANY
    ruler.save()
    # The new rate is of a topic that had none.
    added = re.compile(r"    SetFrequency /(?!odom )\S+ 10\n")
    text = (project / "many.adirf").read_text()
    assert added.search(text)
    assert added.sub("", text) == many_rules().replace('"Zone 19"', '"Gate"')


def _open(ruler: RulerPage, project: Path, name: str, text: str) -> None:
    (project / f"{name}.adirf").write_text(text)
    ruler.home()
    ruler.open(f"{name}.adirf")
    ruler.blocks.get_by_role("button", name="Remove this").first.wait_for()
