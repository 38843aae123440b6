# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Who may only watch sees everything, with what changes something switched off and the reason in words."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from axe import violations
from ruler.browser.ruler_page import RulerPage

RULES = "begin\n    SetFrequency /odom 5\nend\n"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "patrol.adirf").write_text(RULES)
    (folder / "patrol.toml").write_text('[topics."/odom"]\nsource_hz = 20\n')
    return folder


@pytest.fixture
def options() -> tuple[str, ...]:
    return ("--watch-only",)


@pytest.mark.journey
def test_every_page_says_it_and_what_changes_something_is_off(ruler: RulerPage, project: Path) -> None:
    page = ruler.page
    _expect_off(ruler.button("New Rule File"))
    ruler.button("More for patrol.adirf").click()
    for name in ("Rename", "Duplicate", "Delete"):
        _expect_off(page.get_by_role("menuitem", name=name))
    page.keyboard.press("Escape")
    _expect_notice(ruler)

    ruler.open("patrol.adirf")
    _expect_notice(ruler)
    _expect_off(ruler.tool("Send to robot"))
    page.keyboard.press("Escape")
    ruler.change("Edit rate: 5", "7")
    ruler.expect_lines("SetFrequency /odom 7")
    _expect_off(ruler.button("Save"))
    page.keyboard.press("Control+s")
    expect(page.get_by_text("You may only watch here: nothing was changed")).to_be_visible()
    ruler.forgive("403")
    assert (project / "patrol.adirf").read_text() == RULES
    assert violations(page) == []

    page.get_by_role("link", name="Rules", exact=True).click()
    page.get_by_role("link", name="patrol.toml", exact=True).click()
    _expect_off(ruler.button("Measure on the robot"))
    page.get_by_role("link", name="Rules", exact=True).click()
    ruler.page.get_by_role("link", name="Robots").click()
    _expect_notice(ruler)


def test_what_a_save_would_do_is_off_where_somebody_compares_or_optimizes(
    ruler: RulerPage, project: Path
) -> None:
    page = ruler.page
    (project / "patrol.toml").write_text(
        'budget_kb_per_s = 1\n\n[topics."/odom"]\nmessage_kb = 1\nsource_hz = 20\n'
    )
    ruler.open("patrol.adirf")
    ruler.open_rates()
    _expect_off(page.get_by_role("button", name="would do"))
    ruler.button("Close").click()
    ruler.change("Edit rate: 5", "7")
    (project / "patrol.adirf").write_text(RULES.replace("5", "9"))
    page.get_by_role("button", name="Decide", exact=True).click()
    ways = page.get_by_role("dialog", name="patrol.adirf was changed elsewhere")
    ways.get_by_role("button", name="Take theirs").click()
    ruler.expect_lines("SetFrequency /odom 9")


def _expect_notice(ruler: RulerPage) -> None:
    notice = ruler.page.get_by_role("status").filter(has_text="You may only watch here.")
    expect(notice).to_contain_text("No robot and no file is changed")


def _expect_off(button: Locator) -> None:
    """It cannot be pressed, and says why."""
    expect(button).to_be_disabled()
    group = button.locator("xpath=ancestor::fieldset[1]")
    expect(group).to_have_attribute("title", "You may only watch here: this would change a file or a robot")
