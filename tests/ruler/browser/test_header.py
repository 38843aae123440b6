# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The bar on top: few things in one row on every screen; the rest, with the documentation, in one menu."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from ruler.browser.ruler_page import RulerPage


@pytest.mark.journey
def test_the_menu_is_used_with_the_keyboard(ruler: RulerPage) -> None:
    ruler.open("zone.adirf")
    menu, keyboard = ruler.button("Menu"), ruler.page.keyboard
    menu.focus()
    keyboard.press("Enter")
    for key, entry in (
        ("", "Format"),
        ("ArrowUp", "Keys"),
        ("ArrowDown", "Format"),
        ("End", "Keys"),
        ("Home", "Format"),
        ("d", "Documentation"),
    ):
        if key:
            keyboard.press(key)
        expect(ruler.page.get_by_role("menuitem", name=entry, exact=True)).to_be_focused()
    keyboard.press("Escape")
    expect(ruler.page.get_by_role("menu")).to_have_count(0)
    expect(menu).to_be_focused()
    keyboard.press("ArrowUp")
    expect(ruler.page.get_by_role("menuitem", name="Keys", exact=True)).to_be_focused()
    keyboard.press("Tab")
    expect(ruler.page.get_by_role("menu")).to_have_count(0)


def test_the_documentation_is_searched_beside_the_rules(ruler: RulerPage) -> None:
    ruler.open("zone.adirf")
    ruler.button("New rate").click()
    ruler.page.keyboard.press("Escape")
    expect(ruler.tool("Save")).to_be_enabled()
    ruler.tool("Documentation").click()
    panel = ruler.page.get_by_role("dialog", name="Documentation")
    search = panel.get_by_role("combobox", name="Search the documentation")
    expect(search).to_be_focused()
    ruler.page.keyboard.type("condition never holds")
    found = panel.get_by_role("listbox", name="Found in the documentation").get_by_role("option")
    expect(found.first).to_contain_text("condition-never-holds")
    ruler.page.keyboard.press("Enter")
    heading = panel.get_by_role("heading", name="condition-never-holds")
    expect(heading).to_be_in_viewport()
    panel.get_by_role("link", name="Properties and units").first.click()
    expect(panel.get_by_role("heading", name="Properties and units")).to_be_in_viewport()
    # The rules are still open, with what was changed in them.
    expect(ruler.tool("Save")).to_be_enabled()
    search.fill("no such words")
    expect(panel.get_by_text("Nothing has all of these words.")).to_be_visible()
    for _ in ("the search", "the panel"):
        ruler.page.keyboard.press("Escape")
    expect(panel).to_have_count(0)
    expect(ruler.button("Menu")).to_be_focused()
    ruler.page.keyboard.press("F1")
    expect(search).to_be_focused()
