# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Somebody who never programmed builds the rule of the thesis's Figure 6.6, and hears what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Route, expect

from ruler.browser.ruler_page import RulerPage
from ruler.browser.thesis import FIGURE_6_6


@pytest.mark.journey
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
