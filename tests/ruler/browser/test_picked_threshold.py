# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A threshold is chosen on a block beside the values that a recording holds."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from bags.bag_factory import small_mission, write_bag
from ruler.browser.ruler_page import RulerPage

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


@pytest.mark.journey
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


def _opened(ruler: RulerPage) -> Locator:
    """What stands below the open threshold of the only check."""
    ruler.open("monday.adirf")
    ruler.field("Edit value: 2").click()
    return ruler.page.locator(".picker-chart")
