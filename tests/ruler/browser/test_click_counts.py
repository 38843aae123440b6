# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How much somebody has to do from the first screen to rules that are sent, or to a file with everything."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import expect

from bags.bag_factory import small_mission, write_bag
from ruler.browser.counted_page import CountedPage
from ruler.browser.map_page import MapPage
from ruler.browser.ruler_page import RulerPage

MOST_CLICKS_TO_SENT_RULES = 13
MOST_CLICKS = 15
MOST_CLICKS_OF_A_ZONE = 6
MOST_KEYS = 60
MOST_KEYS_WITHOUT_A_MOUSE = 137
FIVE_DEFAULTS = re.compile(r"begin\n(    SetFrequency \S+ [1-5]\n){5}\n")
EVERYTHING = (
    FIVE_DEFAULTS,
    re.compile(r'Rule "Zone 1"\n    If \(\n( +(AND )?\(?CheckValue /odom pose_[xy] [<>] -?[\d.]+.*\n){4}'),
    re.compile(r"CheckValue /odom pose_y < \S+\n\s*\) For 3 s"),
    re.compile(r"KeepWithin /odom position 0\.1\n"),
    re.compile(r'Record "bay" /odom Before \d+ s After \d+ s\n'),
    re.compile(r'Rule "Low battery"'),
)


@pytest.fixture
def project(project: Path) -> Path:
    """The examples, and a recording."""
    write_bag(project / "monday", small_mission(8))
    return project


def test_from_a_recording_to_rules_with_a_zone_that_are_downloaded(ruler: RulerPage) -> None:
    me = CountedPage(ruler.page)
    me.click("link", "Recordings")
    me.click("button", "New rules from monday")
    me.sees("5 topics, 7.96 s.")
    me.press("Enter")
    ruler.blocks.wait_for()
    _draw_zone(ruler, me)
    me.click("button", "Edit rate…")
    me.type("5")
    me.press("Enter")
    ruler.field("Edit rate: 5").wait_for()
    me.click("button", "Optimize and Download")
    me.click("link", "Enter it in monday.toml")
    me.click("textbox", "Budget: total bandwidth (KB/s)")
    me.type("15000")
    # It was recorded once only, which is no rate.
    me.click("textbox", "Source (Hz) of /map_name")
    me.type("1")
    me.press("Control+s")
    me.sees("Saved monday.toml")
    me.click("link", "Back to monday.adirf")
    expect(ruler.page.get_by_label("Topic parameters")).to_have_value("monday.toml")
    with ruler.page.expect_download() as waiting:
        me.click("button", "Optimize and Download")
    text = waiting.value.path().read_text()
    for line in (
        "SetFrequency /odom Full",
        'Rule "Zone 1"',
        "SetFrequency /odom 5",
        "profile monday.toml ",
    ):
        assert line in text
    assert me.clicks <= MOST_CLICKS_TO_SENT_RULES, me.done
    # The rates could not be computed at first, which the page may have asked for twice.
    ruler.forgive("422")


def test_a_zone_of_the_map_is_a_rule_in_few_clicks(ruler: RulerPage, project: Path) -> None:
    me = CountedPage(ruler.page)
    me.click("button", "New Rule File")
    me.type("shelf")
    me.press("Enter")
    _draw_zone(ruler, me)
    me.click("button", "Edit rate…")
    me.type("4")
    me.press("Enter")
    ruler.field("Edit rate: 4").wait_for()
    ruler.field("zone: Zone 1").wait_for()
    me.press("Control+s")
    me.sees("Saved shelf.adirf")
    text = (project / "shelf.adirf").read_text()
    assert EVERYTHING[1].search(text), text
    assert "SetFrequency /odom 4\n" in text
    assert me.clicks <= MOST_CLICKS_OF_A_ZONE, me.done


def test_a_file_with_everything_takes_few_clicks_and_keys(ruler: RulerPage, project: Path) -> None:
    me = CountedPage(ruler.page)
    me.click("button", "New Rule File")
    me.type("shelf")
    me.press("Enter")
    me.click("button", "New rate")
    _type_defaults(me)
    _draw_zone(ruler, me)
    me.click("button", "Add time")
    _type_time(ruler, me)
    me.click("button", "Add bound")
    _type_bound(me)
    me.click("button", "Add recording")
    _type_recording(me)
    me.click("treeitem", "Recipes")
    me.click("option", "rule, Low battery…")
    _save(ruler, me, project)
    assert me.clicks <= MOST_CLICKS, me.done
    assert me.keys <= MOST_KEYS, me.done


