# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How much somebody who knows only what is written on the page has to do for the rule of Figure 6.6."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import expect

from ruler.browser.counted_page import CountedPage
from ruler.browser.ruler_page import RulerPage
from ruler.browser.thesis import FIGURE_6_6, build_rule, build_rule_without_a_mouse, type_into

MOST_CLICKS = 12
MOST_KEYS = 60
MOST_CLICKS_OF_A_CLICKER = 18
MOST_KEYS_OF_A_CLICKER = 15
MOST_KEYS_WITHOUT_A_MOUSE = 90
"""The rule itself is some thirty words and numbers; the rest is the way to the page's buttons and back."""


@pytest.mark.journey
def test_the_rule_of_the_thesis_takes_few_clicks_and_keys(ruler: RulerPage, project: Path) -> None:
    somebody = CountedPage(ruler.page)
    somebody.click("button", "New Rule File")
    _name(somebody, "shelf")
    somebody.press("Enter")
    build_rule(somebody)
    somebody.click("button", "Save")
    somebody.sees("Saved shelf.adirf")
    assert (project / "shelf.adirf").read_text() == FIGURE_6_6
    assert somebody.clicks <= MOST_CLICKS, somebody.done
    assert somebody.keys <= MOST_KEYS, somebody.done


def test_the_rule_takes_few_clicks_for_who_clicks_each_field(ruler: RulerPage, project: Path) -> None:
    somebody = CountedPage(ruler.page)
    somebody.click("button", "New Rule File")
    _name(somebody, "shelf")
    somebody.click("button", "Create")
    somebody.click("button", "New rule")
    somebody.await_focus("topic to check")
    somebody.click("button", "Edit value: 0")
    somebody.type("11")
    for value in ("15", "7", "11"):
        somebody.click("button", "Add check")
        type_into(somebody, "value", value)
    somebody.click("button", "Edit topic to send…")
    somebody.click("option", "/imu…")
    somebody.click("button", "Edit rate…")
    somebody.click("option", "Competitive…")
    somebody.click("button", "Add rate")
    somebody.await_focus("topic to send")
    somebody.click("combobox", "topic to send")
    somebody.click("option", "/camera/image_raw sensor_msgs/msg/Image…")
    somebody.click("button", "Edit rate…")
    somebody.click("option", "Excessive…")
    somebody.click("button", "Save")
    somebody.sees("Saved shelf.adirf")
    assert (project / "shelf.adirf").read_text() == FIGURE_6_6
    assert somebody.clicks <= MOST_CLICKS_OF_A_CLICKER, somebody.done
    assert somebody.keys <= MOST_KEYS_OF_A_CLICKER, somebody.done


def test_the_rule_is_built_without_a_mouse(ruler: RulerPage, project: Path) -> None:
    somebody = CountedPage(ruler.page)
    somebody.walk("Tab", "New Rule File")
    somebody.press("Enter")
    _name(somebody, "shelf")
    somebody.press("Enter")
    expect(ruler.button("New rule")).to_be_enabled()
    build_rule_without_a_mouse(somebody)
    somebody.press("Control+s")
    somebody.sees("Saved shelf.adirf")
    assert (project / "shelf.adirf").read_text() == FIGURE_6_6
    assert somebody.clicks == 0
    assert somebody.keys <= MOST_KEYS_WITHOUT_A_MOUSE, somebody.done


def _name(somebody: CountedPage, name: str) -> None:
    """Name the new project in the dialog, which has the focus in its field."""
    expect(somebody.page.get_by_role("dialog").get_by_label("Name")).to_be_focused()
    somebody.type(name)
