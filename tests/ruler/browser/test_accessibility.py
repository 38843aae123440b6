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
from ruler.incident_projects import add_bad_incidents, write_incidents

RULES = """\
begin
    SetFrequency /odom 10
    SetFrequency /scan 1

    // where the shelves are
    Rule "Far"
    If (CheckValue /odom pose_y > 2 AND CheckValue /odom pose_x < 5)
    Then
        SetFrequency /scan 5
    EndIf

    Rule "Farther"
    If (CheckValue /odom pose_y > 4 Until < 3 For 2 s AND (Not CheckValue /odom pose_x > 5) Within 1 min)
    Then
        SetFrequency /scan 3
        KeepWithin /odom position 0.1
    Else
        Record "back" /odom Before 2 s After 500 ms
    EndIf
end
"""
THEIRS = RULES.replace("/scan 5", "/scan 6")


FOLDED = "".join(
    f'\n    // Hall {number}\n\n    Rule "Rule {number}"\n    If CheckValue /odom pose_x > {number}\n'
    "    Then\n        SetFrequency /odom 3\n    EndIf\n"
    for number in range(21)
)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = copied(EXAMPLES, tmp_path / "project")
    write_incidents(folder)
    add_bad_incidents(folder)
    (folder / "far.adirf").write_text(RULES)
    (folder / "long.adirf").write_text(f"begin\n{FOLDED}end\n")
    return folder


def _home(ruler: RulerPage) -> None:
    ruler.button("not connected").click()


def _new_project(ruler: RulerPage) -> None:
    ruler.button("New Rule File").click()
    ruler.page.get_by_role("dialog").wait_for()


def _documentation(ruler: RulerPage) -> None:
    ruler.button("Documentation").click()
    ruler.page.get_by_role("heading", name="Rules in five minutes").wait_for()


def _documentation_beside(ruler: RulerPage) -> None:
    """A search in the documentation, beside the rules."""
    _rules(ruler)
    ruler.tool("Documentation").click()
    search = ruler.page.get_by_role("combobox", name="Search the documentation")
    search.fill("never holds")
    ruler.page.get_by_role("listbox", name="Found in the documentation").wait_for()


