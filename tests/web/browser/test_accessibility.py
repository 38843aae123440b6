# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""axe-core finds nothing on any page and dialog, and the keyboard gets everywhere and back."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import expect

from adapters.rosbag.bag_factory import small_mission, write_bag
from axe import violations
from web.browser.ruler_page import EXAMPLES, RulerPage, copied

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


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = copied(EXAMPLES, tmp_path / "project")
    (folder / "far.adirf").write_text(RULES)
    write_bag(folder / "monday", small_mission(8))
    return folder


def _home(ruler: RulerPage) -> None:
    ruler.button("not connected").click()


def _new_project(ruler: RulerPage) -> None:
    ruler.button("Create New Project").click()
    ruler.page.get_by_role("dialog").wait_for()


def _documentation(ruler: RulerPage) -> None:
    ruler.button("Documentation").click()
    ruler.page.get_by_role("heading", name="Rules in five minutes").wait_for()


def _rules(ruler: RulerPage) -> None:
    ruler.open("far.adirf")
    ruler.page.get_by_role("list", name="Findings").wait_for()
    expect(ruler.text).to_contain_text("Farther")


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


def _optimizer(ruler: RulerPage) -> None:
    ruler.open("quality/inspection.adirf")
    ruler.button("Optimize and Download").click()
    ruler.button("Download rates").wait_for()


def _robot(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.page.get_by_role("tab", name="Robot").click()


def _trial(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.page.get_by_role("tab", name="Try on a bag").click()
    ruler.button("Run the rules on it").click()
    ruler.page.get_by_role("region", name="Decisions").wait_for()


def _export(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.button("Export").click()
    ruler.page.get_by_role("dialog", name="Export rules").wait_for()


def _import(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.button("Import").click()
    dialog = ruler.page.get_by_role("dialog")
    dialog.get_by_role("combobox").first.select_option("warehouse.adirf")
    dialog.get_by_role("checkbox").first.wait_for()


def _conflict(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.button("New rate").click()
    expect(ruler.button("Save")).to_be_enabled()
    ruler.page.evaluate(
        """async (text) => {
            const {hash} = await (await fetch("api/file?name=far.adirf")).json();
            await fetch("api/file", {method: "PUT", headers: {"Content-Type": "application/json"},
                body: JSON.stringify({name: "far.adirf", text, base_hash: hash})});
        }""",
        THEIRS,
    )
    ruler.button("Save").click()
    ruler.page.get_by_role("dialog", name="Somebody else changed").wait_for()
    ruler.forgive("409")


def _parameters(ruler: RulerPage) -> None:
    ruler.page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    size = ruler.page.get_by_role("textbox", name="Message size (KB) of").first
    size.fill("a lot")
    expect(ruler.page.get_by_role("list", name="Problems")).to_contain_text("a cell is not a number")


STATES: tuple[Callable[[RulerPage], None], ...] = (
    _home,
    _new_project,
    _documentation,
    _rules,
    _changed_rules,
    _typed_rules,
    _list_of_blocks,
    _map,
    _optimizer,
    _robot,
    _trial,
    _export,
    _import,
    _conflict,
    _parameters,
)


@pytest.mark.parametrize("reach", STATES, ids=lambda reach: reach.__name__.strip("_"))
def test_axe_finds_nothing(ruler: RulerPage, reach: Callable[[RulerPage], None]) -> None:
    reach(ruler)
    assert violations(ruler.page) == []


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
    expect(ruler.button("Save")).to_be_disabled()


def test_a_dialog_gives_the_focus_back(ruler: RulerPage) -> None:
    ruler.button("Create New Project").focus()
    ruler.page.keyboard.press("Enter")
    expect(ruler.page.get_by_label("Name")).to_be_focused()
    ruler.page.keyboard.press("Escape")
    expect(ruler.button("Create New Project")).to_be_focused()


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
