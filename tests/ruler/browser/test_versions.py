# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What was saved of a rule file is there again; where the project wants it, the page saves by itself."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from axe import violations
from ruler.browser.ruler_page import RulerPage

RULES = "begin\n    SetFrequency /odom 10\nend\n"
SLOWER = RULES.replace("10", "7")
MINE = RULES.replace("10", "9")


@pytest.mark.journey
def test_a_version_is_compared_and_brought_back_as_a_new_one(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project)
    ruler.change("Edit rate: 10", "7")
    ruler.save()
    ruler.change("Edit rate: 7", "5")
    ruler.tool("Versions").click()
    versions = _versions(ruler)
    expect(versions).to_have_count(2)
    expect(versions.nth(0)).to_contain_text("default: /odom 10 → 7 Hz")
    expect(versions.nth(1)).to_contain_text("The oldest that is kept.")
    versions.nth(1).get_by_role("button", name="Compare").click()
    expect(versions.nth(1).get_by_role("list", name="Differences")).to_have_text("default: /odom 5 → 10 Hz")
    expect(versions.nth(1).get_by_role("figure", name="Open now")).to_contain_text("SetFrequency /odom 5")
    assert violations(ruler.page) == []
    versions.nth(1).get_by_role("button", name="Bring back").click()
    # What was not saved yet is a version, and the file waits for a save.
    expect(versions).to_have_count(3)
    expect(versions.nth(0)).to_contain_text("default: /odom 7 → 5 Hz")
    ruler.expect_lines("SetFrequency /odom 10")
    assert (project / "plain.adirf").read_text() == SLOWER
    ruler.page.get_by_role("dialog").get_by_role("button", name="Close").click()
    ruler.save()
    assert (project / "plain.adirf").read_text() == RULES


def test_a_conflict_says_in_words_what_differs(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project)
    ruler.change("Edit rate: 10", "9")
    (project / "plain.adirf").write_text(SLOWER)
    ruler.tool("Save").click()
    dialog = ruler.page.get_by_role("dialog")
    dialog.get_by_role("button", name="Look at the difference").click()
    expect(dialog.get_by_role("list", name="Differences")).to_have_text("default: /odom 7 → 9 Hz")
    ruler.forgive("409")
    dialog.get_by_role("button", name="Keep mine").click()
    ruler.tool("Versions").click()
    expect(_versions(ruler).nth(0)).to_contain_text("default: /odom 7 → 9 Hz")
    # Theirs, which was replaced, can be brought back.
    _versions(ruler).nth(1).get_by_role("button", name="Bring back").click()
    ruler.expect_lines("SetFrequency /odom 7")
    ruler.page.get_by_role("dialog").get_by_role("button", name="Close").click()
    ruler.save()
    assert (project / "plain.adirf").read_text() == SLOWER


def _open(ruler: RulerPage, project: Path) -> None:
    (project / "plain.adirf").write_text(RULES)
    ruler.home()
    ruler.open("plain.adirf")


def _versions(ruler: RulerPage) -> Locator:
    return ruler.page.get_by_role("listitem", name="Version of")
