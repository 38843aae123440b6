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

TWO_MEANINGS = "“1,250” can mean 1.25 or 1250: write 1.25 or 1250."
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
    ruler.home()
    ruler.open(name)
    return MapPage(ruler)


def saved(ruler: RulerPage, path: Path) -> str:
    ruler.save()
    return path.read_text()


@pytest.mark.journey
def test_a_zone_drawn_with_the_mouse_is_the_rule_in_the_text(ruler: RulerPage, project: Path) -> None:
    ruler.button("New Rule File").click()
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
    ruler.field("zone: Zone 1").wait_for()


def test_a_zone_and_its_block_are_chosen_together(ruler: RulerPage, rules: Path) -> None:
    open_map(ruler, rules.name)
    ruler.field("Edit name of the rule: Hall").click()
    ruler.page.keyboard.press("Escape")
    expect(ruler.button("Hall")).to_have_attribute("aria-pressed", "true")
    expect(ruler.button("Bay")).to_have_attribute("aria-pressed", "false")
    ruler.button("Bay").click()
    ruler.open_pane("Text")
    expect(ruler.text.get_by_text('"Bay"')).to_be_visible()


@pytest.mark.journey
def test_a_polygon_becomes_rectangles_that_say_what_they_add(ruler: RulerPage, rules: Path) -> None:
    map_page = open_map(ruler, "bay.adirf")
    map_page.tool("Draw a polygon")
    map_page.press((10, 0), (16, 0), (18, 4))
    ruler.page.keyboard.press("Control+z")
    map_page.press((16, 4), (10, 0))
    said = ruler.page.get_by_text("Rules know rectangles only")
    said.wait_for()
    assert re.search(
        r"8 rectangles cover the polygon of 1[123]\.\d m² and [\d.]+ m² beside it \(\d+ % more\)",
        said.inner_text(),
    )
    map_page.form.get_by_label("Rectangles at most").fill("2")
    map_page.form.get_by_role("button", name="Show").click()
    expect(ruler.page.get_by_text("2 rectangles cover the polygon")).to_be_visible()
    ruler.page.get_by_label("Name of the new rule").fill("Ramp")
    ruler.button("Add the zone").click()
    ruler.page.get_by_role("group", name="Zone of Ramp").wait_for()
    expect(ruler.page.get_by_text("/odom: 2 rectangles")).to_be_visible()
    text = saved(ruler, rules)
    assert text.startswith(RULES.removesuffix("end\n"))
    assert text.count("pose_x >=") == text.count("OR (") + 1 == 2
    map_page.form.get_by_label("Move all by x (m)").fill("1,250")
    ruler.button("Move all").click()
    expect(map_page.form.get_by_role("alert")).to_have_text(TWO_MEANINGS)
    map_page.form.get_by_label("Move all by x (m)").fill("1")
    ruler.button("Move all").click()
    expect(map_page.form.get_by_role("alert")).to_have_count(0)
    expect(ruler.tool("Save")).to_be_enabled()
    moved = saved(ruler, rules)
    lines = [(old, new) for old, new in zip(text.splitlines(), moved.splitlines(), strict=True) if old != new]
    assert len(lines) == 4
    assert all("pose_x" in old for old, _ in lines)
    assert [number_in(new) - number_in(old) for old, new in lines] == pytest.approx([1, 1, 1, 1])


def number_in(line: str) -> float:
    return float(line.rsplit(maxsplit=1)[-1])


@pytest.mark.journey
def test_the_background_is_remembered_and_a_changed_map_is_said(
    ruler: RulerPage, project: Path, rules: Path
) -> None:
    odd = project / "<img src=x onerror=alert(1)>.yaml"
    odd.write_text((project / "warehouse_map.yaml").read_text())
    map_page = open_map(ruler, "bay.adirf")
    ruler.page.get_by_label("Background").select_option(f"Map: {odd.name}")
    with ruler.page.expect_response(lambda answer: is_picture_of("warehouse_map", answer.url)) as answer:
        ruler.page.get_by_label("Background").select_option("Map: warehouse_map.yaml")
    assert answer.value.ok
    assert answer.value.headers["content-type"] == "image/png"
    ruler.save()
    assert rules.read_text() == RULES
    (project / "warehouse_map.yaml").write_text(odd.read_text().replace("-8.5", "-7.5"))
    map_page = open_map(ruler, "bay.adirf")
    expect(ruler.page.get_by_label("Background")).to_have_value("map warehouse_map.yaml")
    warning = ruler.page.get_by_text("warehouse_map.yaml has changed since it was chosen here")
    warning.wait_for()
    ruler.button("They are right").click()
    expect(warning).to_have_count(0)
    assert map_page.canvas.is_visible()


def is_picture_of(name: str, url: str) -> bool:
    return "/api/background/picture?" in url and f"name={name}." in url
