# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a page of many recordings shows, as a program reads it."""

from __future__ import annotations

from html.parser import HTMLParser


class Tables(HTMLParser):
    """The rows of each table of a page, by its caption: the texts of the cells, and all links."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.rows: dict[str, list[list[str]]] = {}
        self.links: list[str] = []
        self.commands: list[str] = []
        self._caption = ""
        self._open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self._open.append(tag)
        if tag == "caption":
            self._caption = ""
        if tag == "tr":
            self.rows.setdefault(self._caption, []).append([])
        if tag in ("td", "th"):
            self.rows[self._caption][-1].append("")
        if tag == "code":
            self.commands.append("")
        if tag == "a":
            self.links.append(dict(attributes)["href"] or "")

    def handle_endtag(self, tag: str) -> None:
        while self._open and self._open.pop() != tag:
            pass

    def handle_data(self, data: str) -> None:
        if "caption" in self._open:
            self._caption += data
        elif "code" in self._open:
            self.commands[-1] += data
        elif ("td" in self._open or "th" in self._open) and "summary" not in self._open:
            self.rows[self._caption][-1][-1] += data

    def column(self, caption: str, number: int) -> dict[str, str]:
        """A column by the first one."""
        return {row[0]: row[number] for row in self.rows[caption][1:]}
