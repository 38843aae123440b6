# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules fold to one line."""

from __future__ import annotations

import re
from pathlib import Path

from playwright.sync_api import Locator, expect

from ruler.browser.ruler_page import RulerPage

DRAWN = ".blocklyBlockCanvas > .blocklyDraggable"


def rule(number: int, off: str = "") -> str:
    return f"""
    {off}Rule "Aisle {number}"
    If CheckValue /odom pose_x > {number}
    Then
        SetFrequency /sensor_{number} 4
        SetFrequency /scan Full
    EndIf
"""


def test_a_rule_folds_to_a_line_that_says_what_it_sets(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project, f"begin\n{rule(1)}    // Kept.{rule(2, 'Disabled ')}{rule(3)}end\n")
    ruler.blocks.get_by_role("button", name="Fold this rule").first.click()
    expect(_folded(ruler, 1)).to_be_focused()
    line = ruler.blocks.locator(".adirf_folded")
    expect(line).to_contain_text(re.compile("Aisle 1.*sets.*/sensor_1 4 Hz, /scan Full".replace(" ", r"\s")))
    expect(ruler.blocks.get_by_role("button", name="Edit name of the rule")).to_have_count(2)
    _choose(ruler, "Fold all")
    expect(ruler.blocks.locator(".adirf_folded")).to_have_count(3)
    expect(_line(ruler, 2)).to_contain_text("switched off")
    # Nothing of this is in the text.
    expect(ruler.tool("Undo")).to_be_disabled()
    ruler.button("New rate").click()
    ruler.type_value("/late")
    ruler.expect_lines("SetFrequency /late 10", "Aisle 1", "Aisle 2", "Aisle 3")
    expect(ruler.blocks.locator(".adirf_folded")).to_have_count(3)
    # The menu and the marks of a line are those of its rule.
    _line(ruler, 1).click(button="right", position={"x": 200, "y": 8})
    ruler.page.get_by_role("menuitem", name="Switch this rule off").click()
    ruler.expect_lines('Disabled Rule "Aisle 1"')
    ruler.save()
    ruler.page.evaluate("location.hash = '#/'")
    ruler.open("folded.adirf")
    expect(ruler.blocks.locator(".adirf_folded")).to_have_count(3)
    # By the keyboard, the focus stays on the button.
    _folded(ruler, 3).click()
    fold = ruler.blocks.get_by_role("button", name="Fold this rule").and_(ruler.page.locator(":focus"))
    expect(fold).to_have_count(1)
    expect(ruler.field("Edit name of the rule: Aisle 3")).to_be_visible()
    ruler.page.keyboard.press("Enter")
    expect(_folded(ruler, 3)).to_be_focused()


def _open(ruler: RulerPage, project: Path, text: str) -> None:
    (project / "folded.adirf").write_text(text)
    ruler.home()
    ruler.open("folded.adirf")
    ruler.blocks.locator(DRAWN).first.wait_for(state="attached")


def _line(ruler: RulerPage, number: int) -> Locator:
    return ruler.blocks.locator(".adirf_folded").filter(has_text=f"Aisle {number}")


def _folded(ruler: RulerPage, number: int) -> Locator:
    return ruler.blocks.get_by_role("button", name=f"Unfold Aisle {number}", exact=True)


def _choose(ruler: RulerPage, name: str) -> None:
    """Choose from the menu of the ground between blocks."""
    host = ruler.blocks.locator(".blocks-host").bounding_box()
    assert host is not None
    ruler.page.mouse.click(host["x"] + host["width"] - 60, host["y"] + 8, button="right")
    ruler.page.get_by_role("menuitem", name=name, exact=True).click()
