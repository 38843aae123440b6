# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Somebody at the Ruler whose clicks and keys count, and who knows only what is written on the page."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from playwright.sync_api import Locator, Page, expect

from ruler.browser.ruler_page import FOCUSED, lowest

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

CLICKS_PER_CHOICE = 2
"""Clicks to choose from a list of the browser's own: one opens it, one takes the choice."""


@dataclass(slots=True)
class CountedPage:
    """One tab; ``clicks`` counts each press of the mouse, ``keys`` each key, of a chord every one.

    Things are found by their role and the label that a person sees or a screen reader says. Waiting, looking
    and scrolling count nothing.
    """

    page: Page
    clicks: int = 0
    keys: int = 0
    done: list[str] = field(default_factory=list)
    """What was done, a line for each step, to read when a count is too high."""

    def find(self, role: str, label: str, *, within: Locator | None = None) -> Locator:
        """The lowest thing on the page of a role whose whole label this is; a label with ``…`` begins so."""
        is_start = label.endswith("…")
        # Playwright takes a plain slash for the end of the pattern.
        words = re.escape(label.removesuffix("…")).replace("/", r"\x2f")
        name = re.compile(f"^{words}" + ("" if is_start else "$"))
        return lowest((within or self.page).get_by_role(role, name=name))  # type: ignore[arg-type]

    def click(self, role: str, label: str, *, within: Locator | None = None) -> None:
        """One click on what ``find`` finds."""
        self.find(role, label, within=within).click()
        self._count(f"click {label}", clicks=1)

    def count_drag(self, what: str) -> None:
        """Count what was dragged in another way: the mouse is pressed once."""
        self._count(f"drag {what}", clicks=1)

    def choose(self, label: str, choice: str) -> None:
        """Take a choice from a list of the browser's own."""
        self.page.get_by_label(label, exact=True).select_option(choice)
        self._count(f"choose {choice} in {label}", clicks=CLICKS_PER_CHOICE)

    def choose_file(self, role: str, label: str, path: Path) -> None:
        """Click what asks for a file, and take one: a click on it and one to confirm."""
        with self.page.expect_file_chooser() as chosen:
            self.click(role, label)
        chosen.value.set_files(path)
        self._count(f"choose the file {path.name}", clicks=1)

    def type(self, text: str) -> None:
        """Type into what has the focus; a capital letter needs Shift as well."""
        self.page.keyboard.type(text)
        self._count(f"type {text}", keys=sum(2 if letter.isupper() else 1 for letter in text))

    def press(self, chord: str, times: int = 1) -> None:
        """Press a key, or a chord as ``Control+a``."""
        for _ in range(times):
            self.page.keyboard.press(chord)
        often = f" {times} times" if times > 1 else ""
        self._count(f"press {chord}{often}", keys=times * len(chord.split("+")))

    def paste(self, text: str) -> None:
        """Paste what was copied elsewhere into what has the focus."""
        self.page.evaluate(
            "text => { const data = new DataTransfer(); data.setData('text/plain', text);"
            " document.activeElement.dispatchEvent("
            "new ClipboardEvent('paste', {clipboardData: data, bubbles: true, cancelable: true})) }",
            text,
        )
        self._count("paste", keys=2)

    def walk(self, key: str, label: str, most: int = 60) -> None:
        """Press ``key`` until the focus is on what has a label that begins so."""
        pressed = next((step for step in self._steps(key, most) if self.focused().startswith(label)), None)
        assert pressed is not None, f"{key} does not lead to {label!r}, but to {self.focused()!r}"

    def walk_to_field(self, label: str, most: int = 60) -> None:
        """Press Tab until a field of the page's own has the focus, which has its label beside it."""
        field = self.page.get_by_label(label, exact=True)
        is_there = "field => field === document.activeElement"
        is_led_there = any(field.evaluate(is_there) for _ in self._steps("Tab", most))
        assert is_led_there, f"Tab does not lead to {label}"

    def focused(self) -> str:
        """What a screen reader calls the focused thing."""
        return str(self.page.evaluate(FOCUSED))

    def await_focus(self, label: str) -> None:
        """Wait until the focus is on what has a label that begins so."""
        self.page.wait_for_function(f"label => {FOCUSED}.startsWith(label)", arg=label)

    def sees(self, text: str | re.Pattern[str]) -> None:
        """Wait until the page says so somewhere."""
        expect(self.page.get_by_text(text).first).to_be_visible()

    def _steps(self, key: str, most: int) -> Iterator[int]:
        for step in range(most):
            self.press(key)
            yield step

    def _count(self, what: str, *, clicks: int = 0, keys: int = 0) -> None:
        self.clicks += clicks
        self.keys += keys
        self.done.append(f"{what} ({self.clicks} clicks, {self.keys} keys)")
