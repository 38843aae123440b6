# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Zones are drawn and moved on a map, and the text says just that."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import expect

from bags.bag_factory import localized_mission, write_bag
from ruler.browser.map_page import MapPage
from ruler.browser.ruler_page import RulerPage

# Whether an element that says this comes, however short it stays.
WATCH_FOR = """words => {
    window.isSeen = false;
    const look = () => (window.isSeen ||= document.body.innerText.includes(words));
    new MutationObserver(look).observe(document.body, {childList: true, subtree: true, characterData: true});
}"""
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
    assert (float(right) - float(left), float(high) - float(low)) == pytest.approx((4, 4))
    assert (float(left), float(low)) == pytest.approx((3, 1), abs=0.3)
    ruler.tool("Undo").click()
    assert saved(ruler, rules) == RULES


def test_an_added_zone_is_what_its_fields_say(ruler: RulerPage, rules: Path) -> None:
    map_page = open_map(ruler, "bay.adirf")
    ruler.button("Type a zone").click()
    map_page.form.get_by_label("x to (m)").fill("wide")
    expect(ruler.page.get_by_text('"x to (m)" is not a number.')).to_be_visible()
    expect(ruler.button("Add the zone")).to_be_disabled()
    map_page.form.get_by_label("x to (m)").fill("-1")
    expect(ruler.page.get_by_text('"x to (m)" must be more than "x from (m)".')).to_be_visible()
    map_page.type_sides("11", "15", "7", "11.25")
    ruler.button("Add the zone").click()
    ruler.page.get_by_role("group", name="Zone of Zone 1").wait_for()
    assert map_page.sides() == ["11", "15", "7", "11.25"]

    ruler.button("Type a zone").click()
    map_page.form.get_by_label("Shape").select_option("Polygon")
    corners = map_page.form.get_by_label("Corners")
    corners.fill("0 0, 4 0, 4 2, 0 2")
    map_page.form.get_by_role("button", name="Show").click()
    expect(ruler.button("Add the zone")).to_be_enabled()
    corners.fill("0 0, 4 0, 4 9, 0 9")
    expect(ruler.button("Add the zone")).to_be_disabled()
    ruler.button("Discard").click()
    map_page.tool("Draw a rectangle")
    map_page.drag((6, 3), (9, 5))
    expect(ruler.button("Add the zone")).to_be_enabled()


def test_what_adds_a_polygon_is_seen(ruler: RulerPage, rules: Path) -> None:
    map_page = open_map(ruler, "bay.adirf")
    ruler.button("Type a zone").click()
    map_page.form.get_by_label("Shape").select_option("Polygon")
    map_page.form.get_by_label("Corners").fill("0 0, 4 0, 2 3")
    map_page.form.get_by_role("button", name="Show").click()
    expect(ruler.page.get_by_text("Rules know rectangles only")).to_be_visible()
    for name in ("Add the zone", "Discard"):
        expect(ruler.button(name)).to_be_in_viewport(ratio=1)
    ruler.button("Add the zone").click()
    expect(ruler.button("Zone 1")).to_be_focused()


def test_the_wheel_scrolls_and_zooms_only_with_ctrl(ruler: RulerPage, rules: Path) -> None:
    map_page = open_map(ruler, rules.name)
    scale = ruler.page.get_by_role("group", name="Scale")
    before = scale.text_content()
    map_page.canvas.hover()
    # It goes again by itself.
    ruler.page.evaluate(WATCH_FOR, "Hold Ctrl to zoom with the wheel")
    ruler.page.mouse.wheel(0, -400)
    ruler.page.wait_for_function("() => window.isSeen")
    expect(scale).to_have_text(str(before))
    ruler.page.keyboard.down("Control")
    ruler.page.mouse.wheel(0, -400)
    ruler.page.keyboard.up("Control")
    expect(scale).not_to_have_text(str(before))


def test_a_zone_and_its_block_are_chosen_together(ruler: RulerPage, rules: Path) -> None:
    open_map(ruler, rules.name)
    ruler.field("Edit name of the rule: Hall").click()
    ruler.page.keyboard.press("Escape")
    expect(ruler.button("Hall")).to_have_attribute("aria-pressed", "true")
    expect(ruler.button("Bay")).to_have_attribute("aria-pressed", "false")
    ruler.button("Bay").click()
    ruler.page.get_by_role("tab", name="Text", exact=True).click()
    expect(ruler.text.get_by_text('"Bay"')).to_be_visible()


def test_a_zone_is_made_and_moved_with_the_keyboard_alone(ruler: RulerPage, rules: Path) -> None:
    keyboard = ruler.page.keyboard
    ruler.home()
    ruler.walk("Tab", "bay.adirf")
    keyboard.press("Enter")
    expect(ruler.button("New rule")).to_be_enabled()
    ruler.walk("Tab", "Text")
    keyboard.press("ArrowRight")
    ruler.page.get_by_role("application", name="Zones on the map").wait_for()
    ruler.walk("Tab", "Type a zone")
    keyboard.press("Enter")
    for label, value in (("x from", "11"), ("x to", "15"), ("y from", "7"), ("y to", "11.25")):
        walk_to_field(ruler, label)
        ruler.page.keyboard.press("Control+a")
        keyboard.type(value)
    keyboard.press("Enter")
    # Nothing can be added, or has the focus, before the zones of the rules are known.
    expect(ruler.button("Add the zone")).to_be_enabled()
    ruler.walk("Tab", "Add the zone")
    keyboard.press("Enter")
    ruler.page.get_by_role("group", name="Zone of Zone 1").wait_for()
    expect(ruler.button("Zone 1")).to_be_focused()
    walk_to_field(ruler, "x to")
    keyboard.press("Control+a")
    keyboard.type("14.5")
    keyboard.press("Enter")
    ruler.page.get_by_text("x 11 … 14.5 m, y 7 … 11.25 m").wait_for()
    keyboard.press("Control+s")
    expect(ruler.tool("Save")).to_be_disabled()
    written = [
        "CheckValue /odom pose_x > 11\n",
        "AND CheckValue /odom pose_x < 14.5\n",
        "AND CheckValue /odom pose_y > 7\n",
        "AND CheckValue /odom pose_y < 11.25\n",
    ]
    text = rules.read_text()
    assert text.startswith(RULES.removesuffix("end\n"))
    assert [text.index(line) for line in written] == sorted(text.index(line) for line in written)


