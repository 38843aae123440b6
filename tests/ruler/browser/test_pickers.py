# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics, properties and levels are picked from lists that say what they mean, or typed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, expect

from axe import violations
from link.zenoh.ends import until
from ruler.browser.ruler_page import EXAMPLES, RulerPage, copied, served

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


def test_a_name_that_nobody_knows_is_kept_as_typed(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project)
    ruler.field("Edit topic to send").click()
    ruler.page.keyboard.type("/odo")
    expect(_option(ruler, "/odom")).to_be_visible()
    ruler.page.keyboard.press("Enter")
    ruler.expect_lines("SetFrequency /odo 4")
    ruler.field("Edit topic to send: /odo").click()
    _keys(ruler, "cam", "ArrowUp")
    expect(ruler.page.get_by_role("option", name="cam as typed")).to_have_attribute("aria-selected", "true")
    ruler.page.keyboard.press("Enter")
    ruler.expect_lines("SetFrequency cam 4")


def test_a_property_says_what_it_means_and_a_level_its_hz(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project)
    ruler.field("Edit property").click()
    _keys(ruler, "yaw_r")
    expect(_option(ruler, "yaw_rate")).to_contain_text("signed turning rate")
    expect(_option(ruler, "yaw_rate")).to_contain_text("rad/s")
    ruler.page.keyboard.press("Enter")
    ruler.expect_lines("CheckValue /odom yaw_rate > 5")
    ruler.field("Edit rate: 4").click()
    expect(_option(ruler, "Full")).to_contain_text("every message")
    expect(_option(ruler, "Desirable")).to_contain_text("5 – 10 Hz")
    _option(ruler, "Desirable").click()
    ruler.expect_lines("SetFrequency /odom Desirable")


def test_half_a_level_is_what_the_list_points_at_also_when_somebody_clicks_elsewhere(
    ruler: RulerPage, project: Path
) -> None:
    _open(ruler, project)
    ruler.field("Edit rate: 4").click()
    _keys(ruler, "exc")
    expect(_option(ruler, "Excessive")).to_have_attribute("aria-selected", "true")
    ruler.page.get_by_role("heading", name="Blocks").click()
    ruler.expect_lines("SetFrequency /odom Excessive")
    ruler.field("Edit rate: Excessive").click()
    _keys(ruler, "mar", "Escape")
    expect(ruler.blocks.get_by_role("button", name="Edit rate: Excessive")).to_be_visible()


def test_topics_to_record_are_picked_one_after_the_other(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project)
    ruler.field("Add recording").click()
    _keys(ruler, "near miss", "Tab")
    _keys(ruler, "odom", "Enter")
    ruler.expect_lines('Record "near miss" /odom Before')
    ruler.field("Edit topics to record").click()
    _keys(ruler, "End", " imu", "Enter")
    ruler.expect_lines('Record "near miss" /odom /imu Before')


def test_a_number_with_a_comma_is_one_number_or_is_asked_about(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project)
    ruler.field("Edit value: 5").click()
    _keys(ruler, "0,5", "Enter")
    ruler.expect_lines("CheckValue /odom pose_x > 0.5")
    ruler.field("Edit value: 0.5").click()
    _keys(ruler, "1,000", "Enter")
    expect(ruler.page.get_by_text("“1,000” can mean 1 or 1000: write 1 or 1000")).to_be_visible()
    ruler.type_value("1000")
    ruler.expect_lines("CheckValue /odom pose_x > 1000")


@pytest.mark.parametrize("width", [1280, 820, 390])
def test_a_list_is_whole_on_every_screen_and_fit_for_screen_readers(
    browser: Browser, tmp_path: Path, width: int
) -> None:
    project = copied(EXAMPLES, tmp_path / "project")
    with served(project) as url:
        context = browser.new_context(viewport={"width": width, "height": 800})
        ruler = RulerPage(context.new_page(), url)
        ruler.home()
        _open(ruler, project)
        # The text of the selected rule would stand beside the list.
        ruler.page.get_by_role("tab", name="Versions").click()
        ruler.field("Edit topic to send").click()
        # It is put where there is room for it once it is filled.
        until(lambda: _is_whole(ruler.page.get_by_role("listbox", name="topic to send"), width, 800))
        if width == 1280:
            assert violations(ruler.page) == []
        context.close()


def _open(ruler: RulerPage, project: Path) -> None:
    (project / "dock.adirf").write_text(RULES)
    (project / "dock.toml").write_text(PROFILE)
    ruler.home()
    ruler.open("dock.adirf")
    expect(ruler.page.get_by_label("Topic parameters")).to_have_value("dock.toml")


def _is_whole(listed: Locator, width: int, height: int) -> bool:
    box = listed.bounding_box()
    assert box is not None
    is_inside = box["x"] + box["width"] <= width and box["y"] + box["height"] <= height
    return is_inside and box["x"] >= 0 and box["y"] >= 0


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


def test_an_open_list_lets_the_page_rest(ruler: RulerPage, project: Path) -> None:
    _open(ruler, project)
    ruler.field("Edit topic to send").click()
    expect(_option(ruler, "/odom")).to_be_visible()
    # Findings that come later are drawn on the blocks.
    expect(ruler.page.get_by_role("tab", name=re.compile(r"Findings \(\d+\)"))).to_be_visible()
    asked = ruler.page.evaluate(
        """async () => {
            const ask = window.requestAnimationFrame;
            const frame = () => new Promise((next) => ask.call(window, next));
            for (let number = 0; number < 10; number++) await frame();
            let asked = 0;
            window.requestAnimationFrame = (act) => (asked++, ask.call(window, act));
            for (let number = 0; number < 30; number++) await frame();
            window.requestAnimationFrame = ask;
            return asked;
        }"""
    )
    assert asked == 0
