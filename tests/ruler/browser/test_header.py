# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The bar on top: few things in one row on every screen; the rest, with the documentation, in one menu."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import expect

from ruler.browser.ruler_page import RulerPage

WIDTHS_PX = (1440, 1280, 820, 390)
# Of what is in the bar: whether all of it is seen, and where its middle is.
IN_THE_BAR = """() => {
    const seen = [...document.querySelectorAll(".bar :is(h1, a, button, .quiet)")]
        .filter(each => each.checkVisibility() && !each.closest("[role=menu], [role=tooltip]"));
    return seen.map(each => {
        const {left, right, top, bottom} = each.getBoundingClientRect();
        const isCut = each.scrollWidth > each.clientWidth + 1 && each.clientWidth > 0
            || each.scrollHeight > each.clientHeight + 3 && each.tagName === "H1";
        const isInside = left >= 0 && right <= innerWidth;
        return {name: each.getAttribute("aria-label") ?? each.textContent, isCut, isInside, top, bottom};
    });
}"""


@pytest.mark.parametrize("width_px", WIDTHS_PX)
def test_the_bar_is_one_row_of_which_nothing_is_cut(ruler: RulerPage, width_px: int) -> None:
    ruler.page.set_viewport_size({"width": width_px, "height": 844})
    ruler.open("quality/inspection.adirf")
    _expect_one_row(ruler)
    ruler.button("New rate").click()
    expect(ruler.tool("Save")).to_be_enabled()
    _expect_one_row(ruler)


@pytest.mark.parametrize("width_px", WIDTHS_PX)
def test_the_bar_of_topic_parameters_is_one_row_as_well(ruler: RulerPage, width_px: int) -> None:
    ruler.page.set_viewport_size({"width": width_px, "height": 844})
    ruler.page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    ruler.page.get_by_label("Topic of row 1", exact=True).wait_for()
    _expect_one_row(ruler)


def test_the_bar_has_four_things_and_a_menu(ruler: RulerPage) -> None:
    ruler.open("zone.adirf")
    bar = ruler.page.get_by_role("toolbar", name="Tools")
    ruler.button("Menu").wait_for()
    named = "all => all.map(each => each.getAttribute('aria-label') || 'Menu')"
    shown = bar.get_by_role("button").evaluate_all(named)
    assert shown == ["Save", "Undo", "Redo", "Try on a recording", "Optimize and Download", "Menu"]
    ruler.button("Menu").click()
    entries = bar.get_by_role("menu", name="Menu").get_by_role("menuitem")
    entries.first.wait_for()
    names = [text.splitlines()[0] for text in entries.all_inner_texts()]
    assert names == ["Format", "Import", "Export", "Send to robot", "Documentation", "Keys"]
    for name, keys in (("Save", "Ctrl+S"), ("Undo", "Ctrl+Z"), ("Redo", "Ctrl+Shift+Z")):
        expect(ruler.tool(name)).to_have_attribute("title", f"{name} ({keys})")


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


def test_the_menu_closes_where_somebody_presses_elsewhere(ruler: RulerPage) -> None:
    ruler.open("zone.adirf")
    ruler.tool("Format").wait_for()
    ruler.text.click()
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


def test_text_on_blocks_has_13_pixels_and_the_font_of_the_page(ruler: RulerPage) -> None:
    ruler.open("zone.adirf")
    ruler.field("Edit value").wait_for()
    text = ruler.blocks.locator(".blocklyBlockCanvas text.blocklyText")
    found = text.evaluate_all(
        "all => all.map(each => ({px: parseFloat(getComputedStyle(each).fontSize) * each.getCTM().a,"
        " family: getComputedStyle(each).fontFamily, page: getComputedStyle(document.body).fontFamily}))"
    )
    assert len(found) > 5
    assert min(each["px"] for each in found) >= 13
    assert {each["family"] for each in found} == {found[0]["page"]}


def _expect_one_row(ruler: RulerPage) -> None:
    seen = ruler.page.evaluate(IN_THE_BAR)
    assert len(seen) > 6
    assert [each["name"] for each in seen if each["isCut"] or not each["isInside"]] == []
    bar = ruler.page.get_by_role("banner").bounding_box()
    assert bar is not None
    assert bar["height"] <= 72
    tools = [each for each in seen if re.match("Save|Undo|Redo|Menu", each["name"])]
    assert max(each["top"] for each in tools) - min(each["top"] for each in tools) < 2


@pytest.mark.parametrize(("width_px", "factor"), [(1440, 2), (820, 2), (390, 2), (195, 1)])
def test_the_name_is_read_where_the_text_is_twice_as_large(
    ruler: RulerPage, width_px: int, factor: int
) -> None:
    page = ruler.page
    page.set_viewport_size({"width": width_px, "height": 844})
    ruler.open("quality/inspection.adirf")
    page.add_style_tag(content=f"html {{ font-size: {100 * factor}% }}")
    ruler.button("Menu").wait_for()
    seen = page.evaluate(IN_THE_BAR)
    named = [each for each in seen if each["name"] == "quality/inspection.adirf"]
    assert len(named) == 1
    assert [each["name"] for each in seen if not each["isInside"] or (each in named and each["isCut"])] == []
    heading = page.get_by_role("heading", name="quality/inspection.adirf").bounding_box()
    assert heading is not None
    assert heading["width"] >= 80 * factor
