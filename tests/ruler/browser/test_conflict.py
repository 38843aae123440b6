# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Somebody else changed the file that is open: every way out keeps what was typed."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from ruler.browser.ruler_page import RulerPage

BEFORE = "begin\n    SetFrequency /odom 10\nend\n"
MINE = BEFORE.replace("10\n", "10\n    SetFrequency /imu 10\n")
THEIRS = BEFORE.replace("10", "7")


@pytest.mark.journey
def test_their_text_is_taken_and_undo_brings_ones_own_back(ruler: RulerPage, project: Path) -> None:
    dialog = _meet(ruler, project)
    dialog.get_by_role("button", name="Look at the difference").click()
    expect(dialog.get_by_role("figure", name="Theirs")).to_contain_text("SetFrequency /odom 7")
    expect(dialog.get_by_role("figure", name="Yours")).to_contain_text("SetFrequency /odom 10")
    dialog.get_by_role("button", name="Take theirs").click()
    expect(dialog).to_be_hidden()
    expect(ruler.text).to_contain_text("SetFrequency /odom 7")
    expect(ruler.tool("Save")).to_be_disabled()
    ruler.tool("Undo").click()
    ruler.expect_lines("SetFrequency /odom 10", "SetFrequency /")
    ruler.save()
    assert (project / "plain.adirf").read_text() == MINE


def _meet(ruler: RulerPage, project: Path) -> Locator:
    """Add a rate to a file, and save it when somebody else wrote it; the dialog."""
    (project / "plain.adirf").write_text(BEFORE)
    ruler.home()
    ruler.open("plain.adirf")
    ruler.button("New rate").click()
    ruler.expect_lines("SetFrequency /odom 10", "SetFrequency /")
    (project / "plain.adirf").write_text(THEIRS)
    ruler.tool("Save").click()
    dialog = ruler.page.get_by_role("dialog")
    expect(dialog).to_contain_text("Nothing that you typed is lost")
    ruler.forgive("409")
    return dialog
