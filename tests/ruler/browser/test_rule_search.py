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


def test_topics_properties_rates_and_limits_narrow_what_is_found(many: RulerPage) -> None:
    many.page.keyboard.press("Control+f")
    field = many.page.get_by_role("combobox", name="Find a rule")
    expect(field).to_be_focused()
    search = many.page.get_by_role("search")
    expect(search.get_by_role("status")).to_have_text("200 of 200")
    for words, count in (
        ("/sensor_41", 1),
        ("pose_x > 41", 2),
        ("15.5 Hz", 1),
        ("pose_x aisle 5", 38),
        ("speed", 0),
    ):
        field.fill(words)
        expect(search.get_by_role("status")).to_have_text(f"{count} of 200")
    many.page.keyboard.press("Escape")
    expect(field).to_have_value("")
    expect(search.get_by_role("option")).to_have_count(0)
    field.fill("aisle")
    many.button("Switched off").click()
    expect(search.get_by_role("option")).to_have_count(1)
    search.get_by_role("option").click()
    expect(many.blocks.get_by_role("button", name="Edit name of the rule: Aisle 77")).to_be_in_viewport()
    expect(many.button("Switch this rule on")).to_be_in_viewport()


def test_the_arrows_choose_among_what_is_found(many: RulerPage) -> None:
    field = many.page.get_by_role("combobox", name="Find a rule")
    field.fill("aisle 15")
    for _ in range(3):
        many.page.keyboard.press("ArrowDown")
    many.page.keyboard.press("ArrowUp")
    many.page.keyboard.press("Enter")
    # Aisle 15, 115, 150 and so on, in the order of the text.
    expect(many.blocks.get_by_role("button", name="Edit name of the rule: Aisle 150")).to_be_in_viewport()
