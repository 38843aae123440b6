# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The Ruler in a real browser, found as a person finds things: by what is written on them."""

from __future__ import annotations

import os
import re
import shutil
import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from playwright.sync_api import Locator, Page, expect

from forked_python import ForkedPython, inherited
from real_browser import TIMEOUT_MS

EXAMPLES = Path(__file__).parents[3] / "examples"
KNOWS_TOUR = "try { localStorage.setItem('tour', 'seen') } catch {}"
"""Of a browser in which somebody took the tour."""
UNFOLDED = "try { localStorage['open panes'] ??= 'text findings' } catch {}"
"""Of one in which text and findings are open beside the blocks."""
GRIP_PX = 9
"""From the corner of a block to where it is taken: beside its fields."""
AFTER_TWO_FRAMES = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
FOCUSED = """(document.activeElement === document.body ? ""
    : document.activeElement.getAttribute("aria-label") || document.activeElement.textContent)"""
"""What a screen reader calls the focused thing; nothing where that is the whole page."""
EDGES = """found => found.map(one => {
    const { left, right } = one.getBoundingClientRect();
    return [left, right];
})"""
"""Of some elements, where each begins and ends."""


@contextmanager
def served(folder: Path, port: int = 0, options: Sequence[str] = ()) -> Iterator[str]:
    """``testudo ruler`` on ``port``, or a free one; yields the address that it prints."""
    command = ["-m", "smarttestudo", "ruler", str(folder), f"--port={port}", "--no-browser", *options]
    environment = {**inherited(os.environ), "PYTHONUNBUFFERED": "1"}
    process = ForkedPython(command, environment, stderr=2)
    with process.stdin, process.stdout:
        try:
            line = process.stdout.readline()
            assert "http://" in line, "the server did not start"
            yield line.split(": ", 1)[1].split()[0]
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait()


