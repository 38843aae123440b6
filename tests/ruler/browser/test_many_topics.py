# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Sixty topics with long names that do not fit the link: everything stays on a laptop's screen."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import expect

from ruler.browser.ruler_page import RulerPage

SIZE_PX = {"width": 1280, "height": 800}
TOPICS = [f"/warehouse_robot_{n:02}/camera_front_left/depth_registered/image_rect_raw" for n in range(60)]
WIDER = "document.documentElement.scrollWidth - innerWidth"
# What sticks out of its own box without a scroll bar, or is cut off by the window.
BEYOND = """() => [...document.querySelectorAll("main *, .dock *")]
    .filter((each) => each.closest("svg, .blocks-host, .text-host, .visually-hidden") === null)
    .filter((each) => each.getBoundingClientRect().width > 0)
    .filter((each) => each.getBoundingClientRect().right > innerWidth + 1)
    .filter((each) => {
        for (let box = each.parentElement; box !== null; box = box.parentElement)
            if (["auto", "scroll", "hidden"].includes(getComputedStyle(box).overflowX)) return false;
        return true;
    })
    .map((each) => each.outerHTML.slice(0, 120))"""


@pytest.fixture
def sixty(ruler: RulerPage, project: Path) -> RulerPage:
    defaults = "".join(f"    SetFrequency {topic} Desirable\n" for topic in TOPICS)
    busy = "".join(f"        SetFrequency {topic} Excessive\n" for topic in TOPICS)
    rule = f'    Rule "All"\n    If CheckValue {TOPICS[0]} rate > 1\n    Then\n{busy}    EndIf\n'
    (project / "sixty.adirf").write_text(f"begin\n{defaults}\n{rule}end\n")
    rows = "".join(
        f'[topics."{topic}"]\nmessage_kb = 900.5\nsource_hz = 30\ntiers_hz = [2, 5, 10, 15, 20, 25]\n'
        for topic in TOPICS
    )
    (project / "sixty.toml").write_text(f"budget_kb_per_s = 1000.0\n{rows}")
    ruler.page.set_viewport_size({"width": SIZE_PX["width"], "height": SIZE_PX["height"]})
    ruler.home()
    return ruler


def _optimizer(ruler: RulerPage) -> None:
    ruler.open("sixty.adirf")
    ruler.page.get_by_role("tab", name="Optimize").click()
    ruler.page.get_by_text("Not everything fits").wait_for()


def _rules(ruler: RulerPage) -> None:
    ruler.open("sixty.adirf")
    expect(ruler.page.get_by_label("Topic parameters")).to_have_value("sixty.toml")
    ruler.page.get_by_text("No findings: the rules can be used as they are.").wait_for()


def _findings(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.page.get_by_label("Topic parameters").select_option("")
    expect(ruler.page.get_by_role("list", name="Findings").get_by_role("listitem")).not_to_have_count(0)


def _parameters(ruler: RulerPage) -> None:
    ruler.page.get_by_role("link", name="sixty.toml", exact=True).click()
    expect(ruler.page.get_by_role("textbox", name="Topic", exact=False).nth(59)).to_have_value(TOPICS[59])


def _search(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.page.get_by_role("combobox", name="Find a rule").fill("image")
    ruler.page.get_by_role("option").first.wait_for()


def _export(ruler: RulerPage) -> None:
    _rules(ruler)
    ruler.tool("Export").click()
    ruler.page.get_by_role("dialog").wait_for()


PAGES: tuple[Callable[[RulerPage], None], ...] = (
    _optimizer,
    _rules,
    _findings,
    _parameters,
    _search,
    _export,
)


@pytest.mark.parametrize("reach", PAGES, ids=lambda reach: reach.__name__.strip("_"))
def test_sixty_topics_stay_on_the_screen(sixty: RulerPage, reach: Callable[[RulerPage], None]) -> None:
    reach(sixty)
    assert sixty.page.evaluate(WIDER) <= 0
    assert sixty.page.evaluate(BEYOND) == []
