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
    ruler.expect_lines("SetFrequency /tf_static Full", "SetFrequency /odom Full", "If CheckValue")
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


def test_every_finding_has_a_way_to_go(ruler: RulerPage, project: Path) -> None:
    clash = CAMERA.replace("EndIf", "EndIf\n    If CheckValue /odom pose_x > 9 Then SetFrequency /odom 2")
    never = "If (CheckValue /odom pose_x > 5 AND CheckValue /odom speed < -1)"
    _open(ruler, project, clash.replace("If CheckValue /odom pose_x > 5", never))
    rows = ruler.page.get_by_role("list", name="Findings").get_by_role("listitem")
    expect(rows.filter(has_text="never below 0").first).to_be_visible()
    ways = ruler.page.locator("button:not(.link), a:not(.why)")
    expect(rows.filter(has_not=ways)).to_have_count(0)


def test_what_the_optimizer_lacks_is_measured_or_entered(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project)
    ruler.page.get_by_role("tab", name="Optimize").click()
    expect(ruler.page.get_by_text("do not say all that is needed of")).to_be_visible()
    ruler.page.get_by_role("link", name="Enter it in patrol.toml").click()
    expect(ruler.page.get_by_label("Total bandwidth (KB/s)")).to_have_value("8000")
    # The rates could not be computed, which the page may have asked for twice.
    ruler.forgive("422")


def _open(ruler: RulerPage, project: Path, text: str = CAMERA) -> None:
    (project / "patrol.adirf").write_text(text)
    (project / "patrol.toml").write_text(PROFILE)
    ruler.home()
    ruler.open("patrol.adirf")
    expect(ruler.page.get_by_label("Topic parameters")).to_have_value("patrol.toml")


def _finding(ruler: RulerPage, words: str) -> Locator:
    return ruler.page.get_by_role("list", name="Findings").get_by_role("listitem").filter(has_text=words)
