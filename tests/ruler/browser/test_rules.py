# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Somebody who never programmed builds the rule of the thesis's Figure 6.6."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
from playwright.sync_api import Route, expect

from ruler.browser.ruler_page import RulerPage
from ruler.browser.thesis import FIGURE_6_6


def test_the_rule_is_built_with_the_mouse(ruler: RulerPage, project: Path) -> None:
    ruler.button("New Rule File").click()
    ruler.page.get_by_label("Name").fill("shelf")
    ruler.button("Create").click()
    ruler.button("New rule").click()
    ruler.change("Edit value: 0", "11")
    for value in ("15", "7", "11"):
        ruler.field("Add check").click()
        ruler.change("Edit value: 0", value)
    ruler.change("Edit topic to send", "/imu")
    ruler.change("Edit rate", "Competitive")
    ruler.field("Add rate").click()
    ruler.change("Edit topic to send", "/camera/image_raw")
    ruler.change("Edit rate", "Excessive")
    ruler.expect_lines("SetFrequency /camera/image_raw Excessive")
    ruler.save()
    assert (project / "shelf.adirf").read_text() == FIGURE_6_6


def test_the_rule_is_built_with_the_keyboard_alone(ruler: RulerPage, project: Path) -> None:
    keyboard = ruler.page.keyboard
    ruler.walk("Tab", "New Rule File")
    keyboard.press("Enter")
    expect(ruler.page.get_by_label("Name")).to_be_focused()
    keyboard.type("shelf")
    keyboard.press("Enter")
    expect(ruler.button("New rule")).to_be_enabled()
    ruler.walk("Tab", "New rule")
    keyboard.press("Enter")
    ruler.expect_lines("CheckValue /odom pose_x > 0", "SetFrequency /odom 10")

    keyboard.press("Escape")
    _edit(ruler, "ArrowRight", "Edit value", "11")
    for value in ("15", "7", "11"):
        _press_add_check(ruler)
        ruler.type_value(value)
        _await_value(ruler, value)
    ruler.walk("ArrowDown", "set frequency of")
    _edit(ruler, "ArrowRight", "Edit topic to send", "/imu")
    _edit(ruler, "ArrowRight", "Edit rate", "Competitive")
    ruler.walk("ArrowUp", "Add rate")
    keyboard.press("Enter")
    _await_focus(ruler, "topic to send")
    ruler.type_value("/camera/image_raw")
    _await_value(ruler, "/camera/image_raw")
    _edit(ruler, "ArrowRight", "Edit rate", "Excessive")
    ruler.expect_lines("SetFrequency /camera/image_raw Excessive")
    keyboard.press("Control+s")
    expect(ruler.page.get_by_text("Saved shelf.adirf")).to_be_visible()
    assert (project / "shelf.adirf").read_text() == FIGURE_6_6


def test_half_a_topic_is_not_sent_when_an_earlier_edit_is_answered_meanwhile(ruler: RulerPage) -> None:
    held: list[Route] = []
    ruler.button("New Rule File").click()
    ruler.page.get_by_label("Name").fill("shelf")
    ruler.button("Create").click()
    ruler.button("New rule").click()
    ruler.expect_lines("CheckValue /odom pose_x > 0", "SetFrequency /odom 10")
    ruler.page.route("**/api/edit", lambda route: held.append(route), times=1)  # noqa: PLW0108 - no builtin
    with ruler.page.expect_request("**/api/edit"):
        ruler.change("Edit rate", "Competitive")
    ruler.field("Add rate").click()
    _await_focus(ruler, "topic to send")
    ruler.page.keyboard.press("Control+a")
    ruler.page.keyboard.type("/")
    with ruler.page.expect_response("**/api/edit"):
        held[0].continue_()
    ruler.page.keyboard.type("camera/image_raw")
    ruler.page.keyboard.press("Enter")
    ruler.expect_lines("SetFrequency /odom Competitive", "SetFrequency /camera/image_raw Competitive")


def test_blocks_that_are_left_still_bring_their_edits_into_the_text(ruler: RulerPage, project: Path) -> None:
    held: list[Route] = []
    ruler.page.route("**/api/edit", lambda route: held.append(route), times=1)  # noqa: PLW0108 - no builtin
    rates = "".join(f"    SetFrequency /{topic} 5\n" for topic in "abc")
    (project / "left.adirf").write_text(f"begin\n{rates}end\n")
    ruler.home()
    ruler.open("left.adirf")
    with ruler.page.expect_request("**/api/edit"):
        _retype(ruler, "a", "/in_flight")
    # The answer is awaited, so this one waits in the blocks, and the next one is typed when they are left.
    _retype(ruler, "b", "/queued")
    ruler.field("Edit topic to send: /c").click()
    ruler.page.keyboard.press("Control+a")
    ruler.page.keyboard.type("/typed")
    ruler.page.evaluate("location.hash = '#/'")
    expect(ruler.button("New Rule File")).to_be_visible()
    with ruler.page.expect_response("**/api/edit"):
        held[0].continue_()
    ruler.open("left.adirf")
    ruler.expect_lines("SetFrequency /in_flight 5", "SetFrequency /queued 5", "SetFrequency /typed 5")


