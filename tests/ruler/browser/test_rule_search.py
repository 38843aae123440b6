# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rule is found among ten screens' worth of them by what stands in it."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import expect

from ruler.browser.ruler_page import RulerPage

COUNT = 200


def rule(number: int) -> str:
    off = "Disabled " if number == 77 else ""
    return f"""
    {off}Rule "Aisle {number}"
    If CheckValue /odom pose_x > {number}
    Then
        SetFrequency /sensor_{number} {number / 10:g}
    EndIf
"""


@pytest.fixture
def many(ruler: RulerPage, project: Path) -> RulerPage:
    (project / "many.adirf").write_text(f"begin\n{''.join(map(rule, range(COUNT)))}end\n")
    ruler.home()
    ruler.open("many.adirf")
    ruler.field("Unfold Aisle 1")
    return ruler


def test_a_rule_is_found_in_two_actions(many: RulerPage) -> None:
    keyboard = many.page.keyboard
    many.page.locator("h1").click()
    keyboard.type("/aisle 137")
    search = many.page.get_by_role("search")
    expect(search.get_by_role("option")).to_have_count(1)
    expect(search.get_by_role("status")).to_have_text("1 of 200")
    keyboard.press("Enter")
    expect(many.blocks.get_by_role("button", name="Edit name of the rule: Aisle 137")).to_be_in_viewport()
    many.await_focus("Aisle 137")
    expect(many.text.get_by_text('"Aisle 137"')).to_be_in_viewport()
    expect(search.get_by_role("option")).to_have_count(0)
