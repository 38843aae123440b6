# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""axe-core finds nothing on any page, none scrolls sideways, and the keyboard gets everywhere and back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Literal

import pytest
from playwright.sync_api import expect

from axe import SCHEMES, violations
from link.zenoh.ends import until
from ruler.browser.ruler_page import EXAMPLES, GRIP_PX, RulerPage, copied
from ruler.browser.screens import FOLDED, RULES, STATES, at_conflict, at_new_project, at_rules
from ruler.incident_projects import add_bad_incidents, write_incidents


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = copied(EXAMPLES, tmp_path / "project")
    write_incidents(folder)
    add_bad_incidents(folder)
    (folder / "far.adirf").write_text(RULES)
    (folder / "long.adirf").write_text(f"begin\n{FOLDED}end\n")
    return folder


SIDEWAYS = "document.documentElement.scrollWidth - innerWidth"


@pytest.mark.parametrize("reach", STATES, ids=lambda reach: reach.__name__.removeprefix("at_"))
def test_axe_finds_nothing_and_no_page_is_wider_than_the_screen(
    ruler: RulerPage, reach: Callable[[RulerPage], None]
) -> None:
    reach(ruler)
    assert violations(ruler.page) == []
    for width in (820, 390):
        ruler.page.set_viewport_size({"width": width, "height": 844})
        ruler.page.wait_for_function(f"() => innerWidth === {width}")
        # The blocks follow the size of the window a moment later.
        until(lambda: ruler.page.evaluate(SIDEWAYS) <= 0)


def test_tab_leaves_the_text(ruler: RulerPage) -> None:
    at_rules(ruler)
    ruler.text.focus()
    ruler.page.keyboard.press("Tab")
    expect(ruler.text).not_to_be_focused()
    # The line between the panes is first: its arrow keys move it.
    ruler.page.keyboard.press("Tab")
    expect(ruler.page.get_by_role("combobox", name="Topic parameters")).to_be_focused()
    ruler.page.keyboard.press("Shift+Tab")
    ruler.page.keyboard.press("Shift+Tab")
    expect(ruler.text).to_be_focused()
    expect(ruler.tool("Save")).to_be_disabled()


def _opened_at_home(ruler: RulerPage) -> None:
    ruler.button("New Rule File").wait_for()


def _opened_at_recordings(ruler: RulerPage) -> None:
    ruler.page.get_by_role("link", name="Recordings", exact=True).click()
    ruler.page.get_by_role("region", name="Recordings").wait_for()


@pytest.mark.parametrize(
    ("reach", "opener"),
    [
        (_opened_at_home, "New Rule File"),
        (_opened_at_recordings, "New rules from monday"),
    ],
)
def test_a_dialog_has_the_focus_and_gives_it_back(
    ruler: RulerPage, reach: Callable[[RulerPage], None], opener: str
) -> None:
    reach(ruler)
    ruler.button(opener).focus()
    ruler.page.keyboard.press("Enter")
    dialog = ruler.page.get_by_role("dialog")
    dialog.wait_for()
    expect(dialog.locator(":focus")).to_have_count(1)
    ruler.page.keyboard.press("Escape")
    expect(dialog).to_have_count(0)
    expect(ruler.button(opener)).to_be_focused()


AFTER_A_CLICK = """async button => {
    button.click();
    await new Promise(done => setTimeout(done));
    return document.activeElement.name || document.activeElement.role;
}"""
"""What has the focus when the browser is free for the next key, which may be before its next frame."""


def test_the_key_after_an_opened_dialog_or_menu_goes_there(ruler: RulerPage) -> None:
    assert ruler.button("New Rule File").evaluate(AFTER_A_CLICK) == "name"
    ruler.page.keyboard.press("Escape")
    at_rules(ruler)
    assert ruler.button("Menu").evaluate(AFTER_A_CLICK) == "menuitem"


def test_a_dialog_of_the_menu_gives_the_focus_back_to_its_button(ruler: RulerPage) -> None:
    at_rules(ruler)
    ruler.tool("Versions").focus()
    ruler.page.keyboard.press("Enter")
    ruler.page.get_by_role("dialog").wait_for()
    ruler.page.keyboard.press("Escape")
    expect(ruler.button("Menu")).to_be_focused()


