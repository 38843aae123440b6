# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How long the Ruler's page takes to open a large rule file and to show a key in it, beside a small one.

Run it with ``python benchmarks/ruler_typing.py [--rules 1000] [--keys 120] [--slowdown 6]``; it needs
Chromium, Playwright and the built page. A real Chromium types into the text and into a field of a block, the
same keys first with ten rules: that is what drawing a page costs on this machine. Measured
inside the page: from the time stamp of the key's event to behind the frame that shows it, and how long any
task held the page up meanwhile.
"""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Browser, Page, sync_playwright

from live.ruler_server import chromium_path, served
from live.zone_rules import rule_file

SMALL_FILE_RULES = 10
OPENED_WITHIN_MS = 300_000
GRIP_PX = 40
"""A field this far from the lower end of the blocks can be clicked."""
KEY_PAUSES_MS = (60, 90, 120, 350)
"""A quick typist, who looks up after every fourth letter: then the server's answer comes between two keys."""

STATEMENT = "SetFrequency /diagnostics 5 "

OBSERVE = """() => {
    window.measured = { keys: [], tasks: [] };
    const note = (stamp) => requestAnimationFrame(() => {
        const channel = new MessageChannel();
        channel.port1.onmessage = () => window.measured.keys.push(performance.now() - stamp);
        channel.port2.postMessage(null);
    });
    addEventListener("keydown", (event) => note(event.timeStamp), { capture: true });
    new PerformanceObserver((list) => {
        for (const entry of list.getEntries()) window.measured.tasks.push(entry.duration);
    }).observe({ type: "longtask" });
}"""
COLLECT = """() => {
    const { keys, tasks } = window.measured;
    window.measured.keys = [];
    window.measured.tasks = [];
    return [keys, tasks];
}"""


def typed(page: Page, letters: str) -> None:
    """Press one key after the other, with a typist's pauses."""
    for number, letter in enumerate(letters):
        page.keyboard.press(letter)
        page.wait_for_timeout(KEY_PAUSES_MS[number % len(KEY_PAUSES_MS)])


