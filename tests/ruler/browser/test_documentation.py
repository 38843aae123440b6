# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The documentation in a tab: at the heading that is asked for, with its search, from this server alone."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from ruler.browser.ruler_page import RulerPage

pytestmark = pytest.mark.usefixtures("built_documentation")
CLASH = """begin
    SetFrequency /odom 10
    If (
        CheckValue /odom pose_x > 5
        AND CheckValue /odom pose_x < 3
    )
    Then
        SetFrequency /odom 20
end
"""


def test_why_f1_and_keys_open_the_documentation_at_their_heading(ruler: RulerPage, project: Path) -> None:
    (project / "clash.adirf").write_text(CLASH, encoding="utf-8")
    ruler.page.reload()
    ruler.open("clash.adirf")
    with ruler.page.expect_popup() as opened:
        ruler.page.get_by_role("link", name="Why?").first.click()
    tab = opened.value
    expect(tab.get_by_role("heading", name="condition-never-holds")).to_be_in_viewport()
    ruler.page.keyboard.press("F1")
    expect(tab.get_by_role("heading", name="Build rules as blocks")).to_be_in_viewport()
    ruler.tool("Keys").click()
    expect(tab.get_by_role("heading", name="Keys")).to_be_in_viewport()
    assert [page for page in ruler.page.context.pages if "/documentation/" in page.url] == [tab]


def test_its_search_finds_pages_and_all_of_it_comes_from_this_server(ruler: RulerPage) -> None:
    asked, said = [], []
    ruler.page.context.on("request", lambda request: asked.append(request.url))
    with ruler.page.expect_popup() as opened:
        ruler.page.keyboard.press("F1")
    tab: Page = opened.value
    tab.on("console", lambda message: said.append(message.text))
    tab.on("pageerror", lambda error: said.append(str(error)))
    tab.reload()
    search = tab.get_by_role("textbox", name="Search")
    search.click()
    search.press_sequentially("dead reckoning")
    found = tab.locator(".md-search-result__list > li").first
    expect(found).to_contain_text("Dead reckoning")
    found.get_by_role("link").first.click()
    expect(tab).to_have_url(re.compile(r"/documentation/how-to/dead-reckoning\.html"))
    assert said == []
    assert {url.split("/")[2] for url in asked if not url.startswith("data:")} == {
        ruler.page.url.split("/")[2]
    }
