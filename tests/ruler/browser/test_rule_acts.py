# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules as things: switched off and on, copied, moved, by mouse and by keyboard, comments kept."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Route, expect

from ruler.browser.ruler_page import AFTER_TWO_FRAMES, RulerPage

THREE = """\
begin
    SetFrequency /odom 10

    // Why there is A.
    Rule "A"
    If CheckValue /odom pose_x > 1
    Then
        SetFrequency /odom 4  // enough
    EndIf

    Rule "B"
    If CheckValue /odom pose_x > 2
    Then
        SetFrequency /odom 5
    EndIf
end
"""
OFF = THREE.replace('Rule "A"', 'Disabled Rule "A"')


@pytest.fixture
def three(ruler: RulerPage, project: Path) -> RulerPage:
    (project / "three.adirf").write_text(THREE)
    ruler.home()
    ruler.open("three.adirf")
    ruler.field("Edit name of the rule: B")
    return ruler


def saved(ruler: RulerPage, project: Path) -> str:
    ruler.save()
    return (project / "three.adirf").read_text()


def test_a_rule_is_switched_off_and_on(three: RulerPage, project: Path) -> None:
    three.blocks.get_by_role("button", name="Switch this rule off").first.click()
    expect(three.blocks.get_by_text("⊘ switched off")).to_have_count(1)
    assert saved(three, project) == OFF
    expect(three.page.get_by_text('"A" is switched off')).to_be_visible()
    three.button("Switch this rule on").click()
    expect(three.blocks.get_by_text("⊘ switched off")).to_have_count(0)
    assert saved(three, project) == THREE


def test_one_undo_brings_a_rule_back(three: RulerPage, project: Path) -> None:
    three.blocks.get_by_role("button", name="Switch this rule off").first.click()
    expect(three.blocks.get_by_text("⊘ switched off")).to_have_count(1)
    three.tool("Undo").click()
    expect(three.blocks.get_by_text("⊘ switched off")).to_have_count(0)
    expect(three.tool("Save")).to_be_disabled()


def test_a_copy_has_what_was_typed_just_before(three: RulerPage, project: Path) -> None:
    three.field("Edit rate: 4").click()
    three.page.keyboard.press("Control+a")
    three.page.keyboard.type("7")
    # By its name: the block of the open field comes behind the others in the page a picture later.
    name = three.page.get_by_role("button", name="Edit name of the rule: A", exact=True)
    rule = three.blocks.locator(".adirf_rule").filter(has=name)
    rule.get_by_role("button", name="Duplicate this rule").click()
    three.field("Edit name of the rule: A 2")
    assert saved(three, project).count("SetFrequency /odom 7") == 2


def test_what_is_opened_while_a_copy_is_made_stays_open(three: RulerPage) -> None:
    held: list[Route] = []
    three.page.route("**/api/edit", lambda route: held.append(route), times=1)  # noqa: PLW0108 - no builtin
    with three.page.expect_request("**/api/edit"):
        three.blocks.get_by_role("button", name="Duplicate this rule").first.click()
    three.page.get_by_role("treeitem", name="Recipes").click()
    recipe = three.page.get_by_role("listbox", name="Recipes blocks").get_by_role("option").first
    recipe.wait_for()
    held[0].continue_()
    three.field("Edit name of the rule: A 2")
    three.page.evaluate(AFTER_TWO_FRAMES)
    assert recipe.is_visible()


def test_a_copy_stands_behind_its_rule_with_all_comments(three: RulerPage, project: Path) -> None:
    three.blocks.get_by_role("button", name="Duplicate this rule").first.click()
    three.field("Edit name of the rule: A 2")
    block = THREE[THREE.index("    // Why") : THREE.index('    Rule "B"')]
    assert saved(three, project) == THREE.replace(block, block + block.replace('"A"', '"A 2"'))


def test_a_rule_moves_with_its_comments(three: RulerPage, project: Path) -> None:
    three.blocks.get_by_role("button", name="Move this rule down").first.click()
    three.expect_lines('Rule "B"', "// Why there is A.", 'Rule "A"')
    # The blocks follow the text: then the focus is on the rule that moved.
    three.await_focus("rule, A")
    three.field("Move this rule up").click()
    three.expect_lines("// Why there is A.", 'Rule "A"', 'Rule "B"')
    expect(three.tool("Save")).to_be_disabled()


def test_by_keyboard_alone(three: RulerPage, project: Path) -> None:
    keyboard = three.page.keyboard
    three.walk("Tab", "stacks of blocks")
    three.walk("ArrowDown", "rule, A", steps=3)
    three.walk("ArrowRight", "Switch this rule off", steps=8)
    keyboard.press("Enter")
    expect(three.blocks.get_by_text("⊘ switched off")).to_have_count(1)
    three.await_focus("rule, A")
    three.walk("ArrowRight", "Switch this rule on", steps=8)
    three.walk("ArrowRight", "Duplicate this rule", steps=3)
    keyboard.press("Enter")
    three.field("Edit name of the rule: A 2")
    expect(three.blocks.get_by_text("⊘ switched off")).to_have_count(2)
    keyboard.press("Control+s")
    expect(three.page.get_by_text("Saved three.adirf")).to_be_visible()
    assert (project / "three.adirf").read_text().count("Disabled Rule") == 2


TWO_KEYS = """async () => {
    for (let count = 0; count < 2; count++) {
        const key = new KeyboardEvent("keydown", { key: "ArrowDown", keyCode: 40, bubbles: true });
        document.activeElement.dispatchEvent(key);
    }
    for (let count = 0; count < 3; count++) await new Promise(requestAnimationFrame);
}"""
"""Two keys before the next frame, as a browser that is busy gets them, and then some frames."""


def test_keys_that_come_faster_than_frames_keep_the_focus(three: RulerPage) -> None:
    three.walk("Tab", "stacks of blocks")
    three.page.evaluate(TWO_KEYS)
    assert "rule, A" in three.focused()


def test_the_menu_of_a_rule_offers_the_same(three: RulerPage) -> None:
    three.page.locator(".adirf_rule, .blocklyDraggable").filter(has_text="rule").first.click(
        button="right", position={"x": 20, "y": 8}
    )
    menu = three.page.locator(".blocklyContextMenu")
    for name in ("Switch this rule off", "Duplicate this rule", "Move this rule up", "Move this rule down"):
        expect(menu.get_by_text(name, exact=True)).to_have_count(1)
    expect(menu.get_by_text("Disable Block")).to_have_count(0)
    menu.get_by_text("Move this rule down", exact=True).click()
    three.expect_lines('Rule "B"', 'Rule "A"')
