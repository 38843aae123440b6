# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A page whose server is gone says so, and goes on by itself."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from link.zenoh.ends import until
from ruler.browser.ruler_page import RulerPage, served

RULES = "begin\n    SetFrequency /odom 10\n    SetFrequency /odom 5\nend\n"
TYPED = "// weighed"
# What is asked after the server ended, and what it was asked when it did.
NO_SERVER = re.compile(
    "net::ERR_(CONNECTION_(REFUSED|RESET|CLOSED|ABORTED)|EMPTY_RESPONSE|SOCKET_NOT_CONNECTED)"
)
SINCE = re.compile(r"has not answered since \d\d:\d\d\.")
AS_OF = re.compile(r"^As of \d\d:\d\d")


class Server:
    """A Ruler that ends and begins again, on the same port."""

    def __init__(self, folder: Path, port: int) -> None:
        self._folder = folder
        self._port = port
        self._running = ExitStack()
        self.url = ""

    def start(self, folder: Path | None = None) -> None:
        """Start it where it was, or on another folder."""
        self.url = self._running.enter_context(served(folder or self._folder, self._port))

    def stop(self) -> None:
        """End its process, and wait until it is gone."""
        self._running.close()


@pytest.fixture
def server(project: Path, ruler_port: int) -> Iterator[Server]:
    server = Server(project, ruler_port)
    server.start()
    yield server
    server.stop()


@pytest.fixture
def page(browser: Browser, server: Server, project: Path) -> Iterator[RulerPage]:
    """A page on a rule file with a warning."""
    (project / "rules.adirf").write_text(RULES)
    context = browser.new_context(viewport={"width": 1440, "height": 900}, reduced_motion="reduce")
    page = RulerPage(context.new_page(), server.url)
    page.home()
    page.open("rules.adirf")
    expect(page.blocks.get_by_role("button", name="Edit topic to send")).to_have_count(2)
    yield page
    context.close()
    page.complaints = [each for each in page.complaints if not NO_SERVER.search(each)]
    assert page.complaints == []


@pytest.mark.journey
def test_a_page_without_its_server_says_so_and_what_still_works(page: RulerPage, server: Server) -> None:
    findings = page.page.get_by_role("list", name="Findings")
    expect(findings.get_by_text("Warning")).to_be_visible()
    until(lambda: _is_grey(page) == [False])
    server.stop()
    banner = page.page.get_by_role("alert").filter(has_text=SINCE)
    expect(banner).to_contain_text("You can go on typing in the text")
    expect(page.page.get_by_text(AS_OF)).to_be_visible()
    until(lambda: _is_grey(page) == [True])
    for name in ("New rate", "New rule"):
        expect(page.button(name)).to_be_disabled()
    for name in ("Save", "Versions", "Send to robot", "Optimize and Download"):
        expect(page.tool(name)).to_be_disabled()
    expect(page.button("remove the overridden default")).to_be_disabled()
    reason = "This needs the Ruler's server, which does not answer now"
    expect(page.button("New rate").locator("xpath=..")).to_have_attribute("title", reason)
    _type_below(page, "SetFrequency /scan 3")
    expect(page.text).to_contain_text("SetFrequency /scan 3")
    expect(page.tool("Undo")).to_be_enabled()


def test_what_was_typed_is_there_again_after_the_server_had_another_folder(
    page: RulerPage, server: Server, tmp_path: Path
) -> None:
    page.text.get_by_text("SetFrequency").first.click()
    page.page.keyboard.type(TYPED)
    page.expect_lines(TYPED)
    server.stop()
    (tmp_path / "other").mkdir()
    server.start(tmp_path / "other")
    expect(page.page.get_by_text("other has no rules.adirf")).to_be_visible()
    server.stop()
    server.start()
    expect(page.page.get_by_role("listitem").filter(has_text="rules.adirf")).to_contain_text("not saved")
    page.open("rules.adirf")
    page.expect_lines(TYPED)
    # The other project may have been sent the draft, and does not take it.
    assert list((tmp_path / "other").glob(".testudo/drafts/*")) == []
    page.complaints = [each for each in page.complaints if "409" not in each]


def test_blocks_come_when_the_server_is_back(page: RulerPage, server: Server) -> None:
    code = re.compile("rule_workspace-.*[.]js")
    page.page.route(code, lambda route: route.abort())
    page.home()
    page.page.get_by_role("link", name="rules.adirf", exact=True).click()
    page.expect_lines("SetFrequency /odom 10")
    server.stop()
    expect(page.page.get_by_role("alert").filter(has_text=SINCE)).to_be_visible()
    page.page.unroute(code)
    server.start()
    expect(page.blocks.get_by_role("button", name="Edit topic to send")).to_have_count(2)
    page.button("New rate").click()
    expect(page.blocks.get_by_role("button", name="Edit topic to send")).to_have_count(3)
    page.forgive("ERR_FAILED")
    page.forgive("Failed to fetch dynamically imported module")


def test_the_map_and_the_versions_come_when_the_server_is_back(page: RulerPage, server: Server) -> None:
    server.stop()
    expect(page.page.get_by_role("alert").filter(has_text=SINCE)).to_be_visible()
    page.open_pane("Map")
    loading = page.page.get_by_text("Loading the map …")
    expect(loading).to_be_visible()
    server.start()
    expect(page.page.get_by_role("alert").filter(has_text=SINCE)).to_have_count(0)
    expect(loading).to_have_count(0)
    expect(
        page.page.get_by_label("Background").get_by_role("option", name="Map: warehouse_map.yaml")
    ).to_be_attached()
    page.forgive("Failed to fetch dynamically imported module")
    server.stop()
    versions = page.tool("Versions")
    expect(versions).to_be_disabled()
    server.start()
    versions.click()
    expect(page.page.locator(".versions-pane")).to_contain_text("None yet: each save of this file keeps one.")


def _is_grey(page: RulerPage) -> list[bool]:
    """Whether the marks on blocks are shown as things of the past."""
    grey: list[bool] = page.page.evaluate(
        "() => [...document.querySelectorAll('.finding-mark')]"
        ".map(mark => getComputedStyle(mark).filter.includes('grayscale'))"
    )
    return grey


def _type_below(page: RulerPage, line: str) -> None:
    page.text.get_by_text("SetFrequency /odom 10").click()
    for key in ("End", "Enter"):
        page.page.keyboard.press(key)
    page.page.keyboard.type(line)