def test_what_was_left_in_blocks_and_is_refused_is_said_and_the_rest_comes(
    ruler: RulerPage, project: Path
) -> None:
    held: list[Route] = []
    ruler.page.route("**/api/edit", lambda route: held.append(route), times=1)  # noqa: PLW0108 - no builtin
    rates = "".join(f"    SetFrequency /{topic} 5\n" for topic in "ab")
    (project / "left.adirf").write_text(f"begin\n{rates}end\n")
    ruler.home()
    ruler.open("left.adirf")
    with ruler.page.expect_request("**/api/edit"):
        _retype(ruler, "a", "/in_flight")
    _retype(ruler, "b", "/queued")
    ruler.page.evaluate("location.hash = '#/'")
    expect(ruler.button("New Rule File")).to_be_visible()

    def refuse_one(route: Route) -> None:
        if "in_flight" in (route.request.post_data or ""):
            route.fulfill(status=422, json={"error": {"message": "nobody takes this"}})
        else:
            route.continue_()

    ruler.page.route("**/api/edit", refuse_one)
    refuse_one(held[0])
    said = ruler.page.get_by_role("alert").filter(has_text="left.adirf")
    expect(said).to_contain_text("did not come into the text: /in_flight at 5 Hz. Nobody takes this")
    ruler.page.unroute("**/api/edit", refuse_one)
    ruler.forgive("422")
    said.get_by_role("button", name="Close").click()
    expect(said).to_have_count(0)
    ruler.open("left.adirf")
    ruler.expect_lines("SetFrequency /a 5", "SetFrequency /queued 5")


def _retype(ruler: RulerPage, topic: str, instead: str) -> None:
    ruler.field(f"Edit topic to send: /{topic}").click()
    ruler.type_value(instead)


def _press_add_check(ruler: RulerPage) -> None:
    ruler.walk("ArrowUp", "Begin stack, rule")
    ruler.walk("ArrowRight", "Add check")
    ruler.page.keyboard.press("Enter")
    _await_focus(ruler, "value")


def _await_focus(ruler: RulerPage, label: str) -> None:
    """Wait until the focus is on what a new block asks for first."""
    ruler.page.wait_for_function(
        "label => document.activeElement.getAttribute('aria-label')?.startsWith(label)", arg=label
    )


def _edit(ruler: RulerPage, way: str | None, label: str, value: str) -> None:
    if way is not None:
        ruler.walk(way, label)
    ruler.page.keyboard.press("Enter")
    ruler.type_value(value)
    _await_value(ruler, value)


def _await_value(ruler: RulerPage, value: str) -> None:
    ruler.page.wait_for_function(
        "label => document.activeElement.getAttribute('aria-label')?.endsWith(label)", arg=f": {value}"
    )


@pytest.mark.parametrize("answer", ["**/api/document", "**/api/profile/for"])
def test_rules_are_shown_once_they_are_read_with_their_profile(ruler: RulerPage, answer: str) -> None:
    page = ruler.page
    held: list[Route] = []
    is_over = threading.Event()

    def hold(route: Route) -> None:
        if is_over.is_set():
            route.continue_()
        else:
            held.append(route)

    page.route(answer, hold)
    with page.expect_request(answer):
        page.get_by_role("link", name="quality/inspection.adirf", exact=True).click()
    expect(page.get_by_text("Opening quality/inspection.adirf …")).to_be_visible()
    is_over.set()
    for route in held:
        route.continue_()
    expect(page.get_by_role("tab", name="Findings (2)")).to_be_visible()


def test_rules_that_nobody_checked_are_not_called_good(ruler: RulerPage) -> None:
    page = ruler.page

    def refuse(route: Route) -> None:
        route.fulfill(status=500, json={"error": {"message": "the disk is gone"}})

    page.route("**/api/document", refuse)
    with page.expect_console_message(lambda message: "500" in message.text):
        page.get_by_role("link", name="quality/inspection.adirf", exact=True).click()
    ruler.expect_lines("Inspection")
    expect(page.get_by_text("Checking the rules …")).to_be_visible()
    expect(page.get_by_role("tab", name="Findings (…)")).to_be_visible()
    page.unroute("**/api/document", refuse)
    ruler.forgive("500")
    ruler.text.get_by_text("Inspection").click()
    page.keyboard.press("End")
    page.keyboard.type(" ")
    expect(page.get_by_role("tab", name="Findings (2)")).to_be_visible()
