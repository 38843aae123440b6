# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""On a telephone a swipe scrolls, and changes nothing that it begins on."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import Locator, expect

from ruler.browser.ruler_page import AFTER_TWO_FRAMES, GRIP_PX, RulerPage

if TYPE_CHECKING:
    from playwright.sync_api import Browser, ViewportSize

STEPS = 10
TELEPHONE: ViewportSize = {"width": 390, "height": 844}
RULES = "begin\n    SetFrequency /odom 10\n    SetFrequency /imu 5\n    SetFrequency /scan 1\nend\n"
TABLE = '[topics."/odom"]\nmessage_kb = 0.7\ntiers_hz = [5, 10, 15, 20, 25, 30]\n'


@pytest.fixture
def phone(browser: Browser, ruler: RulerPage, project: Path) -> Iterator[RulerPage]:
    """The page on a telephone, in a project with few rates."""
    (project / "plain.adirf").write_text(RULES)
    (project / "wlan.toml").write_text(TABLE)
    with browser.new_context(viewport=TELEPHONE, has_touch=True, is_mobile=True) as context:
        page = RulerPage(context.new_page(), ruler.url)
        page.home()
        yield page
        assert page.complaints == []


@pytest.mark.journey
def test_a_swipe_over_blocks_scrolls_them_and_leaves_the_rules_alone(phone: RulerPage) -> None:
    phone.open("plain.adirf")
    phone.expect_lines("SetFrequency /scan 1")
    imu = _block(phone, "/imu")
    before = _top(imu)
    for _ in range(2):
        _swipe(phone, imu, -60)
    expect(phone.tool("Undo")).to_be_disabled()
    phone.expect_lines("/odom 10", "/imu 5", "/scan 1")
    assert _top(imu) < before


def test_a_finger_drags_the_block_that_it_tapped_before(phone: RulerPage) -> None:
    phone.open("plain.adirf")
    phone.expect_lines("SetFrequency /scan 1")
    scan = _block(phone, "/scan")
    scan.tap(position={"x": GRIP_PX, "y": GRIP_PX})
    _swipe(phone, scan, _top(_block(phone, "/odom")) - _top(scan))
    phone.expect_lines("/scan 1", "/odom 10", "/imu 5")


def test_a_swipe_over_the_level_lines_scrolls_the_page(phone: RulerPage) -> None:
    phone.page.get_by_role("link", name="wlan.toml", exact=True).click()
    line = phone.page.get_by_role("slider", name="Acceptable level of /odom (Hz)", exact=True)
    # It comes last, and moves the lines down.
    phone.page.get_by_label("Levels of").wait_for()
    line.scroll_into_view_if_needed()
    # To the middle: there is room on both sides to scroll to.
    phone.page.evaluate("document.querySelector('#app').scrollBy(0, -60)")
    before = _top(line)
    _swipe(phone, line, -40, right_px=3)
    expect(line).to_have_attribute("aria-valuenow", "15")
    expect(phone.tool("Undo")).to_be_disabled()
    assert _top(line) < before
    _swipe(phone, line, 0, right_px=30)
    expect(phone.tool("Undo")).to_be_enabled()


def _block(phone: RulerPage, topic: str) -> Locator:
    return phone.blocks.locator(".blocklyBlock").filter(has_text=topic).last


def _top(shown: Locator) -> float:
    box = shown.bounding_box()
    assert box is not None
    return box["y"]


def _swipe(phone: RulerPage, begin: Locator, below_px: float, right_px: float = 0) -> None:
    """Put a finger on the edge of ``begin``, and move it."""
    box = begin.bounding_box()
    assert box is not None
    x, y = box["x"] + GRIP_PX, box["y"] + GRIP_PX
    session = phone.page.context.new_cdp_session(phone.page)

    def touch(kind: str, points: list[dict[str, float]]) -> None:
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        phone.page.evaluate(AFTER_TWO_FRAMES)

    touch("touchStart", [{"x": x, "y": y}])
    for step in range(1, STEPS + 1):
        touch("touchMove", [{"x": x + right_px * step / STEPS, "y": y + below_px * step / STEPS}])
    touch("touchEnd", [])
