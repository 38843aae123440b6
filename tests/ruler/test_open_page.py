# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A page that reads slowly costs the server no memory."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import cast

from starlette.websockets import WebSocket

from smarttestudo.ruler.server.live import OpenPage, Watch


class SlowBrowser:
    """Takes a message only when ``reads`` was called."""

    def __init__(self) -> None:
        self.taken: list[str] = []
        self._may_take = asyncio.Semaphore(0)

    async def send_text(self, text: str) -> None:
        await self._may_take.acquire()
        self.taken.append(text)

    async def reads(self, messages: int) -> list[str]:
        count = len(self.taken) + messages
        for _ in range(messages):
            self._may_take.release()
        while len(self.taken) < count:
            await asyncio.sleep(0)
        return self.taken


def test_of_what_a_slow_page_did_not_read_yet_only_the_newest_of_a_kind_is_kept() -> None:
    async def session() -> list[str]:
        browser = SlowBrowser()
        page = OpenPage(cast("WebSocket", browser))
        telling = asyncio.ensure_future(page.keep_telling())
        page.tell("hello", "hello")
        await browser.reads(1)
        for number in range(10_000):
            page.tell("live", f"live {number}")
            page.tell("robots", f"robots {number}")
            await asyncio.sleep(0)
        taken = [*await browser.reads(3)]
        telling.cancel()
        return taken

    # A browser that other tests use has a loop of its own in this thread.
    with ThreadPoolExecutor(1) as thread:
        taken = thread.submit(asyncio.run, session()).result()
    # The first one was on its way when the page stopped reading.
    assert taken == ["hello", "live 0", "robots 9999", "live 9999"]


def test_a_page_gets_as_many_updates_as_it_asked_for_within_bounds() -> None:
    page = OpenPage(cast("WebSocket", SlowBrowserless()))
    for asked, given in ((5.0, 5.0), (1e300, 20.0), (-3.0, 1.0), (0.0, 1.0)):
        page.watched = Watch(node="/n", update_hz=asked)
        assert page.update_hz == given


class SlowBrowserless:
    """Nothing is sent to it."""
