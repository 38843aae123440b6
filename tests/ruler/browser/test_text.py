# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Text and blocks stay in step, and a file is never rewritten behind its author's back."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import expect

from ruler.browser.ruler_page import EXAMPLES, RulerPage

RULE_FILES = sorted(path.relative_to(EXAMPLES).as_posix() for path in EXAMPLES.rglob("*.adirf"))


def test_every_example_opens_as_blocks_and_saves_the_same_bytes(ruler: RulerPage, project: Path) -> None:
    for name in RULE_FILES:
        before = (project / name).read_bytes()
        ruler.home()
        ruler.open(name)
        ruler.blocks.get_by_role("button", name="Remove this").first.wait_for()
        expect(ruler.blocks.get_by_text("as text", exact=True)).to_have_count(0)
        ruler.button("New rate").click()
        ruler.tool("Undo").click()
        expect(ruler.tool("Undo")).to_be_disabled()
        ruler.page.keyboard.press("Control+s")
        expect(ruler.page.get_by_text(f"Saved {name}")).to_be_visible()
        assert (project / name).read_bytes() == before


@pytest.mark.journey
def test_two_errors_give_two_marks_and_the_last_good_blocks_stay(ruler: RulerPage, project: Path) -> None:
    ruler.open("warehouse.adirf")
    blocks = ruler.blocks.get_by_role("button", name="topic to send")
    expect(blocks).to_have_count((project / "warehouse.adirf").read_text().count("SetFrequency"))
    before = blocks.count()
    _replace_in_text(ruler, "SetFrequency /odom 10", "SetFrequenzy /odom 10")
    _replace_in_text(ruler, "SetFrequency /scan 3", "SetFrequency /scan often")
    errors = ruler.page.get_by_role("list", name="Findings").get_by_text("Error", exact=True)
    expect(errors).to_have_count(2)
    expect(ruler.page.get_by_text("the blocks show how it was before")).to_be_visible()
    expect(blocks).to_have_count(before)
    ruler.page.get_by_role("list", name="Findings").get_by_role("button", name="SetFrequency").first.click()
    expect(errors).to_have_count(1)
    ruler.expect_lines("begin", "SetFrequency /odom 10")


@pytest.mark.journey
def test_a_change_on_a_block_changes_one_word_of_the_text(ruler: RulerPage, project: Path) -> None:
    before = (project / "warehouse.adirf").read_text()
    ruler.open("warehouse.adirf")
    ruler.blocks.get_by_role("button", name="Edit rate: 7", exact=True).click()
    ruler.type_value("Full")
    ruler.expect_lines("SetFrequency /cmd_vel Full")
    ruler.save()
    after = (project / "warehouse.adirf").read_text()
    assert after == before.replace("/cmd_vel 7", "/cmd_vel Full")
    ruler.tool("Undo").click()
    ruler.save()
    assert (project / "warehouse.adirf").read_text() == before


def _replace_in_text(ruler: RulerPage, old: str, new: str) -> None:
    """Click into the line, select it and put other text there at once: no part of it is checked."""
    ruler.text.get_by_text(old, exact=True).first.click()
    for key in ("End", "Shift+Home"):
        ruler.page.keyboard.press(key)
    ruler.page.keyboard.insert_text(new)
