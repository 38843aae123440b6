# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Room for what somebody works on: panes, the map and a try as large as wanted; one button to ship."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from playwright.sync_api import Locator, Route, expect

from axe import violations
from bags.bag_factory import small_mission, write_bag
from link.zenoh.ends import until
from ruler.browser.ruler_page import RulerPage

WIDTH_PX = 1440


def test_panes_are_as_large_as_somebody_left_them(ruler: RulerPage) -> None:
    ruler.open("zone.adirf")
    line = ruler.page.get_by_role("separator", name="Width of the blocks")
    expect(line).to_have_attribute("aria-valuenow", "58")
    line.focus()
    line.press("ArrowLeft")
    line.press("PageDown")
    expect(line).to_have_attribute("aria-valuenow", "46")
    low = ruler.page.get_by_role("separator", name="Height of the results")
    low.press("End")
    expect(low).to_have_attribute("aria-valuenow", "85")
    low.press("ArrowDown")
    ruler.page.reload()
    expect(line).to_have_attribute("aria-valuenow", "46")
    expect(low).to_have_attribute("aria-valuenow", "83")
    until(lambda: abs(_width_px(ruler.blocks) / WIDTH_PX - 0.46) < 0.005)


def test_the_line_between_panes_is_pulled(ruler: RulerPage) -> None:
    ruler.open("zone.adirf")
    line = ruler.page.get_by_role("separator", name="Width of the blocks")
    line.hover()
    ruler.page.mouse.down()
    ruler.page.mouse.move(WIDTH_PX / 2, 400, steps=4)
    ruler.page.mouse.up()
    expect(line).to_have_attribute("aria-valuenow", "50")
    ruler.page.mouse.move(WIDTH_PX / 4, 400)
    expect(line).to_have_attribute("aria-valuenow", "50")


def test_the_map_has_the_whole_page(ruler: RulerPage) -> None:
    ruler.open("zone.adirf")
    ruler.page.get_by_role("tab", name="Map").click()
    ruler.page.get_by_role("button", name="Full screen: map").click()
    expect(ruler.blocks).to_be_hidden()
    map_pane = ruler.page.get_by_role("application", name="Zones on the map")
    until(lambda: _width_px(map_pane) > WIDTH_PX - 20)
    ruler.page.get_by_role("button", name="Leave full screen: map").click()
    expect(ruler.blocks).to_be_visible()
    ruler.page.get_by_role("button", name="Full screen: map").click()
    ruler.page.get_by_role("tab", name="Text").click()
    expect(ruler.blocks).to_be_visible()


def test_a_try_has_the_whole_page_and_plays(ruler: RulerPage, project: Path) -> None:
    write_bag(project / "monday", small_mission(8))
    ruler.home()
    ruler.open("zone.adirf")
    ruler.tool("Try on a recording").click()
    ruler.button("Run the rules on it").click()
    ruler.page.get_by_role("button", name="Full screen: results").click()
    expect(ruler.blocks).to_be_hidden()
    ruler.page.get_by_label("Speed").select_option("10×")
    ruler.button("Play").click()
    slider = ruler.page.get_by_role("slider", name="Time in the recording (s)")
    # It ends by itself, and the button is there for the next time.
    expect(slider).to_have_attribute("aria-valuetext", re.compile(r"^8\.0 s|^7\.9\d* s|^7\.96 s|^8 s"))
    expect(ruler.button("Play")).to_be_visible()
    # Slowly, so that it does not end before it is paused.
    ruler.page.get_by_label("Speed").select_option("0.5×")
    ruler.button("Play").click()
    ruler.button("Pause").click()
    expect(ruler.button("Play")).to_be_visible()
    assert violations(ruler.page) == []
    ruler.page.keyboard.press("Escape")
    ruler.page.get_by_role("button", name="Full screen: results").wait_for()
    expect(ruler.blocks).to_be_visible()


def test_optimize_and_download_downloads(ruler: RulerPage) -> None:
    ruler.open("quality/inspection.adirf")
    with ruler.page.expect_download() as download:
        ruler.tool("Optimize and Download").click()
    assert download.value.suggested_filename == "inspection-rates.adirf"
    text = download.value.path().read_text()
    assert "SetFrequency /odom" in text
    assert ", profile radio.toml (sha256 " in text.splitlines()[0]


def test_a_download_waits_for_the_profile_that_was_just_chosen(ruler: RulerPage, project: Path) -> None:
    shutil.copy(project / "quality" / "radio.toml", project / "quality" / "other.toml")
    ruler.home()
    ruler.open("quality/inspection.adirf")
    held: list[Route] = []

    def hold(route: Route) -> None:
        held.append(route)

    ruler.page.route(re.compile("other.toml"), hold)
    with ruler.page.expect_request(re.compile("other.toml")):
        ruler.page.get_by_label("Topic parameters").select_option("quality/other.toml")
    with ruler.page.expect_download() as download:
        ruler.tool("Optimize and Download").click()
        expect(ruler.page.get_by_text(re.compile("^Everything fits into"))).to_be_visible()
        held.pop().continue_()
    assert ", profile other.toml (sha256 " in download.value.path().read_text().splitlines()[0]


def test_what_cannot_be_downloaded_is_said(ruler: RulerPage) -> None:
    ruler.open("quality/inspection.adirf")
    ruler.page.get_by_label("Topic parameters").select_option("")
    ruler.tool("Optimize and Download").click()
    expect(
        ruler.page.get_by_text("Nothing was downloaded: the panel below says what is missing")
    ).to_be_visible()


def test_rules_in_plain_numbers_are_downloaded_without_a_profile(ruler: RulerPage, project: Path) -> None:
    text = "begin\n    SetFrequency /odom 10\nend\n"
    (project / "plain.adirf").write_text(text)
    ruler.home()
    ruler.open("plain.adirf")
    ruler.page.get_by_label("Topic parameters").select_option("")
    with ruler.page.expect_download() as download:
        ruler.tool("Optimize and Download").click()
        expect(ruler.page.get_by_text("Downloaded the rules as they are")).to_be_visible()
    assert download.value.suggested_filename == "plain-rates.adirf"
    assert download.value.path().read_text() == text


def test_one_main_button_says_what_is_next(ruler: RulerPage) -> None:
    ruler.open("zone.adirf")
    main = ruler.page.get_by_role("toolbar", name="Tools").locator("button.primary")
    expect(main).to_have_accessible_name("Optimize and Download")
    ruler.button("New rate").click()
    expect(main).to_have_accessible_name("Save")
    ruler.save()
    expect(main).to_have_accessible_name("Optimize and Download")


def _width_px(of: Locator) -> float:
    box = of.bounding_box()
    assert box is not None
    return box["width"]
