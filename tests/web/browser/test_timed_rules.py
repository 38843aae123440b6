# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules with time, bounds and recordings are built from blocks, as a new user does it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import expect

from adapters.rosbag.bag_factory import (
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    cdr,
    message_of,
    small_mission,
    write_bag,
)
from web.browser.ruler_page import RulerPage

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

    ruler.button("Try on a bag").click()
    ruler.button("Run the rules on it").click()
    expect(ruler.page.get_by_text(re.compile(r"[\d.]+ % less"))).to_be_visible()
    loss = ruler.page.get_by_role("region", name="What the operator loses")
    errors = loss.get_by_role("table", name="Error when the last received value is held")
    expect(errors.get_by_role("row", name="/odom pose_y")).to_contain_text("m")
    decisions = ruler.page.get_by_role("region", name="Decisions").get_by_role("row")
    expect(decisions.filter(has_text="31.0")).to_contain_text("Full")


def _new_project(ruler: RulerPage) -> None:
    ruler.button("Create New Project").click()
    ruler.page.get_by_label("Name").fill("low")
    ruler.button("Create").click()


def _add_time(ruler: RulerPage, choice: str) -> None:
    ruler.field("Add time").click()
    ruler.page.get_by_role("menuitem", name=choice, exact=True).click()