def test_a_file_with_everything_is_made_without_a_mouse(ruler: RulerPage, project: Path) -> None:
    me = CountedPage(ruler.page)
    me.walk("Tab", "New Rule File")
    me.press("Enter")
    me.type("shelf")
    me.press("Enter")
    # What cannot be pressed yet is none of the keys' stops.
    expect(ruler.button("New rate")).to_be_enabled()
    me.walk("Tab", "New rate")
    me.press("Enter")
    _type_defaults(me)
    _type_zone(ruler, me)
    me.press("/")
    me.type("zone")
    ruler.page.get_by_role("option", name="Zone 1").first.wait_for()
    me.press("Enter")
    me.await_focus("Begin stack, rule, Zone 1")
    me.walk("ArrowDown", " inside, Zone 1")
    me.walk("ArrowRight", "Add time")
    me.press("Enter")
    _type_time(ruler, me)
    me.walk("ArrowDown", "Add rate")
    me.walk("ArrowRight", "Add bound")
    me.press("Enter")
    _type_bound(me)
    me.walk("ArrowUp", "Add rate")
    me.walk("ArrowRight", "Add recording")
    me.press("Enter")
    _type_recording(me)
    me.walk("ArrowLeft", "record, bay")
    me.press("t")
    me.walk("ArrowUp", "Recipes")
    ruler.page.get_by_role("option", name="rule, Low battery").wait_for(state="attached")
    me.press("ArrowRight")
    me.walk("ArrowDown", "rule, Low battery")
    # One takes it, the other puts it down.
    me.press("Enter", 2)
    _save(ruler, me, project)
    assert me.clicks == 0
    assert me.keys <= MOST_KEYS_WITHOUT_A_MOUSE, me.done


def _type_zone(ruler: RulerPage, me: CountedPage) -> None:
    me.walk("Shift+Tab", "Map")
    me.press("Enter")
    me.walk("Tab", "Draw a rectangle")
    me.press("Enter")
    me.walk_to_field("x from (m)")
    for side_m in ("2", "9", "1", "3"):
        me.type(side_m)
        me.press("Tab")
    expect(ruler.button("Add the zone")).to_be_enabled()
    me.walk("Tab", "Add the zone")
    me.press("Enter")
    ruler.page.get_by_role("group", name="Zone of Zone 1").wait_for()


def _draw_zone(ruler: RulerPage, me: CountedPage) -> None:
    """Draw a rectangle on the map, and add it as a rule."""
    me.click("button", "Map")
    me.click("button", "Draw a rectangle")
    MapPage(ruler).drag_across()
    me.count_drag("a rectangle")
    me.click("button", "Add the zone")
    ruler.page.get_by_role("group", name="Zone of Zone 1").wait_for()
    ruler.field("Edit name of the rule: Zone 1")


def _type_defaults(me: CountedPage) -> None:
    """Rates for five topics, the first of which was asked for."""
    for rate_hz in range(1, 6):
        if rate_hz > 1:
            me.press("Shift+Enter")
        me.await_focus("topic to send")
        me.press("Tab")
        me.await_focus("rate")
        me.type(str(rate_hz))
    me.press("Enter")


def _type_time(ruler: RulerPage, me: CountedPage) -> None:
    ruler.page.get_by_role("menuitem", name="for so long…").wait_for()
    me.press("Enter")
    me.await_focus("duration")
    me.type("3")
    me.press("Enter")


def _type_bound(me: CountedPage) -> None:
    me.await_focus("topic to bound")
    me.walk("Tab", "bound", most=4)
    me.type("0.1")
    me.press("Enter")


def _type_recording(me: CountedPage) -> None:
    me.await_focus("name of the recording")
    me.type("bay")
    me.press("Tab")
    me.type("odom")
    me.press("Enter")


def _save(ruler: RulerPage, me: CountedPage, project: Path) -> None:
    ruler.field("Edit name of the rule: Low battery").wait_for()
    expect(ruler.tool("Save")).to_be_enabled()
    me.press("Control+s")
    me.sees("Saved shelf.adirf")
    text = (project / "shelf.adirf").read_text()
    for part in EVERYTHING:
        assert part.search(text), (part.pattern, text)
