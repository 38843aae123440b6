# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A tablet shows everything, a telephone what somebody looks at, tries and sends; none scrolls sideways."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import expect

from adapters.rosbag.bag_factory import small_mission, write_bag
from web.browser.ruler_page import EXAMPLES, RulerPage, copied

WIDTHS_PX = (820, 390)
HEIGHT_PX = 844
WIDER = "document.documentElement.scrollWidth - innerWidth"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = copied(EXAMPLES, tmp_path / "project")
    write_bag(folder / "monday", small_mission(8))
    return folder


def _home(ruler: RulerPage) -> None:
    ruler.page.get_by_role("region", name="Rules").wait_for()


def _new_project(ruler: RulerPage) -> None:
    ruler.button("Create New Project").click()
    ruler.page.get_by_role("dialog").wait_for()


def _documentation(ruler: RulerPage) -> None:
    ruler.button("Documentation").click()
    ruler.page.get_by_role("heading", name="Properties and units").wait_for()


def _robots(ruler: RulerPage) -> None:
    ruler.button("Watch Robots").click()
    ruler.page.get_by_role("heading", name="Robots", exact=True).wait_for()


def _rules(ruler: RulerPage) -> None:
    ruler.open("warehouse.adirf")
    ruler.page.get_by_role("list", name="Findings").wait_for()


def _map(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.page.get_by_role("tab", name="Map").click()
    ruler.page.get_by_role("application", name="Zones on the map").wait_for()


def _versions(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.button("New rate").click()
    ruler.save()
    ruler.page.get_by_role("tab", name="Versions").click()
    ruler.page.get_by_role("listitem", name="Version of").last.get_by_role("button", name="Compare").click()
    ruler.page.get_by_role("figure", name="Open now").wait_for()


def _optimizer(ruler: RulerPage) -> None:
    ruler.open("quality/inspection.adirf")
    ruler.page.get_by_role("tab", name="Optimize").click()
    ruler.button("Download rates").wait_for()


def _trial(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.button("Try on a bag").click()
    ruler.button("Run the rules on it").click()
    ruler.page.get_by_role("region", name="Decisions").wait_for()


def _robot(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.page.get_by_role("tab", name="Robot").click()


def _parameters(ruler: RulerPage) -> None:
    ruler.page.get_by_role("link", name="quality/radio.toml", exact=True).click()
    ruler.page.get_by_role("heading", name="Quality levels of a topic").wait_for()


PAGES: tuple[Callable[[RulerPage], None], ...] = (
    _home,
    _new_project,
    _documentation,
    _robots,
    _rules,
    _map,
    _versions,
    _optimizer,
    _trial,
    _robot,
    _parameters,
)


@pytest.mark.parametrize("reach", PAGES, ids=lambda reach: reach.__name__.strip("_"))
def test_nothing_is_wider_than_the_screen(ruler: RulerPage, reach: Callable[[RulerPage], None]) -> None:
    reach(ruler)
    for width in WIDTHS_PX:
        ruler.page.set_viewport_size({"width": width, "height": HEIGHT_PX})
        ruler.page.wait_for_function("innerWidth === " + str(width))
        assert ruler.page.evaluate(WIDER) <= 0, f"{width} px"


def test_a_telephone_looks_tries_and_sends(ruler: RulerPage) -> None:
    ruler.page.set_viewport_size({"width": 390, "height": HEIGHT_PX})
    _trial(ruler)
    expect(ruler.page.get_by_text("% less sent")).to_be_in_viewport()
    ruler.page.get_by_role("button", name="Full screen: results").click()
    ruler.button("Next decision").click()
    expect(ruler.page.get_by_role("slider", name="Time in the recording (s)")).not_to_have_attribute(
        "aria-valuetext", re.compile(r"^0\.0 s")
    )
    ruler.page.get_by_role("button", name="Leave full screen: results").click()
    ruler.button("Send to robot").click()
    expect(ruler.page.get_by_role("tab", name="Robot")).to_have_attribute("aria-selected", "true")
    expect(ruler.page.get_by_role("tabpanel", name="robot")).to_be_in_viewport()
