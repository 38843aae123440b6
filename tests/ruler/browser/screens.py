# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The screens of the page, each with how one gets there from the first one."""

from __future__ import annotations

from collections.abc import Callable

from playwright.sync_api import expect

from ruler.browser.ruler_page import RulerPage

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


def at_home(ruler: RulerPage) -> None:
    ruler.button("not connected").click()


def at_new_project(ruler: RulerPage) -> None:
    ruler.button("New Rule File").click()
    ruler.page.get_by_role("dialog").wait_for()


def at_menu(ruler: RulerPage) -> None:
    at_rules(ruler)
    ruler.tool("Versions").wait_for()


def at_rules(ruler: RulerPage) -> None:
    ruler.open("far.adirf")
    ruler.page.get_by_role("list", name="Findings").wait_for()
    expect(ruler.text).to_contain_text("Farther")


def at_long_rules(ruler: RulerPage) -> None:
    """With an outline, sections, and rules that are folded."""
    ruler.open("long.adirf")
    ruler.page.get_by_role("listbox", name="Rules in the order of the text").focus()
    ruler.field("Unfold Rule 1")


def at_changed_rules(ruler: RulerPage) -> None:
    """With a mark in the text, a selected block, and a message."""
    at_rules(ruler)
    ruler.button("New rate").click()
    ruler.save()
    found = ruler.page.get_by_role("list", name="Findings").get_by_role("listitem").first
    found.get_by_role("button").first.click()


def at_typed_rules(ruler: RulerPage) -> None:
    """With suggestions in the text, and an error."""
    at_rules(ruler)
    ruler.text.get_by_text("SetFrequency", exact=False).first.click()
    ruler.page.keyboard.press("End")
    ruler.page.keyboard.type("\nSetFrequency /")
    ruler.page.keyboard.press("Control+Space")
    ruler.page.get_by_role("listbox", name="Completions").wait_for()
    expect(ruler.page.get_by_text("The text has an error")).to_be_visible()


def at_list_of_blocks(ruler: RulerPage) -> None:
    at_rules(ruler)
    ruler.page.get_by_role("treeitem", name="Checks").click()
    ruler.page.get_by_role("listbox", name="Checks blocks").wait_for()


def at_map(ruler: RulerPage) -> None:
    at_rules(ruler)
    ruler.open_pane("Map")
    ruler.page.get_by_role("button", name="Draw a rectangle").click()


def at_versions(ruler: RulerPage) -> None:
    """Two versions side by side."""
    at_rules(ruler)
    ruler.button("New rate").click()
    ruler.save()
    ruler.tool("Versions").click()
    ruler.page.get_by_role("listitem", name="Version of").last.get_by_role("button", name="Compare").click()
    ruler.page.get_by_role("figure", name="Open now").wait_for()


def at_optimizer(ruler: RulerPage) -> None:
    ruler.open("quality/inspection.adirf")
    ruler.open_rates()
    ruler.page.get_by_text("Everything fits").wait_for()


def at_robot(ruler: RulerPage) -> None:
    at_rules(ruler)
    ruler.open_pane("Robot")


def at_trial(ruler: RulerPage) -> None:
    at_rules(ruler)
    ruler.open_pane("Try on a recording")
    ruler.button("Run the rules on it").click()
    ruler.page.get_by_role("region", name="Decisions").wait_for()


def at_incidents(ruler: RulerPage) -> None:
    ruler.page.get_by_role("link", name="Incidents", exact=True).click()
    ruler.page.get_by_role("table", name="Incidents").wait_for()


def at_incident(ruler: RulerPage) -> None:
    at_incidents(ruler)
    ruler.page.get_by_role("link", name="all of it").click()
    ruler.page.get_by_role("slider", name="Time around the moment (s)").wait_for()


def at_deleting(ruler: RulerPage) -> None:
    at_incident(ruler)
    ruler.button("Delete").click()
    ruler.page.get_by_role("dialog").wait_for()


def at_conflict(ruler: RulerPage) -> None:
    at_rules(ruler)
    ruler.button("New rate").click()
    expect(ruler.tool("Save")).to_be_enabled()
    ruler.page.evaluate(
        """async (text) => {
            const {hash} = await (await fetch("api/file?name=far.adirf")).json();
            const {draft} = await (await fetch("api/draft?name=far.adirf")).json();
            const known = draft ? [draft.id] : [];
            await fetch("api/file", {method: "PUT", headers: {"Content-Type": "application/json"},
                body: JSON.stringify({name: "far.adirf", text, base_hash: hash, draft_ids: known})});
        }""",
        THEIRS,
    )
    ruler.tool("Save").click()
    ruler.page.get_by_role("dialog", name="was changed elsewhere").wait_for()
    ruler.forgive("409")


def at_parameters(ruler: RulerPage) -> None:
    ruler.page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    size = ruler.page.get_by_role("textbox", name="Message size (KB) of").first
    size.fill("a lot")
    expect(ruler.page.get_by_role("list", name="Problems")).to_contain_text("is not a number")


def at_levels(ruler: RulerPage) -> None:
    """The six levels of a topic on the curve of a recording."""
    ruler.page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    ruler.page.get_by_role("combobox", name="Topic").select_option("/odom")
    ruler.page.get_by_role("combobox", name="Recording").select_option("monday")
    ruler.button("Show what each rate loses").click()
    ruler.page.get_by_text("The curve as numbers").click()


def at_accuracies(ruler: RulerPage) -> None:
    """The six accuracies of a topic, with what they need."""
    ruler.page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    ruler.page.get_by_role("combobox", name="Topic").select_option("/odom")
    ruler.page.get_by_role("combobox", name="Levels of").select_option("Accuracy of position")
    ruler.page.get_by_role("combobox", name="Recording").select_option("monday")
    ruler.button("Show what each accuracy needs").click()
    ruler.page.get_by_text("The curve as numbers").click()


def at_zones(ruler: RulerPage) -> None:
    """A zone that is chosen on the map, which has the whole page."""
    ruler.open("warehouse.adirf")
    ruler.open_pane("Map")
    ruler.page.get_by_role("list", name="Zones").get_by_role("button").first.click()
    ruler.page.get_by_role("group", name="Zone of").wait_for()
    ruler.page.get_by_role("button", name="Full screen: map").click()


def at_recording(ruler: RulerPage) -> None:
    ruler.page.get_by_role("link", name="Recordings", exact=True).click()
    ruler.button("New rules from monday").click()
    ruler.page.get_by_role("dialog", name="Start from monday").get_by_role("status").wait_for()


def at_robots(ruler: RulerPage) -> None:
    ruler.page.get_by_role("link", name="Robots").click()
    ruler.page.get_by_role("heading", name="Robots", exact=True).wait_for()


STATES: tuple[Callable[[RulerPage], None], ...] = (
    at_home,
    at_new_project,
    at_menu,
    at_rules,
    at_long_rules,
    at_changed_rules,
    at_typed_rules,
    at_list_of_blocks,
    at_map,
    at_versions,
    at_optimizer,
    at_robot,
    at_trial,
    at_incidents,
    at_incident,
    at_deleting,
    at_conflict,
    at_parameters,
    at_levels,
    at_accuracies,
    at_zones,
    at_recording,
    at_robots,
)
