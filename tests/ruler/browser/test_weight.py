# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a browser loads for the editor, in bytes that came over the wire, headers and answers included."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, BrowserContext, Route, expect

from ruler.browser.ruler_page import KNOWS_TOUR, served

FIRST_LIMIT_BYTES = 420_000
SECOND_LIMIT_BYTES = 10_600
CORRIDOR = "Edit name of the rule: Warehouse Corridor"


def test_the_editor_is_light_on_the_wire_and_lighter_the_second_time(browser: Browser, project: Path) -> None:
    with served(project) as url:
        context = browser.new_context(viewport={"width": 1440, "height": 900})
        context.add_init_script(KNOWS_TOUR)
        first, second = (_load(context, url) for _ in range(2))
        context.close()
    assert sum(first.values()) <= FIRST_LIMIT_BYTES, first
    assert sum(second.values()) <= SECOND_LIMIT_BYTES, second


def test_the_server_reads_the_rules_once_to_open_them(browser: Browser, project: Path) -> None:
    with served(project) as url:
        context = browser.new_context(viewport={"width": 1440, "height": 900})
        context.add_init_script(KNOWS_TOUR)
        read: list[str] = []
        context.on("request", lambda request: read.append(request.url.removeprefix(url)))
        _load(context, url)
        context.close()
    assert (read.count("api/document"), read.count("api/vocabulary")) == (1, 1)


def _load(context: BrowserContext, url: str) -> dict[str, int]:
    """Open the editor in a new tab until its findings are there; the bytes of each answer."""
    page = context.new_page()
    wire = context.new_cdp_session(page)
    names: dict[str, str] = {}
    sizes: dict[str, int] = {}

    def begin(event: dict[str, Any]) -> None:
        names[event["requestId"]] = event["request"]["url"]

    def end(event: dict[str, Any]) -> None:
        name = names[event["requestId"]]
        sizes[name] = sizes.get(name, 0) + int(event["encodedDataLength"])

    wire.on("Network.requestWillBeSent", begin)
    wire.on("Network.loadingFinished", end)
    wire.send("Network.enable")
    page.goto(f"{url}#/rules/warehouse.adirf")
    page.get_by_role("button", name=re.compile(r"^Findings \(\d+\)$")).wait_for()
    page.get_by_role("button", name=CORRIDOR).wait_for(state="attached")
    page.wait_for_load_state("networkidle")
    page.close()
    return sizes


def test_the_text_can_be_changed_before_the_blocks_are_loaded(browser: Browser, project: Path) -> None:
    with served(project) as url:
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.add_init_script(KNOWS_TOUR)
        held: list[Route] = []

        def hold(route: Route) -> None:
            held.append(route)

        page.route("**/assets/rule_workspace-*.js", hold)
        with page.expect_request("**/assets/rule_workspace-*.js"):
            page.goto(f"{url}#/rules/warehouse.adirf")
        page.get_by_role("button", name="Text", exact=True).click()
        text = page.get_by_role("textbox", name="Rules as text")
        text.click()
        page.keyboard.press("Control+Home")
        page.keyboard.type("// Typed early")
        expect(text).to_contain_text("// Typed early")
        expect(page.get_by_role("button", name="New rule")).to_be_disabled()
        for route in held:
            route.continue_()
        expect(page.get_by_role("button", name="New rule")).to_be_enabled()
        page.get_by_role("button", name=CORRIDOR).wait_for(state="attached")
        page.close()