def _menu(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.tool("Format").wait_for()


def _rules(ruler: RulerPage) -> None:
    ruler.open("far.adirf")
    ruler.page.get_by_role("list", name="Findings").wait_for()
    expect(ruler.text).to_contain_text("Farther")


def _long_rules(ruler: RulerPage) -> None:
    """With an outline, sections, and rules that are folded."""
    ruler.open("long.adirf")
    ruler.page.get_by_role("listbox", name="Rules in the order of the text").focus()
    ruler.field("Unfold Rule 1")


def _changed_rules(ruler: RulerPage) -> None:
    """With a mark in the text, a selected block, and a message."""
    _rules(ruler)
    ruler.button("New rate").click()
    ruler.save()
    ruler.page.get_by_role("button", name="line").first.click()


def _typed_rules(ruler: RulerPage) -> None:
    """With suggestions in the text, and an error."""
    _rules(ruler)
    ruler.text.get_by_text("SetFrequency", exact=False).first.click()
    ruler.page.keyboard.press("End")
    ruler.page.keyboard.type("\nSetFrequency /")
    ruler.page.keyboard.press("Control+Space")
    ruler.page.get_by_role("listbox", name="Completions").wait_for()
    expect(ruler.page.get_by_text("The text has an error")).to_be_visible()


def _list_of_blocks(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.page.get_by_role("treeitem", name="Checks").click()
    ruler.page.get_by_role("listbox", name="Checks blocks").wait_for()


def _map(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.page.get_by_role("tab", name="Map").click()
    ruler.page.get_by_role("button", name="Type a zone").click()


def _versions(ruler: RulerPage) -> None:
    """Two versions side by side."""
    _rules(ruler)
    ruler.button("New rate").click()
    ruler.save()
    ruler.page.get_by_role("tab", name="Versions").click()
    ruler.page.get_by_role("listitem", name="Version of").last.get_by_role("button", name="Compare").click()
    ruler.page.get_by_role("figure", name="Open now").wait_for()


def _optimizer(ruler: RulerPage) -> None:
    ruler.open("quality/inspection.adirf")
    ruler.tool("Optimize and Download").click()
    ruler.button("Download rates").wait_for()


def _robot(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.page.get_by_role("tab", name="Robot").click()


def _trial(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.page.get_by_role("tab", name="Try on a recording").click()
    ruler.button("Run the rules on it").click()
    ruler.page.get_by_role("region", name="Decisions").wait_for()


def _incidents(ruler: RulerPage) -> None:
    ruler.button("Look at Incidents").click()
    ruler.page.get_by_role("table", name="Incidents").wait_for()


def _incident(ruler: RulerPage) -> None:
    _incidents(ruler)
    ruler.page.get_by_role("link", name="all of it").click()
    ruler.page.get_by_role("figure", name="Rate of /odom").wait_for()


def _deleting(ruler: RulerPage) -> None:
    _incident(ruler)
    ruler.button("Delete").click()
    ruler.page.get_by_role("dialog").wait_for()


def _export(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.tool("Export").click()
    ruler.page.get_by_role("dialog", name="Export rules").wait_for()


def _import(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.tool("Import").click()
    dialog = ruler.page.get_by_role("dialog")
    dialog.get_by_role("combobox").first.select_option("warehouse.adirf")
    dialog.get_by_role("checkbox").first.wait_for()


def _conflict(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.button("New rate").click()
    expect(ruler.tool("Save")).to_be_enabled()
    ruler.page.evaluate(
        """async (text) => {
            const {hash} = await (await fetch("api/file?name=far.adirf")).json();
            await fetch("api/file", {method: "PUT", headers: {"Content-Type": "application/json"},
                body: JSON.stringify({name: "far.adirf", text, base_hash: hash})});
        }""",
        THEIRS,
    )
    ruler.tool("Save").click()
    ruler.page.get_by_role("dialog", name="Somebody else changed").wait_for()
    ruler.forgive("409")


def _parameters(ruler: RulerPage) -> None:
    ruler.page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    size = ruler.page.get_by_role("textbox", name="Message size (KB) of").first
    size.fill("a lot")
    expect(ruler.page.get_by_role("list", name="Problems")).to_contain_text("is not a number")


def _levels(ruler: RulerPage) -> None:
    """The six levels of a topic on the curve of a recording."""
    ruler.page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    ruler.page.get_by_role("combobox", name="Topic").select_option("/odom")
    ruler.page.get_by_role("combobox", name="Recording").select_option("monday")
    ruler.button("Show what each rate loses").click()
    ruler.page.get_by_text("The curve as numbers").click()


def _accuracies(ruler: RulerPage) -> None:
    """The six accuracies of a topic, with what they need."""
    ruler.page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    ruler.page.get_by_role("combobox", name="Topic").select_option("/odom")
    ruler.page.get_by_role("combobox", name="Levels of").select_option("Accuracy of position")
    ruler.page.get_by_role("combobox", name="Recording").select_option("monday")
    ruler.button("Show what each accuracy needs").click()
    ruler.page.get_by_text("The curve as numbers").click()


def _zones(ruler: RulerPage) -> None:
    """A zone that is chosen on the map, which has the whole page."""
    ruler.open("warehouse.adirf")
    ruler.page.get_by_role("tab", name="Map").click()
    ruler.page.get_by_role("list", name="Zones").get_by_role("button").first.click()
    ruler.page.get_by_role("group", name="Zone of").wait_for()
    ruler.page.get_by_role("button", name="Full screen: map").click()


def _recording(ruler: RulerPage) -> None:
    ruler.page.get_by_role("region", name="Recordings").get_by_role("button", name="monday").click()
    ruler.page.get_by_role("dialog", name="Start from monday").get_by_role("status").wait_for()


def _robots(ruler: RulerPage) -> None:
    ruler.button("Watch Robots").click()
    ruler.page.get_by_role("heading", name="Robots", exact=True).wait_for()


STATES: tuple[Callable[[RulerPage], None], ...] = (
    _home,
    _new_project,
    _documentation,
    _documentation_beside,
    _menu,
    _rules,
    _long_rules,
    _changed_rules,
    _typed_rules,
    _list_of_blocks,
    _map,
    _versions,
    _optimizer,
    _robot,
    _trial,
    _incidents,
    _incident,
    _deleting,
    _export,
    _import,
    _conflict,
    _parameters,
    _levels,
    _accuracies,
    _zones,
    _recording,
    _robots,
)
SIDEWAYS = "document.documentElement.scrollWidth - innerWidth"


@pytest.mark.parametrize("reach", STATES, ids=lambda reach: reach.__name__.strip("_"))
def test_axe_finds_nothing_and_no_page_is_wider_than_the_screen(
    ruler: RulerPage, reach: Callable[[RulerPage], None]
) -> None:
    reach(ruler)
    assert violations(ruler.page) == []
    for width in (820, 390):
        ruler.page.set_viewport_size({"width": width, "height": 844})
        ruler.page.wait_for_function(f"innerWidth === {width}")
        # The blocks follow the size of the window a moment later.
        until(lambda: ruler.page.evaluate(SIDEWAYS) <= 0)


def test_tab_leaves_the_text(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.text.focus()
    ruler.page.keyboard.press("Tab")
    expect(ruler.text).not_to_be_focused()
    # The line between the panes is first: its arrow keys move it.
    ruler.page.keyboard.press("Tab")
    expect(ruler.page.get_by_role("tab", name="Findings")).to_be_focused()
    ruler.page.keyboard.press("Shift+Tab")
    ruler.page.keyboard.press("Shift+Tab")
    expect(ruler.text).to_be_focused()
    expect(ruler.tool("Save")).to_be_disabled()


def _opened_at_home(ruler: RulerPage) -> None:
    ruler.page.get_by_role("region", name="Recordings").wait_for()


@pytest.mark.parametrize(
    ("reach", "opener"),
    [
        (_opened_at_home, "New Rule File"),
        (_opened_at_home, "monday"),
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


@pytest.mark.parametrize("entry", ["Import", "Export"])
def test_a_dialog_of_the_menu_gives_the_focus_back_to_its_button(ruler: RulerPage, entry: str) -> None:
    _rules(ruler)
    ruler.tool(entry).focus()
    ruler.page.keyboard.press("Enter")
    ruler.page.get_by_role("dialog").wait_for()
    ruler.page.keyboard.press("Escape")
    expect(ruler.button("Menu")).to_be_focused()


def test_a_conflict_that_is_left_gives_the_focus_back(ruler: RulerPage) -> None:
    _conflict(ruler)
    ruler.page.keyboard.press("Escape")
    expect(ruler.page.get_by_role("dialog")).to_have_count(0)
    expect(ruler.tool("Save")).to_be_focused()


def test_the_focus_is_on_the_page_where_the_button_of_a_dialog_is_disabled_now(ruler: RulerPage) -> None:
    _conflict(ruler)
    ruler.button("Read again").click()
    expect(ruler.page.get_by_role("heading", name="far.adirf", level=1)).to_be_focused()


def test_the_focus_is_on_the_page_that_a_dialog_leads_to(ruler: RulerPage) -> None:
    _new_project(ruler)
    ruler.page.keyboard.type("shelf")
    ruler.page.keyboard.press("Enter")
    expect(ruler.page.get_by_role("heading", name="shelf.adirf", level=1)).to_be_focused()


def test_a_block_that_is_pointed_at_keeps_its_colours(ruler: RulerPage) -> None:
    _rules(ruler)
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
    _rules(ruler)
    ruler.button("Show Rule Far").click()
    if how == "selected":
        ruler.blocks.locator(".blocklyHighlighted").first.click(position={"x": GRIP_PX, "y": GRIP_PX})
        ruler.blocks.locator(".blocklySelected").wait_for()
    contrasts = ruler.page.evaluate(CONTRASTS)
    assert len(contrasts) > 3
    assert [(text, contrast) for text, contrast in contrasts if contrast < 4.5] == []


def test_nothing_moves_for_who_wants_no_motion(ruler: RulerPage) -> None:
    card = ruler.page.locator(".card").first
    ruler.page.emulate_media(reduced_motion="no-preference")
    expect(card).not_to_have_css("transition-duration", "0s")
    ruler.page.emulate_media(reduced_motion="reduce")
    expect(card).to_have_css("transition-duration", "0s")
