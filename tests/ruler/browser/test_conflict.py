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
TABLE = '[topics."/odom"]\nmessage_kb = 0.7\n'


@pytest.mark.journey
def test_their_text_is_taken_and_undo_brings_ones_own_back(ruler: RulerPage, project: Path) -> None:
    dialog = _meet(ruler, project)
    expect(dialog.get_by_role("figure", name="Theirs")).to_contain_text("SetFrequency /odom 7")
    expect(dialog.get_by_role("figure", name="Yours")).to_contain_text("SetFrequency /odom 10")
    dialog.get_by_role("button", name="Read again").click()
    expect(dialog).to_be_hidden()
    expect(ruler.text).to_contain_text("SetFrequency /odom 7")
    expect(ruler.tool("Save")).to_be_disabled()
    ruler.tool("Undo").click()
    ruler.expect_lines("SetFrequency /odom 10", "SetFrequency /")
    ruler.save()
    assert (project / "plain.adirf").read_text() == MINE


@pytest.mark.parametrize("is_gone", [False, True])
def test_ones_own_text_is_saved_anyway(ruler: RulerPage, project: Path, is_gone: bool) -> None:
    dialog = _meet(ruler, project, theirs=None if is_gone else THEIRS)
    expect(dialog.get_by_role("button", name="Read again")).to_have_count(0 if is_gone else 1)
    dialog.get_by_role("button", name="Save anyway").click()
    expect(ruler.tool("Save")).to_be_disabled()
    assert (project / "plain.adirf").read_text() == MINE


def test_both_texts_are_kept_under_two_names(ruler: RulerPage, project: Path) -> None:
    dialog = _meet(ruler, project)
    name = dialog.get_by_role("textbox")
    name.fill("zone")
    dialog.get_by_role("button", name="Save as").click()
    expect(dialog.get_by_role("alert")).to_contain_text("zone.adirf exists already")
    ruler.forgive("409")
    name.fill("mine")
    dialog.get_by_role("button", name="Save as").click()
    expect(ruler.page.get_by_role("heading", name="mine.adirf", level=1)).to_be_visible()
    assert (project / "mine.adirf").read_text() == MINE
    assert (project / "plain.adirf").read_text() == THEIRS
    ruler.page.get_by_role("link", name="Home").click()
    ruler.open("plain.adirf")
    ruler.expect_lines("SetFrequency /odom 7")


def test_who_looks_at_it_first_loses_nothing(ruler: RulerPage, project: Path) -> None:
    dialog = _meet(ruler, project)
    dialog.get_by_role("button", name="Cancel").click()
    expect(dialog).to_be_hidden()
    ruler.expect_lines("SetFrequency /odom 10", "SetFrequency /")
    expect(ruler.tool("Save")).to_be_enabled()
    assert (project / "plain.adirf").read_text() == THEIRS


def test_what_was_saved_by_itself_is_no_conflict(ruler: RulerPage, project: Path) -> None:
    _change(ruler, project)
    (project / "plain.adirf").write_text(MINE)
    ruler.save()
    expect(ruler.page.get_by_text("Saved plain.adirf")).to_be_visible()
    ruler.forgive("409")


def test_a_table_has_the_same_ways_out(ruler: RulerPage, project: Path) -> None:
    (project / "wlan.toml").write_text(TABLE)
    ruler.home()
    ruler.page.get_by_role("link", name="wlan.toml", exact=True).click()
    size = ruler.page.get_by_label("Message size (KB) of /odom")
    size.fill("0.9")
    (project / "wlan.toml").write_text(TABLE.replace("0.7", "0.8"))
    ruler.tool("Save").click()
    dialog = ruler.page.get_by_role("dialog", name="Somebody else changed wlan.toml")
    dialog.get_by_role("button", name="Read again").click()
    expect(size).to_have_value("0.8")
    expect(ruler.tool("Save")).to_be_disabled()
    ruler.tool("Undo").click()
    expect(size).to_have_value("0.9")
    ruler.save()
    assert (project / "wlan.toml").read_text() == TABLE.replace("0.7", "0.9")
    ruler.forgive("409")


def _change(ruler: RulerPage, project: Path) -> None:
    """Add a rate to a file."""
    (project / "plain.adirf").write_text(BEFORE)
    ruler.home()
    ruler.open("plain.adirf")
    ruler.button("New rate").click()
    ruler.expect_lines("SetFrequency /odom 10", "SetFrequency /")


def _meet(ruler: RulerPage, project: Path, theirs: str | None = THEIRS) -> Locator:
    """Add a rate to a file, and save it when somebody else wrote ``theirs`` or removed it; the dialog."""
    _change(ruler, project)
    if theirs is None:
        (project / "plain.adirf").unlink()
    else:
        (project / "plain.adirf").write_text(theirs)
    ruler.tool("Save").click()
    dialog = ruler.page.get_by_role("dialog")
    expect(dialog).to_contain_text("nothing that you typed is lost")
    ruler.forgive("409")
    if theirs is None:
        ruler.forgive("404")
    return dialog