def walk_to_field(ruler: RulerPage, label: str) -> None:
    for _ in range(60):
        ruler.page.keyboard.press("Tab")
        found = ruler.page.evaluate(
            "[...document.activeElement.labels ?? []].map(one => one.textContent).join()"
        )
        if found.startswith(label):
            return
    raise AssertionError(f"Tab does not lead to {label!r}")


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


def test_overlapping_zones_that_clash_are_named_and_a_handle_parts_them(
    ruler: RulerPage, rules: Path
) -> None:
    rules.write_text(RULES.replace("pose_x > 20", "pose_x > 4"))
    map_page = open_map(ruler, "bay.adirf")
    clash = ruler.page.get_by_text(re.compile('Clash: "Hall" sets /odom to 7 Hz, "Bay" .* to 4 Hz'))
    clash.wait_for()
    ruler.button("Bay").click()
    map_page.drag((5, 4), (3, 4))
    expect(clash).to_have_count(0)
    assert map_page.sides()[0::2] == ["1", "2"]
    assert saved(ruler, rules).replace(f"pose_x<{map_page.sides()[1]}", "pose_x<5.00") == RULES.replace(
        "> 20", "> 4"
    )


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


def test_an_image_has_the_scale_that_somebody_gives_it(ruler: RulerPage, project: Path, rules: Path) -> None:
    (project / "plan.png").write_bytes((project / "warehouse_map.png").read_bytes())
    open_map(ruler, "bay.adirf")
    with ruler.page.expect_response(lambda answer: is_picture_of("plan", answer.url)):
        ruler.page.get_by_label("Background").select_option("Image: plan.png")
    ruler.page.get_by_label("Metres per pixel").fill("1,250")
    ruler.page.get_by_label("Turned by (°)").focus()
    problem = ruler.page.get_by_role("alert")
    expect(problem).to_have_text(f"Metres per pixel: {TWO_MEANINGS}")
    ruler.page.get_by_label("Metres per pixel").fill("0.5")
    ruler.page.get_by_label("Turned by (°)").fill("90")
    expect(problem).to_have_count(0)
    ruler.page.get_by_label("Turned by (°)").press("Tab")
    ruler.save()
    ruler.page.get_by_role("link", name="Home").click()
    ruler.open("bay.adirf")
    MapPage(ruler)
    expect(ruler.page.get_by_label("Metres per pixel")).to_have_value("0.5")
    expect(ruler.page.get_by_label("Turned by (°)")).to_have_value("90")
    ruler.page.get_by_label("Background").select_option("Plain grid")
    ruler.save()
    assert rules.read_text() == RULES


def test_a_robot_that_knows_its_place_in_the_map_is_drawn_there_and_read_there(
    ruler: RulerPage, project: Path, rules: Path
) -> None:
    write_bag(project / "monday", localized_mission())
    map_page = open_map(ruler, "bay.adirf")
    ruler.page.get_by_label("Path of").select_option("monday")
    note = ruler.page.get_by_text("The path is that of /amcl_pose, in the frame map.")
    expect(note).to_contain_text("Zones read /odom, whose positions may lie elsewhere.")
    ruler.button("Type a zone").click()
    expect(map_page.form.get_by_label("Position from")).to_have_value("/amcl_pose")
    ruler.button("Add the zone").click()
    ruler.page.get_by_role("group", name="Zone of Zone 1").wait_for()
    assert "CheckValue /amcl_pose pose_x > 0" in saved(ruler, rules)


def test_a_condition_on_y_alone_is_a_band_without_ends(ruler: RulerPage, rules: Path) -> None:
    rules.write_text(
        RULES.replace(
            "CheckValue /odom pose_x > 20", "(CheckValue /odom pose_y > 12 AND CheckValue /odom pose_y < 15)"
        )
    )
    map_page = open_map(ruler, "bay.adirf")
    for _ in range(4):
        ruler.page.get_by_role("region", name="Map").get_by_role("button", name="Zoom out").click()
    map_page.press((60, 13.5))
    expect(ruler.button("Hall")).to_have_attribute("aria-pressed", "true")
    assert map_page.sides() == ["", "", "12", "15"]


def test_a_new_zone_proposes_a_rate_that_is_not_the_default(ruler: RulerPage, rules: Path) -> None:
    for default, proposed in (("4", "10"), ("Full", "10"), ("25", "Full")):
        rules.write_text(RULES.replace("/odom 10 ", f"/odom {default} "))
        open_map(ruler, "bay.adirf")
        ruler.button("Type a zone").click()
        ruler.button("Add the zone").click()
        ruler.page.get_by_role("group", name="Zone of Zone 1").wait_for()
        assert f"SetFrequency /odom {proposed}\n    EndIf\nend" in saved(ruler, rules)


def is_picture_of(name: str, url: str) -> bool:
    return "/api/background/picture?" in url and f"name={name}." in url