class RulerPage:
    """One tab with the Ruler, and what somebody does in it; who is not new there is offered no tour."""

    def __init__(self, page: Page, url: str, *, is_new: bool = False) -> None:
        self.page = page
        self.url = url
        self.complaints: list[str] = []
        self.requests: list[str] = []
        page.set_default_timeout(TIMEOUT_MS)
        if not is_new:
            page.add_init_script(KNOWS_TOUR)
        page.add_init_script(UNFOLDED)
        page.on("console", lambda message: self._hear(message.type, message.text))
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self.requests.append(request.url))

    def _hear(self, kind: str, text: str) -> None:
        if kind in {"error", "warning"}:
            self.complaints.append(text)

    def forgive(self, words: str) -> None:
        """Drop complaints of the browser that hold ``words``, of which there must be some."""
        kept = [each for each in self.complaints if words not in each]
        assert len(kept) < len(self.complaints)
        self.complaints = kept

    def home(self) -> None:
        self.page.goto(self.url)
        self.page.get_by_role("button", name="New Rule File").wait_for()

    def button(self, name: str) -> Locator:
        return self.page.get_by_role("button", name=name, exact=True)

    def pane(self, name: str) -> Locator:
        """What unfolds beside or below the blocks."""
        return self.page.get_by_role("group", name="Unfold").get_by_role("button", name=name, exact=True)

    def open_pane(self, name: str) -> None:
        """Unfold that, where it is not open."""
        if self.pane(name).get_attribute("aria-expanded") == "false":
            self.pane(name).click()

    def open_rates(self) -> None:
        """Open what each topic takes of the budget."""
        self.page.get_by_role("button", name=re.compile("^Budget …|KB.s$")).click()
        self.page.get_by_role("dialog", name="Rates within the budget").wait_for()

    def tool(self, name: str) -> Locator:
        """What the bar on top calls ``name``: a button, or an entry of its menu, which is opened for it."""
        bar = self.page.get_by_role("toolbar", name="Tools")
        menu = bar.get_by_role("button", name="Menu", exact=True)
        menu.wait_for()
        button = bar.get_by_role("button", name=name, exact=True)
        if button.count() > 0:
            return button
        if menu.get_attribute("aria-expanded") == "false":
            menu.click()
        return bar.get_by_role("menuitem", name=name, exact=True)

    @property
    def text(self) -> Locator:
        return self.page.get_by_role("textbox", name="Rules as text")

    @property
    def blocks(self) -> Locator:
        return self.page.get_by_role("region", name="Blocks", exact=True)

    def open(self, name: str) -> None:
        """Open a file from the home screen."""
        self.page.get_by_role("link", name=name, exact=True).click()
        self.blocks.wait_for()

    def field(self, label: str) -> Locator:
        """The lowest field or button on the blocks whose label starts so, as in ``Edit value: 0``."""
        # Playwright takes a plain slash for the end of the pattern.
        start = re.compile("^" + re.escape(label).replace("/", r"\x2f"))
        return lowest(self.blocks.get_by_role("button", name=start))

    def change(self, label: str, value: str) -> None:
        """Click the lowest field with this label, type, press Enter, and see the value on the block.

        A field that a new block opened by itself is not clicked again.
        """
        kind = label.split(":", maxsplit=1)[0]
        if not self.is_open(kind):
            self.field(label).click()
        self.type_value(value)
        self.blocks.get_by_role("button", name=f"{kind}: {value}", exact=True).first.wait_for()

    def is_open(self, kind: str) -> bool:
        """Whether the field that is called ``Edit value`` is open to type into."""
        own = self.page.locator("input:focus").and_(
            self.page.get_by_label(kind.removeprefix("Edit "), exact=True)
        )
        return own.count() > 0

    def type_value(self, value: str) -> None:
        """Type into the field that is open."""
        self.page.keyboard.press("Control+a")
        self.page.keyboard.type(value)
        self.page.keyboard.press("Enter")

    def focused(self) -> str:
        """What a screen reader calls the focused thing."""
        return str(self.page.evaluate(FOCUSED))

    def await_focus(self, words: str) -> None:
        """Wait until the focus is on what is called something with these words."""
        self.page.wait_for_function(f"words => {FOCUSED}.includes(words)", arg=words)

    def walk(self, key: str, name: str, steps: int = 60) -> None:
        """Press ``key`` until the focus is on what is called ``name``."""
        for _ in range(steps):
            self.page.keyboard.press(key)
            if name in self.focused():
                return
        raise AssertionError(f"{key} does not lead to {name!r}, but to {self.focused()!r}")

    def expect_lines(self, *lines: str) -> None:
        """The text holds these lines in this order, whatever stands between them."""
        expect(self.text).to_contain_text(re.compile(r"[\s\S]*".join(re.escape(line) for line in lines)))

    def drag(self, block: Locator, target: Locator, right_px: float, below_px: float) -> None:
        """Drag ``block`` by its edge to beside the left end of the lower edge of ``target``."""
        block.scroll_into_view_if_needed()
        block.hover(position={"x": GRIP_PX, "y": GRIP_PX})
        box = target.bounding_box()
        assert box is not None
        self.page.mouse.down()
        x, y = box["x"] + GRIP_PX + right_px, box["y"] + box["height"] + GRIP_PX + below_px
        self.page.mouse.move(x, y, steps=12)
        # What a place on the way made room for closes first.
        self.page.mouse.move(x + 1, y)
        self.page.mouse.up()

    def save(self) -> None:
        self.tool("Save").click()
        expect(self.tool("Save")).to_be_disabled()


def lowest(found: Locator) -> Locator:
    """The lowest of these, once there are some; one look at all, as an answer may take one away.

    What got the focus just now goes behind the others of the page with the next picture.
    """
    found.first.wait_for()
    found.page.evaluate(AFTER_TWO_FRAMES)
    tops_px = found.evaluate_all("all => all.map(each => each.getBoundingClientRect().top)")
    return found.nth(tops_px.index(max(tops_px)) if tops_px else 0)


def see_no_changes(page: Page, name: str) -> None:
    """Let a page that has the file open see it unchanged, however slow the test is."""
    state = page.evaluate(
        "name => fetch(`api/file/state?name=${name}`).then(answer => answer.json())", arg=name
    )
    page.route(f"**/api/file/state?name={name}", lambda route: route.fulfill(json=state))


def copied(source: Path, target: Path) -> Path:
    """A copy of a folder; returns it."""
    shutil.copytree(source, target)
    return target
