# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A threshold is chosen on a block beside the values that a recording holds."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, expect

from axe import violations
from bags.bag_factory import small_mission, write_bag
from ruler.browser.ruler_page import RulerPage, served

RULES = """\
begin
    SetFrequency /scan 1
    Rule "Far"
    If (CheckValue /odom pose_y > 2 For 1 s)
    Then
        SetFrequency /scan 5
    EndIf
end
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A robot that drives 8 m along y in 8 s; another that stands for longer is in no way about the rules."""
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "monday.adirf").write_text(RULES)
    write_bag(folder / "monday", small_mission(8))
    write_bag(folder / "longer", small_mission(12))
    return folder


def test_dragging_the_line_below_a_threshold_types_it(ruler: RulerPage) -> None:
    values = _opened(ruler)
    chart = values.get_by_role("figure", name="Value of /odom pose_y")
    expect(chart).to_contain_text("in monday")
    expect(values.get_by_role("status")).to_have_text(re.compile(r"^> 2: Holds for 4\.\d+ s of 7\.96 s"))
    expect(
        values.get_by_role("img", name=re.compile("^The check without its time: Holds for 5"))
    ).to_be_visible()

    values.get_by_role("slider", name="Threshold").hover()
    box = values.locator(".u-over").bounding_box()
    assert box is not None
    ruler.page.mouse.down()
    ruler.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    ruler.page.mouse.up()
    field = ruler.page.get_by_role("textbox", name="value", exact=True)
    expect(field).to_have_value(re.compile(r"^(3\.9|4)"))
    dragged = field.input_value()
    expect(values.get_by_role("status")).to_have_text(
        re.compile(rf"^> {re.escape(dragged)}: Holds for [23]\.\d+ s")
    )

    field.press("Enter")
    expect(values).to_have_count(0)
    ruler.expect_lines(f"CheckValue /odom pose_y > {dragged} For 1 s")


def test_typing_and_arrow_keys_move_the_line_and_escape_leaves_the_rule_as_it_was(ruler: RulerPage) -> None:
    values = _opened(ruler)
    line = values.get_by_role("slider", name="Threshold")
    expect(line).to_have_attribute("aria-valuenow", "2")
    ruler.page.keyboard.press("Control+a")
    ruler.page.keyboard.type("6")
    expect(line).to_have_attribute("aria-valuenow", "6")
    expect(values.get_by_role("status")).to_have_text(re.compile(r"^> 6: Holds for 0\.\d+ s"))
    ruler.page.keyboard.press("ArrowUp")
    field = ruler.page.get_by_role("textbox", name="value", exact=True)
    expect(field).to_have_value("6.1")
    ruler.page.keyboard.press("Escape")
    expect(ruler.blocks.get_by_role("button", name="Edit value: 2")).to_be_visible()
    ruler.expect_lines("CheckValue /odom pose_y > 2 For 1 s")


def test_what_the_recording_lacks_is_said(ruler: RulerPage, project: Path) -> None:
    (project / "monday.adirf").write_text(RULES.replace("/odom pose_y", "/gripper force"))
    values = _opened(ruler)
    expect(values).to_contain_text("monday has no values of /gripper force")


@pytest.mark.parametrize("width", [1280, 390])
def test_the_values_are_whole_on_every_screen_and_fit_for_screen_readers(
    browser: Browser, project: Path, width: int
) -> None:
    with served(project) as url:
        context = browser.new_context(viewport={"width": width, "height": 844})
        ruler = RulerPage(context.new_page(), url)
        ruler.home()
        values = _opened(ruler)
        expect(values.get_by_role("slider", name="Threshold")).to_be_in_viewport(ratio=1)
        expect(values.get_by_role("status")).to_be_in_viewport(ratio=1)
        box = values.bounding_box()
        assert box is not None
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= width
        assert violations(ruler.page) == []
        context.close()


def _opened(ruler: RulerPage) -> Locator:
    """What stands below the open threshold of the only check."""
    ruler.open("monday.adirf")
    ruler.field("Edit value: 2").click()
    return ruler.page.locator(".picker-chart")
