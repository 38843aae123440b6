# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Zones are drawn and moved on a map, and the text says just that."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import expect

from ruler.browser.map_page import MapPage
from ruler.browser.ruler_page import RulerPage

RULES = """\
begin
    SetFrequency /odom 10  // the map needs it

    // Loading bay, 4 m wide
    Rule "Bay" If (CheckValue /odom pose_x > 1.0 AND CheckValue /odom pose_x<5.00 // the gate
        AND (CheckValue /odom pose_y>=2 AND CheckValue /odom pose_y < 6))
    Then SetFrequency /odom 4 EndIf
    Rule "Hall" If CheckValue /odom pose_x > 20 Then SetFrequency /odom 7
end
"""


@pytest.fixture
def rules(project: Path) -> Path:
    path = project / "bay.adirf"
    path.write_text(RULES)
    return path


def open_map(ruler: RulerPage, name: str) -> MapPage:
    ruler.page.reload()
    ruler.open(name)
    return MapPage(ruler)


def saved(ruler: RulerPage, path: Path) -> str:
    ruler.save()
    return path.read_text()


def test_a_zone_drawn_with_the_mouse_is_the_rule_in_the_text(ruler: RulerPage, project: Path) -> None:
    ruler.button("Create New Project").click()
    ruler.page.get_by_label("Name").fill("shelf")
    ruler.button("Create").click()
    map_page = MapPage(ruler)
    map_page.tool("Draw a rectangle")
    map_page.drag((2, -1), (9, 3))
    expect(map_page.form).to_contain_text("New zone")
    left, right, low, high = map_page.sides()
    assert [float(side) for side in (left, right, low, high)] == pytest.approx([2, 9, -1, 3], abs=0.2)
    ruler.button("Add the zone").click()
    ruler.page.get_by_role("group", name="Zone of Zone 1").wait_for()
    assert map_page.sides() == [left, right, low, high]
    assert saved(ruler, project / "shelf.adirf") == (
        'begin\n    Rule "Zone 1"\n    If (\n'
        f"        CheckValue /odom pose_x > {left}\n"
        f"        AND CheckValue /odom pose_x < {right}\n"
        f"        AND CheckValue /odom pose_y > {low}\n"
        f"        AND CheckValue /odom pose_y < {high}\n"
        "    )\n    Then\n        SetFrequency /odom 10\n    EndIf\nend\n"
    )
    ruler.field("Edit value: ").wait_for()


def test_a_moved_zone_changes_four_numbers_and_nothing_else(ruler: RulerPage, rules: Path) -> None:
    map_page = open_map(ruler, "bay.adirf")
    map_page.press((3, 4))
    expect(ruler.button("Bay")).to_have_attribute("aria-pressed", "true")
    map_page.drag((3, 4), (5, 3))
    expect(map_page.form.get_by_label("x from (m)")).not_to_have_value("1")
    text = saved(ruler, rules)
    numbers = re.compile(r"(?<=pose_x > )1\.0|(?<=pose_x<)5\.00|(?<=pose_y>=)2|(?<=pose_y < )6")
    left, right, low, high = map_page.sides()
    moved = iter((left, right, low, high))
    assert text == numbers.sub(lambda _: next(moved), RULES)
    assert (float(right) - float(left), float(high) - float(low)) == (pytest.approx(4), pytest.approx(4))
    assert (float(left), float(low)) == (pytest.approx(3, abs=0.3), pytest.approx(1, abs=0.3))
    ruler.button("Undo").click()
    assert saved(ruler, rules) == RULES
