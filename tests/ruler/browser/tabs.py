# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tabs of one browser profile, in which the page is loaded and compiled once for many tests."""

from __future__ import annotations

from playwright.sync_api import BrowserContext, CDPSession, Page

STORED = ("cookies", "local_storage", "indexeddb", "cache_storage", "service_workers")
SMALL_FILE = "icon.svg"
"""Of the Ruler; a tab that shows it runs nothing."""


class Tabs:
    """What a test opens in ``context``, and one tab that stays: it keeps the process that has the page."""

    def __init__(self, context: BrowserContext) -> None:
        self._context = context
        self._staying: Page | None = None
        self._storage: CDPSession | None = None

    def open_at(self, address: str) -> Page:
        """An empty tab; nothing that an earlier test stored at this address is there any more."""
        if self._storage is None:
            self._staying = self._context.new_page()
            self._staying.goto(f"{address}/{SMALL_FILE}")
            self._storage = self._context.new_cdp_session(self._staying)
        asked = {"origin": address, "storageTypes": ",".join(STORED)}
        self._storage.send("Storage.clearDataForOrigin", asked)
        return self._context.new_page()

    def close(self) -> None:
        """Close all tabs of a test; the profile is online again."""
        self._context.set_offline(False)
        for tab in self._context.pages:
            if tab is not self._staying:
                tab.close()
