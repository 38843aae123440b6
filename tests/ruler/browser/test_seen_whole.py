# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What one needs is seen whole: names, numbers and buttons are not cut, covered or pale on any screen."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Locator, ViewportSize, expect

from bags.bag_factory import small_mission, write_bag
from link.zenoh.ends import until
from ruler.browser.ruler_page import RulerPage
from ruler.browser.screens import FOLDED

LAPTOP: ViewportSize = {"width": 1280, "height": 800}
TELEPHONE: ViewportSize = {"width": 390, "height": 844}
LYING: ViewportSize = {"width": 1180, "height": 820}
STANDING: ViewportSize = {"width": 820, "height": 1180}
LINES_OF_PARTS = """of => [...of.childNodes].filter(part => part.nodeType === Node.TEXT_NODE).map(part => {
    const range = document.createRange();
    range.selectNode(part);
    return range.getClientRects().length;
})"""
CONTRAST = """field => {
    const parts = colour => colour.match(/[\\d.]+/g).slice(0, 3).map(Number);
    const light = colour => {
        const [r, g, b] = parts(colour).map(each => each / 255)
            .map(each => each <= 0.04045 ? each / 12.92 : ((each + 0.055) / 1.055) ** 2.4);
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const [words, behind] = [getComputedStyle(field, "::placeholder"), getComputedStyle(field)];
    const [high, low] = [words.color, behind.backgroundColor].map(light).sort((a, b) => b - a);
    return (high + 0.05) / (low + 0.05);
}"""
LARGER_TEXT = """() => {
    const texts = [...document.querySelectorAll("h1, button, input, select, a, p, .cm-line")];
    const sizes = () => texts.filter(each => each.closest(".injectionDiv") === null)
        .map(each => Number.parseFloat(getComputedStyle(each).fontSize));
    const before = sizes();
    document.documentElement.style.fontSize = "150%";
    return sizes().map((px, at) => px / before[at]);
}"""
"""The largest text that a browser offers by name; by how much each text grows."""
READABLE = 4.5
"""The contrast that WCAG asks of text."""
CLASH = """\
begin
    Rule "Hall" If CheckValue /odom pose_x > 4 Then SetFrequency /odom 7
    Rule "Bay" If CheckValue /odom pose_x > 1 Then SetFrequency /odom 4
end
"""

NOTE_AND_WARNING = """\
begin
    SetFrequency /odom 10
    Rule "Same" If CheckValue /odom pose_x > 0 Then SetFrequency /odom 10
    Rule "Never" If (CheckValue /odom pose_x > 0 AND CheckValue /odom pose_x < 0) Then SetFrequency /odom 4
end
"""

DECIDES = """\
begin
    SetFrequency /odom 5
    Rule "Always"
    If (CheckValue /odom pose_y > -1)
    Then
        SetFrequency /odom 2
        SetFrequency /scan 1
        SetFrequency /image 1
        SetFrequency /gripper 1
        SetFrequency /map_name 1
    EndIf
end
"""


def test_a_name_goes_on_in_the_next_line_between_its_words(ruler: RulerPage) -> None:
    ruler.page.set_viewport_size(TELEPHONE)
    for name in ("warehouse_predicted.adirf", "warehouse_within.adirf"):
        link = ruler.page.get_by_role("link", name=name, exact=True)
        assert len(link.evaluate(LINES_OF_PARTS)) == 3
        assert set(link.evaluate(LINES_OF_PARTS)) == {1}
    ruler.open("warehouse.adirf")
    assert ruler.page.get_by_role("heading", level=1).evaluate(LINES_OF_PARTS) == [1, 1]


