# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Room for what somebody works on: panes, the map and a try as large as wanted; one button to ship."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from axe import violations
from bags.bag_factory import small_mission, write_bag
from link.zenoh.ends import until
from ruler.browser.ruler_page import RulerPage

WIDTH_PX = 1440


def test_the_map_has_the_whole_page(ruler: RulerPage) -> None:
    ruler.open("zone.adirf")
    ruler.open_pane("Map")
    ruler.page.get_by_role("button", name="Full screen: map").click()
    expect(ruler.blocks).to_be_hidden()
    map_pane = ruler.page.get_by_role("application", name="Zones on the map")
    until(lambda: _width_px(map_pane) > WIDTH_PX - 20)
    ruler.page.get_by_role("button", name="Leave full screen: map").click()
    expect(ruler.blocks).to_be_visible()
    ruler.open_pane("Text")
    expect(ruler.blocks).to_be_visible()


def test_a_try_has_the_whole_page_and_plays(ruler: RulerPage, project: Path) -> None:
    write_bag(project / "monday", small_mission(8))
    ruler.home()
    ruler.open("zone.adirf")
    ruler.open_pane("Try on a recording")
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


@pytest.mark.journey
def test_optimize_and_download_downloads(ruler: RulerPage) -> None:
    ruler.open("quality/inspection.adirf")
    with ruler.page.expect_download() as download:
        ruler.tool("Optimize and Download").click()
    assert download.value.suggested_filename == "inspection-rates.adirf"
    text = download.value.path().read_text()
    assert "SetFrequency /odom" in text
    assert ", profile radio.toml (sha256 " in text.splitlines()[0]


def _width_px(of: Locator) -> float:
    box = of.bounding_box()
    assert box is not None
    return box["width"]
