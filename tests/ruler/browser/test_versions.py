# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What was saved of a rule file is there again; where the project wants it, the page saves by itself."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import Locator, Route, expect

from axe import violations
from ruler.browser.ruler_page import RulerPage, see_no_changes, served

if TYPE_CHECKING:
    from playwright.sync_api import Browser

RULES = "begin\n    SetFrequency /odom 10\nend\n"
SLOWER = RULES.replace("10", "7")
MINE = RULES.replace("10", "9")
SETTING = "Save by itself, two seconds after the last change without errors"


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
    # What was not saved yet is a version, too.
    expect(versions).to_have_count(4)
    expect(versions.nth(0)).to_contain_text("default: /odom 5 → 10 Hz")
    expect(versions.nth(1)).to_contain_text("default: /odom 7 → 5 Hz")
    assert (project / "plain.adirf").read_text() == RULES
    expect(ruler.tool("Save")).to_be_disabled()


def test_a_conflict_says_in_words_what_differs(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project)
    ruler.change("Edit rate: 10", "9")
    (project / "plain.adirf").write_text(SLOWER)
    ruler.tool("Save").click()
    dialog = ruler.page.get_by_role("dialog")
    expect(dialog.get_by_role("list", name="Differences")).to_have_text("default: /odom 7 → 9 Hz")
    ruler.forgive("409")
    dialog.get_by_role("button", name="Save anyway").click()
    ruler.tool("Versions").click()
    expect(_versions(ruler).nth(0)).to_contain_text("default: /odom 7 → 9 Hz")
    # Theirs, which was replaced, can be brought back.
    _versions(ruler).nth(1).get_by_role("button", name="Bring back").click()
    expect(_versions(ruler)).to_have_count(3)
    assert (project / "plain.adirf").read_text() == SLOWER


def test_a_project_saves_by_itself_what_has_no_errors(ruler: RulerPage, project: Path) -> None:
    (project / "plain.adirf").write_text(RULES)
    ruler.home()
    ruler.page.get_by_label(SETTING).check()
    ruler.open("plain.adirf")
    expect(ruler.page.get_by_text("saved by itself", exact=True)).to_be_visible()
    held: list[Route] = []
    ruler.page.route("**/api/file", lambda route: held.append(route), times=1)  # noqa: PLW0108 - no builtin
    with ruler.page.expect_request("**/api/file"):
        ruler.change("Edit rate: 10", "7")
    expect(ruler.page.get_by_text("not saved", exact=True)).to_be_visible()
    held[0].continue_()
    expect(ruler.page.get_by_text("saved by itself", exact=True)).to_be_visible()
    assert (project / "plain.adirf").read_text() == SLOWER
    ruler.text.get_by_text("SetFrequency").click()
    ruler.page.keyboard.press("End")
    ruler.page.keyboard.type(" 8")
    expect(ruler.page.get_by_text("not saved while there are errors")).to_be_visible()
    ruler.page.keyboard.press("Backspace")
    ruler.page.keyboard.press("Backspace")
    ruler.page.keyboard.press("Backspace")
    ruler.page.keyboard.type("6")
    expect(ruler.page.get_by_text("saved by itself", exact=True)).to_be_visible()
    assert (project / "plain.adirf").read_text() == RULES.replace("10", "6")


def test_it_asks_once_where_somebody_else_changed_the_file(ruler: RulerPage, project: Path) -> None:
    (project / "plain.adirf").write_text(RULES)
    ruler.home()
    ruler.page.get_by_label(SETTING).check()
    ruler.open("plain.adirf")
    see_no_changes(ruler.page, "plain.adirf")
    (project / "plain.adirf").write_text(SLOWER)
    ruler.change("Edit rate: 10", "9")
    dialog = ruler.page.get_by_role("dialog", name="Somebody else changed plain.adirf")
    dialog.get_by_role("button", name="Cancel").click()
    ruler.change("Edit rate: 9", "8")
    expect(ruler.page.get_by_text("not saved", exact=True)).to_be_visible()
    ruler.tool("Save").click()
    dialog.get_by_role("button", name="Save anyway").click()
    expect(ruler.page.get_by_text("saved by itself", exact=True)).to_be_visible()
    assert (project / "plain.adirf").read_text() == RULES.replace("10", "8")
    ruler.forgive("409")


def test_a_server_that_comes_back_gets_what_was_changed_meanwhile(
    browser: Browser, project: Path, ruler_port: int
) -> None:
    (project / "plain.adirf").write_text(RULES)
    context = browser.new_context()
    with served(project, ruler_port) as url:
        ruler = RulerPage(context.new_page(), url)
        ruler.home()
        ruler.page.get_by_label(SETTING).check()
        ruler.open("plain.adirf")
        expect(ruler.button("New rate")).to_be_enabled()
        expect(ruler.page.get_by_text("saved by itself", exact=True)).to_be_visible()
        ruler.text.get_by_text("SetFrequency").click()
    ruler.page.keyboard.press("End")
    ruler.page.keyboard.press("Backspace")
    ruler.page.keyboard.press("Backspace")
    ruler.page.keyboard.type("9")
    expect(ruler.page.get_by_text(re.compile("Is 'testudo ruler' still running"))).to_be_visible()
    expect(ruler.page.get_by_text("not saved", exact=True)).to_be_visible()
    with served(project, ruler_port):
        expect(ruler.page.get_by_text("saved by itself", exact=True)).to_be_visible()
    assert (project / "plain.adirf").read_text() == MINE
    context.close()


def _open(ruler: RulerPage, project: Path) -> None:
    (project / "plain.adirf").write_text(RULES)
    ruler.home()
    ruler.open("plain.adirf")


def _versions(ruler: RulerPage) -> Locator:
    return ruler.page.get_by_role("listitem", name="Version of")
