# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The files of a project: found, renamed, copied, deleted and brought back, without a terminal."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import expect

from axe import violations
from ruler.browser.ruler_page import RulerPage


@pytest.mark.journey
def test_files_are_counted_found_and_put_into_folders(ruler: RulerPage, project: Path) -> None:
    rules = ruler.page.get_by_role("region", name="Rules")
    every = len(list(project.rglob("*.adirf")))
    expect(rules.get_by_role("heading")).to_have_text(f"Rules {every}")
    ruler.page.get_by_role("searchbox", name="Find a file").fill("low bat")
    expect(rules.get_by_role("heading")).to_have_text(f"Rules 1 of {every}")

    ruler.button("More for low_battery.adirf").click()
    ruler.page.get_by_role("menuitem", name="Rename").click()
    dialog = ruler.page.get_by_role("dialog", name="Rename low_battery.adirf")
    dialog.get_by_role("textbox", name="Name").fill("zone.adirf")
    dialog.get_by_role("button", name="Rename").click()
    expect(dialog.get_by_role("alert")).to_contain_text("a file of this name")
    ruler.forgive("409")
    assert violations(ruler.page) == []
    text = (project / "low_battery.adirf").read_bytes()
    dialog.get_by_role("textbox", name="Name").fill("power/low_battery")
    dialog.get_by_role("button", name="Rename").click()
    expect(rules.get_by_role("link", name="power/low_battery.adirf")).to_be_visible()
    assert (project / "power/low_battery.adirf").read_bytes() == text
    assert not (project / "low_battery.adirf").exists()


@pytest.mark.journey
def test_a_copy_and_a_deletion_that_is_undone(ruler: RulerPage, project: Path) -> None:
    rules = ruler.page.get_by_role("region", name="Rules")
    ruler.button("More for zone.adirf").click()
    ruler.page.get_by_role("menuitem", name="Duplicate").click()
    ruler.page.get_by_role("dialog").get_by_role("button", name="Duplicate").click()
    expect(rules.get_by_role("link", name="zone_copy.adirf")).to_be_visible()
    text = (project / "zone_copy.adirf").read_bytes()
    assert text == (project / "zone.adirf").read_bytes()
    ruler.button("More for zone_copy.adirf").click()
    ruler.page.get_by_role("menuitem", name="Delete").click()
    expect(rules.get_by_role("link", name="zone_copy.adirf")).to_have_count(0)
    assert not (project / "zone_copy.adirf").exists()
    ruler.button("Undo").click()
    expect(rules.get_by_role("link", name="zone_copy.adirf")).to_be_visible()
    assert (project / "zone_copy.adirf").read_bytes() == text