class Watch:
    """What the page's main thread does, by its CPU clock: other work on the machine does not count."""

    def __init__(self, page: Page) -> None:
        self._session = page.context.new_cdp_session(page)
        self._session.send("Performance.enable", {"timeDomain": "threadTicks"})
        self._before_s = self._cpu_s()

    def lap_ms(self) -> float:
        """CPU since the last lap."""
        before_s, self._before_s = self._before_s, self._cpu_s()
        return (self._before_s - before_s) * 1000

    def slow_down(self, times: float) -> None:
        """Let the page's processor be so many times slower from now on."""
        self._session.send("Emulation.setCPUThrottlingRate", {"rate": times})

    def _cpu_s(self) -> float:
        metrics = self._session.send("Performance.getMetrics")["metrics"]
        return float(next(one["value"] for one in metrics if one["name"] == "TaskDuration"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Strokes:
    """What keys in one place took, the longest tasks meanwhile, and the main thread's CPU for each key."""

    place: str
    keys_ms: Sequence[float]
    tasks_ms: Sequence[float]
    cpu_ms: float

    def __str__(self) -> str:
        return (
            f"{self.place}: {len(self.keys_ms)} keys, median {statistics.median(self.keys_ms):.0f} ms, "
            f"p95 {quantile(self.keys_ms, 0.95):.0f} ms, max {max(self.keys_ms):.0f} ms; "
            f"longest task {max(self.tasks_ms, default=0):.0f} ms, "
            f"{sum(task_ms > 100 for task_ms in self.tasks_ms)} over 100 ms; {self.cpu_ms:.0f} ms of the "
            f"main thread's CPU for a key with all that follows"
        )

    def ratios(self, small: Strokes) -> str:
        """Median and p95 as multiples of those of the same keys in a small file."""
        median = statistics.median(self.keys_ms) / statistics.median(small.keys_ms)
        p95 = quantile(self.keys_ms, 0.95) / quantile(small.keys_ms, 0.95)
        return f"{self.place}: {median:.2f} times the median and {p95:.2f} times the p95 of the small file"


def opening(page: Page, url: str, watch: Watch) -> str:
    """Open the file in a browser that has nothing of the page yet, and say how long that took."""
    begin_s = time.perf_counter()
    page.goto(f"{url}#/rules/many.adirf", wait_until="commit")
    page.get_by_role("textbox", name="Rules as text").wait_for(timeout=OPENED_WITHIN_MS)
    text_s = time.perf_counter() - begin_s
    page.get_by_role("button", name="Edit rate").first.wait_for(timeout=OPENED_WITHIN_MS)
    blocks_s = time.perf_counter() - begin_s
    page.wait_for_timeout(3000)
    return (
        f"opening: the text after {text_s:.1f} s, the blocks after {blocks_s:.1f} s; "
        f"{watch.lap_ms():.0f} ms of the main thread's CPU"
    )


def strokes(place: str, page: Page, watch: Watch) -> Strokes:
    """What was measured since the last time."""
    # The last answer of the server may be under way.
    page.wait_for_timeout(3000)
    keys_ms, tasks_ms = page.evaluate(COLLECT)
    return Strokes(
        place=place, keys_ms=keys_ms, tasks_ms=tasks_ms, cpu_ms=watch.lap_ms() / max(len(keys_ms), 1)
    )


def quantile(values: Sequence[float], share: float) -> float:
    """The value that ``share`` of ``values`` do not exceed."""
    return sorted(values)[min(int(share * len(values)), len(values) - 1)]


def in_text(page: Page, watch: Watch, keys: int) -> Iterator[Strokes]:
    """Change a number at the top of the file, so that all below moves, then write a statement."""
    page.get_by_role("textbox", name="Rules as text").click()
    page.keyboard.press("Control+Home")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("End")
    page.evaluate(COLLECT)
    watch.lap_ms()
    typed(page, ("1234" * keys)[: keys // 2])
    yield strokes("number in the text", page, watch)
    page.keyboard.press("Enter")
    page.wait_for_timeout(3000)
    page.evaluate(COLLECT)
    watch.lap_ms()
    typed(page, (STATEMENT * keys)[:keys])
    yield strokes("statement in the text", page, watch)
    # While a statement is cut off, no block can be edited.
    typed(page, STATEMENT[keys % len(STATEMENT) :])


def in_block(page: Page, watch: Watch, keys: int) -> Iterator[Strokes]:
    """Open a field of a block again and again, and change it."""
    blocks = page.get_by_role("region", name="Blocks", exact=True)
    pane = blocks.bounding_box() or {"y": 0.0, "height": 0.0}
    end_px = pane["y"] + pane["height"] - GRIP_PX
    rates = blocks.get_by_role("button", name="Edit rate")
    rates.first.wait_for()
    boxes = (rate.bounding_box() or pane for rate in rates.all())
    place = next(box for box in boxes if pane["y"] < box["y"] < end_px)
    page.evaluate(COLLECT)
    watch.lap_ms()
    for _ in range(keys // 3):
        page.mouse.click(place["x"] + GRIP_PX / 4, place["y"] + place["height"] / 2)
        typed(page, "12")
        page.keyboard.press("Enter")
        page.wait_for_timeout(400)
    yield strokes("field of a block", page, watch)


def typing(browser: Browser, rules: int, keys: int, slowdown: float) -> Iterator[Strokes]:
    """Open a file of so many rules and type, on a processor that Chromium slows down so many times."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "many.adirf").write_text(rule_file(rules))
        with served(Path(folder), os.environ) as url:
            page = browser.new_page(viewport={"width": 1440, "height": 900})
            # A page of the server in which nothing runs: the process that is watched stays.
            page.goto(f"{url}icon.svg")
            watch = Watch(page)
            watch.slow_down(slowdown)
            print(f"  {opening(page, url, watch)}", flush=True)
            page.evaluate(OBSERVE)
            yield from in_text(page, watch, keys)
            yield from in_block(page, watch, keys)
            page.close()


def main() -> None:
    """Type in a small file and in a large one."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rules", type=int, default=1000)
    parser.add_argument("--keys", type=int, default=120)
    parser.add_argument("--slowdown", type=float, default=1)
    options = parser.parse_args()
    measured: list[list[Strokes]] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium_path(), args=["--no-sandbox"])
        for rules in (SMALL_FILE_RULES, options.rules):
            print(f"{rules} rules", flush=True)
            measured.append([])
            for one in typing(browser, rules, options.keys, options.slowdown):
                print(f"  {one}", flush=True)
                measured[-1].append(one)
        browser.close()
    for small, large in zip(*measured, strict=True):
        print(large.ratios(small))


if __name__ == "__main__":
    main()
