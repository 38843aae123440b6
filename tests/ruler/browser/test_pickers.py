# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics, properties and levels are picked from lists that say what they mean, or typed."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Locator, expect

from axe import violations
from ruler.browser.ruler_page import RulerPage

RULES = """\
begin
    SetFrequency /odom 10

    Rule "Dock"
    If CheckValue /odom pose_x > 5
    Then
        SetFrequency /odom 4
    EndIf
end
"""
PROFILE = """\
[topics."/odom"]
source_hz = 20
tiers_hz = [1, 2, 5, 10, 15, 20]
"""


def test_a_topic_says_its_type_its_rate_and_its_users(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project)
    ruler.field("Edit topic to send").click()
    odom = _option(ruler, "/odom")
    expect(odom).to_contain_text("20 Hz in dock.toml")
    expect(odom).to_contain_text("nav_msgs/msg/Odometry · used by a default, Dock")
    expect(odom).to_have_attribute("aria-selected", "true")
    _keys(ruler, "image_raw", "Enter")
    ruler.expect_lines("SetFrequency /camera/image_raw 4")


def test_an_open_list_is_fit_for_screen_readers(ruler: RulerPage, project: Path) -> None:
    ruler.page.set_viewport_size({"width": 1280, "height": 800})
    _open(ruler, project)
    # The text of the selected rule would stand beside the list.
    ruler.open_pane("Map")
    ruler.field("Edit topic to send").click()
    _option(ruler, "/odom").wait_for()
    assert violations(ruler.page) == []


def _open(ruler: RulerPage, project: Path) -> None:
    (project / "dock.adirf").write_text(RULES)
    (project / "dock.toml").write_text(PROFILE)
    ruler.home()
    ruler.open("dock.adirf")
    expect(ruler.page.get_by_label("Topic parameters")).to_have_value("dock.toml")


def _option(ruler: RulerPage, word: str) -> Locator:
    words = ruler.page.locator(".word").get_by_text(word, exact=True)
    return ruler.page.get_by_role("option").filter(has=words)


def _keys(ruler: RulerPage, *keys: str) -> None:
    """Type words, and press keys with names."""
    for key in keys:
        if key in {"Enter", "Tab", "Escape", "End", "ArrowUp"}:
            ruler.page.keyboard.press(key)
        else:
            ruler.page.keyboard.type(key)