def test_a_conflict_that_is_left_gives_the_focus_back(ruler: RulerPage) -> None:
    at_conflict(ruler)
    ruler.page.keyboard.press("Escape")
    expect(ruler.page.get_by_role("dialog")).to_have_count(0)
    expect(ruler.tool("Save")).to_be_focused()


def test_the_focus_is_on_the_page_where_the_button_of_a_dialog_is_disabled_now(ruler: RulerPage) -> None:
    at_conflict(ruler)
    ruler.button("Take theirs").click()
    expect(ruler.page.get_by_role("heading", name="far.adirf", level=1)).to_be_focused()


def test_the_focus_is_on_the_page_that_a_dialog_leads_to(ruler: RulerPage) -> None:
    at_new_project(ruler)
    ruler.page.keyboard.type("shelf")
    ruler.page.keyboard.press("Enter")
    expect(ruler.page.get_by_role("heading", name="shelf.adirf", level=1)).to_be_focused()


def test_a_block_that_is_pointed_at_keeps_its_colours(ruler: RulerPage) -> None:
    at_rules(ruler)
    ruler.button("Show Rule Far").click()
    marked = ruler.blocks.locator(".blocklyHighlighted > .blocklyPath")
    expect(marked).to_have_css("filter", "none")
    expect(marked).to_have_css("fill", "rgb(162, 89, 12)")


# Of each text on a block that is pointed at or selected: the contrast to what is behind it.
CONTRASTS = """() => {
    const numbers = (colour) => colour.match(/[\\d.]+/g).map(Number);
    const luminance = (colour) => {
        const [r, g, b] = numbers(colour).map((part) => part / 255)
            .map((part) => part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const behind = (text) => {
        const field = text.parentElement.querySelector(":scope > .blocklyFieldRect");
        const fill = field && getComputedStyle(field).fill;
        const isSeen = fill && fill !== "none" && (numbers(fill)[3] ?? 1) === 1;
        const path = text.closest(".blocklyDraggable").querySelector(":scope > .blocklyPath");
        return isSeen ? fill : getComputedStyle(path).fill;
    };
    const marked = [...document.querySelectorAll(".blocklyHighlighted, .blocklySelected")];
    return marked.flatMap((block) => [...block.querySelectorAll("text.blocklyText")])
        .filter((text) => text.textContent.trim() !== "")
        .map((text) => {
            const both = [getComputedStyle(text).fill, behind(text)].map(luminance);
            return [text.textContent, (Math.max(...both) + 0.05) / (Math.min(...both) + 0.05)];
        });
}"""


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("how", ["pointed at", "selected"])
def test_a_marked_block_is_read_in_both_themes(
    ruler: RulerPage, how: str, scheme: Literal["light", "dark"]
) -> None:
    ruler.page.emulate_media(color_scheme=scheme)
    at_rules(ruler)
    ruler.button("Show Rule Far").click()
    if how == "selected":
        ruler.blocks.locator(".blocklyHighlighted > .blocklyPath").first.click(
            position={"x": GRIP_PX, "y": GRIP_PX}
        )
        ruler.blocks.locator(".blocklySelected").wait_for()
    else:
        ruler.blocks.locator(".blocklyHighlighted").first.wait_for()
    contrasts = ruler.page.evaluate(CONTRASTS)
    assert len(contrasts) > 3
    assert [(text, contrast) for text, contrast in contrasts if contrast < 4.5] == []


MOVING = """() => [...document.querySelectorAll("*")].filter((one) => {
    const { transitionDuration, animationName } = getComputedStyle(one);
    return parseFloat(transitionDuration) > 0 || animationName !== "none";
}).map((one) => one.outerHTML.slice(0, 100))"""


def test_nothing_moves_for_who_wants_no_motion(ruler: RulerPage) -> None:
    ruler.page.emulate_media(reduced_motion="reduce")
    at_rules(ruler)
    assert ruler.page.evaluate(MOVING) == []