@pytest.mark.parametrize(
    "page", ["", "rules/warehouse.adirf", "topics/quality/radio.toml", "incidents/", "help/"]
)
def test_who_wants_larger_text_gets_all_of_it_larger_and_no_page_wider(ruler: RulerPage, page: str) -> None:
    ruler.page.set_viewport_size(TELEPHONE)
    ruler.page.goto(f"{ruler.url}#/{page}")
    ruler.page.get_by_role("heading", level=1).wait_for()
    grown = ruler.page.evaluate(LARGER_TEXT)
    assert grown == pytest.approx([1.5] * len(grown))
    until(lambda: ruler.page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0)


def test_only_what_one_begins_with_stands_out(ruler: RulerPage, project: Path) -> None:
    ruler.page.mouse.move(0, 0)
    assert len(_card_colours(ruler)) == 1
    for path in project.rglob("*.*"):
        path.unlink(missing_ok=True)
    ruler.page.reload()
    start = ruler.page.get_by_role("navigation", name="Start")
    expect(start.get_by_role("button", name="New Rule File")).to_be_visible()
    assert len(_card_colours(ruler)) == 2


def _card_colours(ruler: RulerPage) -> set[str]:
    cards = ruler.page.get_by_role("navigation", name="Start").locator(".card")
    return {card.evaluate("card => getComputedStyle(card).borderTopColor") for card in cards.all()}


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_words_of_an_empty_field_can_be_read(ruler: RulerPage, scheme: str) -> None:
    ruler.page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
    field = ruler.page.get_by_role("searchbox", name="Find a file")
    assert field.evaluate(CONTRAST) >= READABLE


def test_findings_begin_below_each_other_and_have_more_room_than_their_buttons(ruler: RulerPage) -> None:
    ruler.page.set_viewport_size(LAPTOP)
    ruler.open("warehouse.adirf")
    rows = ruler.page.get_by_role("list", name="Findings").get_by_role("listitem")
    expect(rows).to_have_count(3)
    messages = [_box(row.locator(".message")) for row in rows.all()]
    assert len({message["x"] for message in messages}) == 1
    fix = rows.last.get_by_role("button", name=re.compile("^pace .camera.camera_info with"))
    assert messages[-1]["width"] > _box(fix)["width"]
    assert not _is_cut(fix)


def test_a_long_name_of_a_rule_leaves_its_finding_readable(ruler: RulerPage, project: Path) -> None:
    (project / "clash.adirf").write_text(CLASH.replace("Hall", "Hall of the second floor, " * 12))
    ruler.home()
    ruler.open("clash.adirf")
    rows = ruler.page.get_by_role("list", name="Findings").get_by_role("listitem")
    clash = rows.filter(has=ruler.page.get_by_role("button", name="Show Rule Bay", exact=True)).first
    room, message = _box(ruler.page.get_by_role("region", name="Results")), _box(clash.locator(".message"))
    assert message["width"] > room["width"] / 3
    for button in clash.get_by_role("button").all():
        assert _box(button)["x"] + _box(button)["width"] <= room["width"]


def test_a_warning_begins_where_a_note_does(ruler: RulerPage, project: Path) -> None:
    (project / "mixed.adirf").write_text(NOTE_AND_WARNING)
    ruler.home()
    ruler.open("mixed.adirf")
    rows = ruler.page.get_by_role("list", name="Findings").get_by_role("listitem")
    expect(rows.filter(has_text="Note")).not_to_have_count(0)
    expect(rows.filter(has_text="Warning")).not_to_have_count(0)
    assert len({_box(row.locator(".message"))["x"] for row in rows.all()}) == 1


def test_nothing_covers_a_field_of_the_topic_parameters_on_a_laptop(ruler: RulerPage) -> None:
    ruler.page.set_viewport_size(LAPTOP)
    ruler.page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    field = ruler.page.get_by_role("textbox", name="Source (Hz) of /odom")
    remove = ruler.button("Remove /odom")
    assert _box(field)["x"] + _box(field)["width"] < _box(remove)["x"]
    assert not _is_cut(ruler.page.locator(".table-scroll").first)


