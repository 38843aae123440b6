# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules go out of one file and come into another."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from ruler.browser.ruler_page import GRIP_PX, RulerPage

MINE = """\
begin
    SetFrequency /odom 10  // mine

    Rule "Bay"
    If CheckValue /odom pose_x > 1
    Then
        SetFrequency /odom 4
    EndIf
end
"""
THEIRS = """\
begin
    SetFrequency /odom 20
    SetFrequency /imu 5
    KeepAtLeast /scan often

    // fast there
    Rule "Bay"
    If CheckValue /odom pose_x > 2
    Then
        SetFrequency /odom 8
    EndIf

    Rule "Aisle"
    If CheckValue /odom pose_y > 1
    Then
        SetFrequency /odom 2
    EndIf
end
"""


@pytest.mark.journey
def test_rules_of_another_file_come_with_a_word_about_whom_they_meet(ruler: RulerPage, project: Path) -> None:
    (project / "mine.adirf").write_text(MINE)
    (project / "theirs.adirf").write_text(THEIRS)
    ruler.home()
    ruler.open("mine.adirf")
    ruler.tool("Import").click()
    dialog = ruler.page.get_by_role("dialog", name="Import rules")
    dialog.get_by_label("From this project").select_option("theirs.adirf")
    expect(dialog.get_by_text("another rule has this name here, in line 4")).to_be_visible()
    expect(dialog.get_by_text("the topic has another default here, in line 2")).to_be_visible()
    expect(dialog.get_by_text("has an error and stays there")).to_be_visible()
    dialog.get_by_role("checkbox", name="/odom at 20 Hz").uncheck()
    _item(dialog, "Rule Bay").get_by_role("checkbox", name="replace it").check()
    found = dialog.get_by_role("list", name="Findings of the import")
    expect(found).to_contain_text("sets /odom to 2")
    dialog.get_by_role("button", name="Import", exact=True).click()
    ruler.expect_lines(
        "SetFrequency /odom 10  // mine", "SetFrequency /imu 5", "// fast there", "pose_x > 2", "Aisle"
    )
    expect(ruler.text).not_to_contain_text("pose_x > 1")
    ruler.tool("Undo").click()
    expect(ruler.text).not_to_contain_text("Aisle")
    expect(ruler.tool("Undo")).to_be_disabled()


def test_a_rule_that_is_copied_is_pasted_into_another_file(ruler: RulerPage, project: Path) -> None:
    (project / "mine.adirf").write_text(MINE)
    (project / "theirs.adirf").write_text(THEIRS)
    ruler.home()
    ruler.open("theirs.adirf")
    ruler.blocks.get_by_role("figure", name="Aisle").click(position={"x": GRIP_PX, "y": GRIP_PX})
    ruler.page.keyboard.press("Control+c")
    ruler.page.get_by_role("link", name="Rules", exact=True).click()
    ruler.open("mine.adirf")
    ruler.blocks.get_by_role("figure", name="Bay").click(position={"x": GRIP_PX, "y": GRIP_PX})
    ruler.page.keyboard.press("Control+v")
    ruler.expect_lines("SetFrequency /odom 10", "Bay", "Aisle", "CheckValue /odom pose_y > 1")
    ruler.save()
    assert 'Rule "Aisle"' in (project / "mine.adirf").read_text()
    assert (project / "theirs.adirf").read_text() == THEIRS


def _item(dialog: Locator, name: str) -> Locator:
    return dialog.get_by_role("listitem").filter(has=dialog.page.get_by_role("checkbox", name=name))
