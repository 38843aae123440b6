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
        ("", "Versions"),
        ("ArrowUp", "Keys"),
        ("ArrowDown", "Versions"),
        ("End", "Keys"),
        ("Home", "Versions"),
        ("k", "Keys"),
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
