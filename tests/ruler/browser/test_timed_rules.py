# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules with time, bounds and recordings are built from blocks, as a new user does it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from bags.bag_factory import (
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    cdr,
    message_of,
    small_mission,
    write_bag,
)
from ruler.browser.ruler_page import GRIP_PX, RulerPage

BATTERY = BagTopic("/battery_state", "sensor_msgs/msg/BatteryState")
SECONDS = 40
LOW_BATTERY = """\
begin
    SetFrequency /odom 1

    If CheckValue /battery_state level < 20 For 10 s
    Then
        SetFrequency /odom Full
        KeepWithin /odom position 0.05
    EndIf
end
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A robot that drives 40 m in 40 s while its battery falls from 30 to 10 %."""
    folder = tmp_path / "project"
    folder.mkdir()
    mission = small_mission(SECONDS)
    battery = [
        BagMessage(
            BATTERY.name, START_NS + second * 1_000_000_000 + 3, _battery(0.3 - 0.2 * second / SECONDS)
        )
        for second in range(SECONDS)
    ]
    messages = sorted((*mission.messages, *battery), key=lambda message: message.stamp_ns)
    write_bag(folder / "monday", BagContent((*mission.topics, BATTERY), tuple(messages)))
    return folder


def _battery(percentage: float) -> bytes:
    return cdr(BATTERY.type_name, message_of(BATTERY.type_name, percentage=percentage))


def test_the_position_is_kept_within_5_cm_while_the_battery_is_low_for_10_s(
    ruler: RulerPage, project: Path
) -> None:
    _new_project(ruler)
    ruler.button("New rate").click()
    ruler.change("Edit rate: 10", "1")
    ruler.button("New rule").click()
    ruler.change("Edit topic to check", "/battery_state")
    ruler.change("Edit property: pose_x", "level")
    ruler.field("dropdown: >").click()
    ruler.page.get_by_role("option", name="<", exact=True).click()
    ruler.change("Edit value: 0", "20")
    _add_time(ruler, "for so long…")
    ruler.expect_lines("CheckValue /battery_state level < 20 For 10 s")
    ruler.change("Edit rate: 10", "Full")
    ruler.field("Add bound").click()
    ruler.change("Edit bound", "0.05")
    ruler.expect_lines("KeepWithin /odom position 0.05")
    ruler.save()
    assert (project / "low.adirf").read_text() == LOW_BATTERY

    ruler.tool("Try on a recording").click()
    ruler.button("Run the rules on it").click()
    expect(ruler.page.get_by_text(re.compile(r"[\d.]+ % less"))).to_be_visible()
    loss = ruler.page.get_by_role("region", name="What the operator loses")
    errors = loss.get_by_role("table", name="Error when the last received value is held")
    expect(errors.get_by_role("row", name="/odom pose_y")).to_contain_text("m")
    decisions = ruler.page.get_by_role("region", name="Decisions").get_by_role("row")
    expect(decisions.filter(has_text="31.0")).to_contain_text("Full")


ALL_TIMES = """\
begin
    // keep this
    Rule "Slow"  // and this
    If (CheckValue /odom speed < 0.10 // m/s
        AND (CheckValue /scan distance > 1 OR CheckValue /scan distance < 0.2))
    Then
        Record "stuck" /odom Before 30 s After 500 ms // all of it
        SetFrequency /scan 5.0
    EndIf
end
"""


def test_times_are_given_by_menus_and_taken_away_with_everything_else_untouched(
    ruler: RulerPage, project: Path
) -> None:
    (project / "slow.adirf").write_text(ALL_TIMES)
    ruler.home()
    ruler.open("slow.adirf")
    check = ruler.blocks.get_by_role("figure", name="/odom, speed")
    check.click(button="right", position={"x": GRIP_PX, "y": GRIP_PX})
    _choose(ruler, "until…")
    ruler.change("Edit value of the end: 0.1", "0.3")
    ruler.expect_lines("speed < 0.10 Until > 0.3 // m/s")
    group = ruler.blocks.get_by_role("figure", name="any of").first
    group.click(button="right", position={"x": GRIP_PX, "y": GRIP_PX})
    _choose(ruler, "within the last…")
    ruler.change("Edit duration: 10", "2")
    ruler.field("unit of time: s").click()
    ruler.page.get_by_role("option", name="min", exact=True).click()
    ruler.expect_lines("CheckValue /scan distance < 0.2) Within 2 min)")
    ruler.save()
    changed = ALL_TIMES.replace("0.10 //", "0.10 Until > 0.3 //").replace("0.2))", "0.2) Within 2 min)")
    assert (project / "slow.adirf").read_text() == changed

    ruler.field("Remove this time").click()
    ruler.field("Remove this end").click()
    expect(ruler.text).not_to_contain_text("Until")
    ruler.save()
    assert (project / "slow.adirf").read_text() == ALL_TIMES


