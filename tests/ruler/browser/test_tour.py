# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Who opens the page for the first time is offered a tour, once, and loses nothing by it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import Locator, expect

from axe import violations
from ruler.browser.ruler_page import RulerPage, served

if TYPE_CHECKING:
    from playwright.sync_api import Browser

TITLES = (
    "Rules are blocks",
    "The same as text",
    "What is wrong or doubtful",
    "Try before you trust",
    "Send or download",
)
OFFER = "A tour in five steps?"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project without a file."""
    (tmp_path / "project").mkdir()
    return tmp_path / "project"


@pytest.fixture
def ruler(browser: Browser, project: Path) -> Iterator[RulerPage]:
    """The home screen in a browser that never saw the page."""
    with served(project) as url, browser.new_context(viewport={"width": 1280, "height": 800}) as context:
        page = RulerPage(context.new_page(), url, is_new=True)
        page.home()
        yield page
        assert page.complaints == []


@pytest.mark.journey
def test_the_tour_is_walked_with_one_key_and_touches_no_file(ruler: RulerPage, project: Path) -> None:
    page = ruler.page
    expect(ruler.button("Take the tour")).to_be_focused()
    page.keyboard.press("Enter")
    for number, title in enumerate(TITLES, start=1):
        card = _card(ruler)
        expect(card.get_by_role("heading", name=title)).to_be_visible()
        expect(card).to_contain_text(f"Step {number} of 5")
        expect(card.get_by_role("button", name=re.compile("Next|Finish"))).to_be_focused()
        if number == 1:
            ruler.expect_lines('Rule "Loading Dock"')
            expect(page.get_by_role("tab", name="Findings (1)")).to_be_visible()
        page.keyboard.press("Enter")
    expect(ruler.button("New Rule File")).to_be_visible()
    expect(page.get_by_role("heading", name="ADIRF Ruler")).to_be_focused()
    page.reload()
    expect(ruler.button("New Rule File")).to_be_visible()
    expect(page.get_by_role("dialog", name=OFFER)).to_have_count(0)
    assert list(project.iterdir()) == []


def test_beside_rules_the_offer_gives_way_to_work_and_is_there_again_at_home(
    ruler: RulerPage, project: Path
) -> None:
    (project / "one.adirf").write_text("begin\n    SetFrequency /odom 10\nend\n")
    ruler.home()
    ruler.open("one.adirf")
    offer = ruler.page.get_by_role("dialog", name=OFFER)
    expect(offer).to_be_visible()
    ruler.button("New rule").click()
    expect(offer).to_have_count(0)
    ruler.home()
    expect(offer).to_be_visible()


@pytest.mark.parametrize("way", ["Escape", "No, thanks"])
def test_who_does_not_want_it_is_asked_never_again(ruler: RulerPage, way: str) -> None:
    offer = ruler.page.get_by_role("dialog", name=OFFER)
    expect(ruler.button("Take the tour")).to_be_focused()
    if way == "Escape":
        ruler.page.keyboard.press("Escape")
    else:
        offer.get_by_role("button", name=way).click()
    expect(offer).to_have_count(0)
    expect(ruler.page.get_by_role("heading", name="ADIRF Ruler")).to_be_focused()
    ruler.home()
    expect(offer).to_have_count(0)


@pytest.mark.parametrize("way", ["Escape", "Skip the tour"])
def test_it_is_skipped_at_any_step_and_can_be_taken_again(ruler: RulerPage, way: str) -> None:
    ruler.button("Take the tour").click()
    # The card moves once to what it points at.
    expect(ruler.page.locator(".tour-ring")).to_be_visible()
    _card(ruler).get_by_role("button", name="Next").click()
    expect(_card(ruler).get_by_role("heading", name=TITLES[1])).to_be_visible()
    if way == "Escape":
        ruler.page.keyboard.press("Escape")
    else:
        ruler.button(way).click()
    expect(_card(ruler)).to_have_count(0)
    ruler.button("Documentation").click()
    ruler.page.get_by_role("link", name="Take the tour").click()
    expect(_card(ruler).get_by_role("heading", name=TITLES[0])).to_be_visible()
    _card(ruler).get_by_role("button", name="Next").click()
    _card(ruler).get_by_role("button", name="Back").click()
    expect(_card(ruler).get_by_role("heading", name=TITLES[0])).to_be_visible()


def test_the_example_can_be_played_with_but_is_neither_saved_nor_kept(
    ruler: RulerPage, project: Path
) -> None:
    ruler.button("Take the tour").click()
    ruler.change("Edit value: 11", "12")
    ruler.expect_lines("CheckValue /odom pose_x > 12")
    ruler.tool("Save").click()
    expect(ruler.page.get_by_text("The example is not saved")).to_be_visible()
    ruler.button("Skip the tour").click()
    assert list(project.iterdir()) == []
    expect(ruler.page.get_by_text("not saved")).to_have_count(0)


def test_it_leads_back_to_the_rules_that_it_was_called_from(ruler: RulerPage, project: Path) -> None:
    (project / "mine.adirf").write_text("begin\n    SetFrequency /odom 5\nend\n")
    ruler.page.goto(f"{ruler.url}#/rules/mine.adirf")
    ruler.page.reload()
    expect(ruler.page.get_by_role("dialog", name=OFFER)).to_be_visible()
    ruler.expect_lines("SetFrequency /odom 5")
    ruler.button("Take the tour").click()
    ruler.expect_lines("Loading Dock")
    ruler.button("Skip the tour").click()
    expect(ruler.page.get_by_role("heading", name="mine.adirf", level=1)).to_be_visible()
    ruler.expect_lines("SetFrequency /odom 5")
    assert (project / "mine.adirf").read_text() == "begin\n    SetFrequency /odom 5\nend\n"


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (820, 1180), (390, 844)])
def test_each_step_points_at_a_part_that_is_to_be_seen(ruler: RulerPage, width: int, height: int) -> None:
    ruler.page.set_viewport_size({"width": width, "height": height})
    _expect_no_obstacle(ruler)
    ruler.button("Take the tour").click()
    ruler.expect_lines("Loading Dock")
    for number, title in enumerate(TITLES, start=1):
        expect(_card(ruler).get_by_role("heading", name=title)).to_be_visible()
        _await_ring_beside_card(ruler)
        if number == 1:
            _expect_no_obstacle(ruler)
        assert ruler.page.evaluate("document.documentElement.scrollWidth") <= width
        _card(ruler).get_by_role("button", name=re.compile("Next|Finish")).click()


def _expect_no_obstacle(ruler: RulerPage) -> None:
    """Nothing that axe-core complains of, in light and dark."""
    ruler.page.emulate_media(color_scheme="dark")
    assert violations(ruler.page) == []
    ruler.page.emulate_media(color_scheme="light")
    assert violations(ruler.page) == []


def _card(ruler: RulerPage) -> Locator:
    return ruler.page.get_by_role("dialog", name="Tour", exact=True)


def _await_ring_beside_card(ruler: RulerPage) -> None:
    """Wait until the card is whole in the window, and some of what it points at is not below it."""
    ruler.page.wait_for_function(
        """() => {
            const [ring, card] = [".tour-ring", ".tour-card"].map((each) => {
                return document.querySelector(each)?.getBoundingClientRect();
            });
            if (!ring || !card) return false;
            const isWhole = card.top >= 0 && card.bottom <= innerHeight
                && card.left >= 0 && card.right <= innerWidth;
            const isSeen = ring.top < card.top - 20 || ring.bottom > card.bottom + 20
                || ring.left < card.left - 20 || ring.right > card.right + 20;
            return isWhole && isSeen && ring.height > 20;
        }"""
    )