def test_the_name_of_a_topic_is_not_cut_beside_its_load(ruler: RulerPage) -> None:
    ruler.page.set_viewport_size(LAPTOP)
    ruler.open("quality/inspection.adirf")
    ruler.tool("Optimize and Download").click()
    ruler.button("Download rates").wait_for()
    names = ruler.page.get_by_role("rowheader", name="/camera/image_raw/compressed")
    expect(names.first).to_be_visible()
    assert [_is_cut(name) for name in names.all()] == [False] * names.count()


def test_the_map_says_what_is_below_the_zones_and_why_two_clash(ruler: RulerPage, project: Path) -> None:
    (project / "clash.adirf").write_text(CLASH)
    ruler.home()
    ruler.open("clash.adirf")
    ruler.page.get_by_role("tab", name="Map").click()
    background = ruler.page.get_by_role("combobox", name="Background")
    expect(background.get_by_role("option", name="Map: warehouse_map.yaml")).to_have_count(1)
    wanted = background.evaluate("""field => {
        const copy = field.cloneNode(true);
        copy.style.cssText = "position: fixed; max-width: none";
        field.parentNode.append(copy);
        const {width} = copy.getBoundingClientRect();
        copy.remove();
        return width;
    }""")
    assert _box(background)["width"] >= wanted - 1
    panel = ruler.page.get_by_role("region", name="Map", exact=True)
    expect(panel.get_by_text("The higher rate wins; give one block a higher Priority")).to_be_visible()


def test_a_tablet_that_is_turned_keeps_the_blocks_in_sight(ruler: RulerPage, project: Path) -> None:
    (project / "long.adirf").write_text(f"begin\n    SetFrequency /odom 10\n{FOLDED}end\n")
    ruler.page.set_viewport_size(LYING)
    ruler.home()
    ruler.open("long.adirf")
    outline = ruler.page.get_by_role("listbox", name="Rules in the order of the text")
    expect(outline).to_be_visible()
    kinds = ruler.blocks.locator(".blocklyToolbox")
    ruler.field("Edit rate: 10")
    assert _box(kinds)["width"] < _box(kinds)["height"]

    ruler.page.set_viewport_size(STANDING)
    expect(outline).to_be_hidden()
    expect(kinds).to_have_attribute("layout", "h")
    assert _box(kinds)["width"] > _box(kinds)["height"]
    ruler.change("Edit rate: 10", "20")
    expect(ruler.text).to_contain_text("SetFrequency /odom 20")

    ruler.page.set_viewport_size(LYING)
    expect(outline).to_be_visible()
    expect(kinds).to_have_attribute("layout", "v")
    ruler.change("Edit rate: 20", "30")
    expect(ruler.text).to_contain_text("SetFrequency /odom 30")


def test_the_slider_of_a_try_has_the_width_of_a_telephone(ruler: RulerPage, project: Path) -> None:
    write_bag(project / "monday", small_mission(2))
    (project / "far.adirf").write_text(DECIDES)
    ruler.page.set_viewport_size(TELEPHONE)
    ruler.home()
    ruler.open("far.adirf")
    ruler.tool("Try on a recording").click()
    ruler.button("Run the rules on it").click()
    slider = ruler.page.get_by_role("slider", name="Time in the recording (s)")
    assert _box(slider)["width"] > 0.9 * TELEPHONE["width"]
    slider.press("End")
    decides = ruler.page.get_by_text(re.compile("^decides .odom"))
    for screen in (TELEPHONE, LAPTOP):
        ruler.page.set_viewport_size(screen)
        ruler.page.wait_for_function(f"() => innerWidth === {screen['width']}")
        expect(decides).to_have_text("decides /odom, /scan, /image, /gripper, /map_name")
        assert not _is_cut(decides)


def _box(what: Locator) -> dict[str, float]:
    box = what.bounding_box()
    assert box is not None
    return {"x": box["x"], "y": box["y"], "width": box["width"], "height": box["height"]}


def _is_cut(what: Locator) -> bool:
    return bool(what.evaluate("it => it.scrollWidth > it.clientWidth"))