def test_times_come_from_the_list_of_blocks_and_stand_inside_or_outside_of_a_not(ruler: RulerPage) -> None:
    _new_project(ruler)
    ruler.button("New rule").click()
    ruler.change("Edit value: 0", "1")
    _drag_below(ruler, "Times", "/odom", ruler.blocks.get_by_role("figure", name="/odom, pose_x"))
    ruler.expect_lines("(CheckValue /odom pose_x > 1 AND CheckValue /odom pose_x > 0 For 10 s)")
    ruler.field("Remove this check").click()
    ruler.expect_lines("If CheckValue /odom pose_x > 1", "Then")
    _drag_below(ruler, "Checks", "not", ruler.blocks.get_by_role("figure", name="/odom, pose_x"))
    ruler.field("Add check").click()
    _add_time(ruler, "for so long…")
    ruler.expect_lines("AND Not CheckValue /odom pose_x > 0 For 10 s)")
    group = ruler.blocks.get_by_role("figure", name="not").first
    group.click(button="right", position={"x": GRIP_PX, "y": GRIP_PX})
    _choose(ruler, "for so long…")
    ruler.change("Edit duration: 10", "20")
    ruler.expect_lines("AND (Not CheckValue /odom pose_x > 0 For 10 s) For 20 s)")


def test_a_time_is_given_and_taken_away_with_the_keyboard_alone(ruler: RulerPage) -> None:
    _new_project(ruler)
    ruler.button("New rule").click()
    ruler.expect_lines("CheckValue /odom pose_x > 0")
    keyboard = ruler.page.keyboard
    keyboard.press("Escape")
    ruler.walk("ArrowLeft", "/odom, pose_x")
    ruler.walk("ArrowRight", "Add time")
    keyboard.press("Enter")
    ruler.page.get_by_role("menuitem", name="for so long…").wait_for()
    keyboard.press("Enter")
    ruler.page.get_by_role("textbox", name="duration").wait_for()
    ruler.type_value("3")
    ruler.expect_lines("CheckValue /odom pose_x > 0 For 3 s")
    ruler.walk("ArrowRight", "Remove this time")
    keyboard.press("Enter")
    expect(ruler.text).not_to_contain_text("For")
    expect(ruler.blocks.get_by_role("button", name="Add time")).to_be_focused()


def test_a_copied_rule_keeps_what_it_records_and_bounds(ruler: RulerPage, project: Path) -> None:
    (project / "slow.adirf").write_text(ALL_TIMES)
    ruler.home()
    ruler.open("slow.adirf")
    ruler.field("Add bound").click()
    ruler.change("Edit bound", "0.2")
    ruler.expect_lines("KeepWithin /odom position 0.2")
    rule = ruler.blocks.get_by_role("figure", name="rule").first
    rule.click(position={"x": GRIP_PX, "y": GRIP_PX})
    ruler.page.keyboard.press("Control+c")
    ruler.page.keyboard.press("Control+v")
    expect(ruler.blocks.get_by_role("button", name="Edit name of the rule: Slow")).to_have_count(2)
    ruler.change("Edit name of the rule: Slow", "Copy")
    ruler.expect_lines(
        'Rule "Slow"',
        "/odom Before 30 s After 500 ms // all of it",
        "KeepWithin /odom position 0.2",
        'Rule "Copy"',
        'Record "stuck" /odom Before 30 s After 500 ms',
        "KeepWithin /odom position 0.2",
    )


def _drag_below(ruler: RulerPage, category: str, name: str, above: Locator) -> None:
    ruler.page.get_by_role("treeitem", name=category).click()
    blocks = ruler.page.get_by_role("listbox", name=f"{category} blocks")
    ruler.drag(blocks.get_by_role("option", name=name).first, above, 0, 0)


def _new_project(ruler: RulerPage) -> None:
    ruler.button("New Rule File").click()
    ruler.page.get_by_label("Name").fill("low")
    ruler.button("Create").click()


def _add_time(ruler: RulerPage, choice: str) -> None:
    ruler.field("Add time").click()
    _choose(ruler, choice)


def _choose(ruler: RulerPage, choice: str) -> None:
    ruler.page.get_by_role("menuitem", name=choice, exact=True).click()
    # It opens by itself to type into.
    ruler.page.locator("input:focus").wait_for()
