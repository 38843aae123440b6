# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How long a key stroke takes on the Ruler's page while a large rule file is open.

Run it with ``python benchmarks/ruler_typing.py [--rules 1000] [--keys 120]``; it needs Chromium, Playwright
and the built page. A real Chromium types into the text and into a field of a block. Measured inside the page:
from the time stamp of the key's event to behind the frame that shows it, and how long any task held the page
up meanwhile.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import statistics
import tempfile
from collections.abc import Sequence
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from live.ruler_server import served

TOPICS = ("/odom", "/scan", "/imu", "/camera/image_raw", "/cmd_vel", "/tf", "/joint_states", "/battery_state")
ZONE_M = 3
FLOOR_M = 300
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


def rule_file(rules: int) -> str:
    """Defaults, and rules for zones strewn over a large floor."""
    generator = random.Random(1)
    lines = ["begin", *(f"    SetFrequency {topic} {generator.choice([5, 10, 20])}" for topic in TOPICS)]
    for number in range(rules - len(TOPICS)):
        x_m, y_m = generator.uniform(0, FLOOR_M), generator.uniform(0, FLOOR_M)
        lines += [
            "",
            f"    // Zone {number}",
            f'    Rule "Zone {number}"',
            "    If (",
            f"        CheckValue /odom pose_x > {x_m:.1f}",
            f"        AND CheckValue /odom pose_x < {x_m + ZONE_M:.1f}",
            f"        AND CheckValue /odom pose_y > {y_m:.1f}",
            f"        AND CheckValue /odom pose_y < {y_m + ZONE_M:.1f}",
            "    )",
            "    Then",
            *(
                f"        SetFrequency {topic} {generator.choice([1, 2, 4, 8])}"
                for topic in generator.sample(TOPICS, 2)
            ),
            "    EndIf",
        ]
    return "\n".join([*lines, "end", ""])


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

    def _cpu_s(self) -> float:
        metrics = self._session.send("Performance.getMetrics")["metrics"]
        return float(next(one["value"] for one in metrics if one["name"] == "TaskDuration"))


def report(title: str, page: Page, watch: Watch) -> None:
    """Print what was measured since the last time."""
    # The last answer of the server may be under way.
    page.wait_for_timeout(3000)
    keys, tasks = page.evaluate(COLLECT)
    print(
        f"{title}: {len(keys)} keys, median {statistics.median(keys):.0f} ms, "
        f"p95 {quantile(keys, 0.95):.0f} ms, max {max(keys):.0f} ms; "
        f"longest task {max(tasks, default=0):.0f} ms, {sum(task > 100 for task in tasks)} over 100 ms; "
        f"{watch.lap_ms() / len(keys):.0f} ms of the main thread's CPU for a key with all that follows"
    )


def quantile(values: Sequence[float], share: float) -> float:
    """The value that ``share`` of ``values`` do not exceed."""
    return sorted(values)[min(int(share * len(values)), len(values) - 1)]


def in_text(page: Page, watch: Watch, keys: int) -> None:
    """Change a number at the top of the file, so that all below moves, then write a statement."""
    page.get_by_role("textbox", name="Rules as text").click()
    page.keyboard.press("Control+Home")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("End")
    page.evaluate(COLLECT)
    watch.lap_ms()
    typed(page, ("1234" * keys)[: keys // 2])
    report("number in the text", page, watch)
    page.keyboard.press("Enter")
    page.wait_for_timeout(3000)
    page.evaluate(COLLECT)
    watch.lap_ms()
    typed(page, (STATEMENT * keys)[:keys])
    report("statement in the text", page, watch)


def in_block(page: Page, watch: Watch, keys: int) -> None:
    """Change fields of a block again and again."""
    blocks = page.get_by_role("region", name="Blocks", exact=True)
    blocks.get_by_role("button", name="Edit rate").first.click()
    page.evaluate(COLLECT)
    watch.lap_ms()
    for _ in range(keys // 4):
        typed(page, "12")
        page.keyboard.press("Enter")
        page.wait_for_timeout(400)
        page.keyboard.press("Enter")
    report("field of a block", page, watch)


def main() -> None:
    """Open a large file and type."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rules", type=int, default=1000)
    parser.add_argument("--keys", type=int, default=120)
    options = parser.parse_args()
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        raise SystemExit("this benchmark needs Chromium")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        (Path(folder) / "many.adirf").write_text(rule_file(options.rules))
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        with served(Path(folder), os.environ) as url:
            page = browser.new_page(viewport={"width": 1440, "height": 900})
            page.goto(f"{url}#/rules/many.adirf")
            page.get_by_role("button", name="Edit rate").first.wait_for(timeout=300_000)
            page.evaluate(OBSERVE)
            watch = Watch(page)
            in_text(page, watch, options.keys)
            in_block(page, watch, options.keys)
        browser.close()


if __name__ == "__main__":
    main()
