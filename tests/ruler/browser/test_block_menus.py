# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Menus on blocks are the Ruler's own: what they say can be done."""

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
