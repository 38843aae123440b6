# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Menus and keys on blocks are the Ruler's own: what they say can be done, and a letter is a letter."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from ruler.browser.ruler_page import GRIP_PX, RulerPage

RULES = """\
begin
    SetFrequency /odom 10

    Rule "A"
    If CheckValue /odom pose_x > 1
    Then
        SetFrequency /odom 4
    EndIf
end
"""
PAGE = ("Undo", "Redo")
RULE = (
    "Fold this rule",
    "Switch this rule off",
    "Duplicate this rule",
    "Move this rule up",
    "Move this rule down",
)
MENUS = {
    "adirf_rule": (*RULE, "Add a comment", "Remove this rule", *PAGE),
    "adirf_check": ("for so long…", "within the last…", "until…", "Remove this check", *PAGE),
    "adirf_set": ("Remove this rate", *PAGE),
}


@pytest.fixture
def one(ruler: RulerPage, project: Path) -> RulerPage:
    (project / "one.adirf").write_text(RULES)
    ruler.home()
    ruler.open("one.adirf")
    ruler.field("Edit name of the rule: A")
    return ruler


@pytest.mark.parametrize("block", list(MENUS))
def test_the_menu_of_a_block_holds_what_can_be_done_with_it(one: RulerPage, block: str) -> None:
    expect(_menu(one, one.page.locator(f".adirf_rule .{block}, .adirf_rule.{block}"))).to_have_text(
        list(MENUS[block])
    )


def test_the_menu_of_a_default_has_a_comment_and_that_of_the_ground_new_blocks(one: RulerPage) -> None:
    default = one.page.locator(".blocklyBlockCanvas > .adirf_set")
    expect(_menu(one, default)).to_have_text(["Add a comment", "Remove this rate", *PAGE])
    one.page.keyboard.press("Escape")
    host = one.blocks.locator(".blocks-host").bounding_box()
    assert host is not None
    one.page.mouse.click(host["x"] + host["width"] - 150, host["y"] + 30, button="right")
    expect(one.page.get_by_role("menuitem")).to_have_text(
        ["New rate", "New rule", "Fold all", "Unfold all", *PAGE]
    )
    one.page.get_by_role("menuitem", name="New rate").click()
    one.expect_lines("SetFrequency /odom 10", "SetFrequency /", "Rule")


def test_a_menu_undoes_what_the_page_undoes(one: RulerPage) -> None:
    one.change("Edit rate: 4", "7")
    one.expect_lines("SetFrequency /odom 7")
    _menu(one, one.page.locator(".adirf_rule")).filter(has_text="Undo").click()
    one.expect_lines("SetFrequency /odom 4")


def test_a_menu_is_not_cut_at_the_edge_of_the_pane(one: RulerPage) -> None:
    one.page.set_viewport_size({"width": 1440, "height": 520})
    one.page.wait_for_function("() => innerHeight === 520")
    host = one.blocks.locator(".blocks-host").bounding_box()
    assert host is not None
    last = _menu(one, one.page.locator(".adirf_rule")).last
    box = last.bounding_box()
    assert box is not None
    assert box["y"] > host["y"] + host["height"]
    # What covers it would take the click.
    seen = one.page.evaluate(
        "([x, y]) => document.elementFromPoint(x, y).textContent",
        [box["x"] + box["width"] / 2, box["y"] + box["height"] / 2],
    )
    assert seen.strip() == "Redo"


def test_a_comment_opens_to_type_into_and_stays_only_with_a_text(one: RulerPage) -> None:
    rule = one.page.locator(".adirf_rule")
    _menu(one, rule).filter(has_text="Add a comment").click()
    editor = one.page.locator("textarea:focus")
    expect(editor).to_have_count(1)
    one.page.keyboard.type("Why there is A.")
    one.page.keyboard.press("Escape")
    one.expect_lines("// Why there is A.", 'Rule "A"')
    expect(_menu(one, rule).filter(has_text="comment")).to_have_text(
        ["Edit the comment", "Remove the comment"]
    )
    one.page.get_by_role("menuitem", name="Remove the comment").click()
    expect(one.text).not_to_contain_text("Why there is A.")
    expect(one.tool("Save")).to_be_disabled()


def test_tab_goes_from_topic_to_property_operator_and_value(one: RulerPage) -> None:
    one.field("Edit topic to check: /odom").click()
    for typed in ("/pose", "pose_y"):
        one.page.keyboard.press("Control+a")
        one.page.keyboard.type(typed)
        one.page.keyboard.press("Tab")
    expect(one.page.get_by_role("option", name="<", exact=True)).to_be_visible()
    one.page.keyboard.press("ArrowDown")
    one.page.keyboard.press("Tab")
    one.type_value("3")
    one.expect_lines("CheckValue /pose pose_y < 3")


def test_enter_takes_the_first_line_of_the_clock_and_its_duration_is_ready(one: RulerPage) -> None:
    one.field("Add time").click()
    one.page.keyboard.press("Enter")
    one.page.get_by_role("textbox", name="duration").wait_for()
    one.type_value("25")
    one.expect_lines("CheckValue /odom pose_x > 1 For 25 s")


def test_a_letter_on_a_field_is_a_letter_and_no_shortcut(one: RulerPage) -> None:
    one.walk("Tab", "stacks of blocks")
    one.walk("ArrowDown", "set frequency of", steps=2)
    one.walk("ArrowRight", "Edit topic to send", steps=4)
    one.page.keyboard.type("/tmp")
    one.page.keyboard.press("Enter")
    one.expect_lines("SetFrequency /tmp")
    expect(one.page.get_by_role("combobox", name="Find a rule")).not_to_be_focused()


def test_a_duration_below_nothing_stays_open_with_the_reason(one: RulerPage) -> None:
    one.field("Add time").click()
    one.page.keyboard.press("Enter")
    one.page.get_by_role("textbox", name="duration").wait_for()
    one.type_value("-5")
    expect(one.page.get_by_text("-5 is less than 0")).to_be_visible()
    assert one.is_open("Edit duration")
    one.type_value("5")
    one.expect_lines("For 5 s")


def _menu(ruler: RulerPage, block: Locator) -> Locator:
    """The lines of the menu of a block."""
    path = block.locator("> .blocklyPath").first
    box = path.bounding_box()
    assert box is not None
    # At its right end is neither a field nor what hangs from an icon.
    path.click(button="right", position={"x": box["width"] - 4, "y": GRIP_PX})
    lines = ruler.page.get_by_role("menuitem")
    lines.first.wait_for()
    return lines
