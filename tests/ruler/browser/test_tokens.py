# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A Ruler for other machines: whoever has no token of it, or another one by now, is told what to do."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import BrowserContext, Locator, expect

from axe import violations
from ruler.browser.ruler_page import RulerPage
from ruler.ruler_server import served

if TYPE_CHECKING:
    from playwright.sync_api import Browser

RULES = "begin\n    SetFrequency /odom 5\nend\n"
TOKEN, WATCH_TOKEN = "may-change", "may-watch"
TOO_OLD = "no longer takes this browser's token"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "patrol.adirf").write_text(RULES)
    return folder


@pytest.fixture
def browser_of_one(browser: Browser) -> Iterator[BrowserContext]:
    """The browser of somebody who was never here."""
    with browser.new_context() as context:
        yield context


@pytest.fixture
def origin(project: Path) -> Iterator[str]:
    with served(project, token=TOKEN, watch_token=WATCH_TOKEN) as page:
        yield page.origin


@pytest.mark.parametrize("address", ["/", "/?token=guessed", "/#/rules/patrol.adirf"])
def test_an_address_without_a_token_says_which_one_to_open(
    browser_of_one: BrowserContext, origin: str, address: str
) -> None:
    page = browser_of_one.new_page()
    answer = page.goto(origin + address)
    assert answer is not None
    assert answer.status == 401
    expect(page.get_by_role("heading", name="The token is missing or wrong")).to_be_visible()
    expect(page.get_by_text("Open the whole address that testudo ruler printed")).to_be_visible()
    assert violations(page) == []


@pytest.mark.journey
def test_a_link_in_a_mail_opens_the_file_with_its_token_and_later_without(
    browser_of_one: BrowserContext, origin: str
) -> None:
    page = browser_of_one.new_page()
    with _mail_with(
        f"{origin}/?token={WATCH_TOKEN}#/rules/patrol.adirf", f"{origin}/#/rules/patrol.adirf"
    ) as mail:
        for link in ("with", "without"):
            page.goto(mail)
            page.get_by_role("link", name=link, exact=True).click()
            expect(page.get_by_role("heading", name="patrol.adirf")).to_be_visible()
            assert "token" not in page.url


def test_a_page_whose_token_is_too_old_says_so_and_goes_on_with_the_new_one(
    browser_of_one: BrowserContext, project: Path
) -> None:
    with served(project, token=TOKEN) as page:
        ruler = RulerPage(browser_of_one.new_page(), f"{page.origin}/?token={TOKEN}")
        ruler.home()
        ruler.open("patrol.adirf")
        ruler.button("New rate").click()
        ruler.expect_lines("SetFrequency /odom 5", "SetFrequency")
    with served(project, page.port, token="the-next") as page:
        gone = ruler.page.get_by_role("alert").filter(has_text=TOO_OLD)
        expect(gone).to_contain_text("open that in another tab")
        other = RulerPage(browser_of_one.new_page(), f"{page.origin}/?token=the-next")
        other.home()
        expect(gone).to_have_count(0)
        ruler.save()
    assert (project / "patrol.adirf").read_text() != RULES


def test_a_tab_knows_that_another_got_a_token_to_watch_only(
    browser_of_one: BrowserContext, origin: str
) -> None:
    ruler = RulerPage(browser_of_one.new_page(), f"{origin}/?token={TOKEN}")
    ruler.home()
    new_file = ruler.button("New Rule File")
    expect(new_file).to_be_enabled()
    other = RulerPage(browser_of_one.new_page(), f"{origin}/?token={WATCH_TOKEN}")
    other.home()
    expect(_watch_notice(ruler)).to_be_visible()
    expect(new_file).to_be_disabled()
    other.page.goto(f"{origin}/?token={TOKEN}")
    expect(new_file).to_be_enabled()
    expect(_watch_notice(ruler)).to_have_count(0)


def _watch_notice(ruler: RulerPage) -> Locator:
    return ruler.page.get_by_role("status").filter(has_text="You may only watch here.")


@contextmanager
def _mail_with(with_token: str, without: str) -> Iterator[str]:
    """The address of another site with two links."""

    class Mail(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(f'<a href="{with_token}">with</a> <a href="{without}">without</a>'.encode())

        def log_message(self, *_: object) -> None:
            """Nothing is logged."""

    with HTTPServer(("127.0.0.1", 0), Mail) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://localhost:{server.server_port}/"
        finally:
            server.shutdown()
            thread.join()
