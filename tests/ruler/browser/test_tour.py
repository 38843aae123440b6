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
            expect(ruler.pane("Findings (1)")).to_be_visible()
        page.keyboard.press("Enter")
    expect(ruler.button("New Rule File")).to_be_visible()
    expect(page.get_by_role("heading", name="ADIRF Ruler")).to_be_focused()
    page.reload()
    expect(ruler.button("New Rule File")).to_be_visible()
    expect(page.get_by_role("dialog", name=OFFER)).to_have_count(0)
    assert list(project.iterdir()) == []


def _card(ruler: RulerPage) -> Locator:
    return ruler.page.get_by_role("dialog", name="Tour", exact=True)
