# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a finding says to do is a button."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Locator, expect

from ruler.browser.ruler_page import RulerPage

CAMERA = """\
begin
    SetFrequency /camera/image_raw 10
    SetFrequency /camera/camera_info 3  // small
    SetFrequency /tf 10

    If CheckValue /odom pose_x > 5
    Then
        SetFrequency /odom 4
    EndIf
end
"""
PROFILE = """\
# The radio of the patrol
budget_kb_per_s = 8000
[topics."/camera/image_raw"]
message_kb = 6220  # measured
[topics."/camera/camera_info"]
message_kb = 0.38
[topics."/tf"]
[topics."/odom"]
"""


def test_hints_are_pressed_in_the_rules_and_in_the_topic_parameters(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project)
    _finding(ruler, "/tf is relayed without").get_by_role("button", name="add SetFrequency").click()
    ruler.expect_lines("SetFrequency /tf 10", "SetFrequency /tf_static Full", "If CheckValue")
    _finding(ruler, "/odom has no default").get_by_role("button", name="add SetFrequency").click()
    ruler.expect_lines("SetFrequency /tf_static Full", "SetFrequency /odom 1", "If CheckValue")
    stamps = _finding(ruler, "their stamps will not match")
    stamps.get_by_role(
        "button", name="pace /camera/camera_info with /camera/image_raw, in patrol.toml"
    ).click()
    expect(ruler.page.get_by_text("their stamps will not match")).to_have_count(0)
    told = ruler.page.get_by_role("status").filter(has_text="to patrol.toml")
    expect(told).to_contain_text(
        "Added paced_with = /camera/image_raw for /camera/camera_info to patrol.toml"
    )
    added = PROFILE.replace("0.38\n", '0.38\npaced_with = "/camera/image_raw"\n')
    assert (project / "patrol.toml").read_text() == added
    ruler.button("Take it back").click()
    expect(_finding(ruler, "their stamps will not match")).to_be_visible()
    assert (project / "patrol.toml").read_text() == PROFILE


def _open(ruler: RulerPage, project: Path) -> None:
    (project / "patrol.adirf").write_text(CAMERA)
    (project / "patrol.toml").write_text(PROFILE)
    ruler.home()
    ruler.open("patrol.adirf")
    expect(ruler.page.get_by_label("Topic parameters")).to_have_value("patrol.toml")


def _finding(ruler: RulerPage, words: str) -> Locator:
    return ruler.page.get_by_role("list", name="Findings").get_by_role("listitem").filter(has_text=words)
