# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How long a key in a file of many rules takes to be on the screen, and the findings after it to follow.

Run it with ``python benchmarks/ruler_typing.py [--rules 500] [--turns 5]``; it needs Chromium, Playwright and
the built page. A real Chromium types letter by letter behind the first rate of the text, then takes all back
again: so an error comes, and goes. Measured inside the page: from the time stamp of each key's event to
behind the frame that shows it, and from the last key to behind the frame that shows other findings.
"""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
from collections.abc import Sequence
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from live.ruler_server import chromium_path, served
from live.zone_rules import rule_file

OPENED_WITHIN_MS = 300_000
WORDS = " some words"
"""Behind a rate, an error."""
PAUSES_MS = (60, 90, 120)
"""A quick typist, who looks up only behind the last letter."""
KEY_TARGET_MS = 50
FINDINGS_TARGET_MS = 1000

OBSERVE = """() => {
    const behindFrame = (done) => requestAnimationFrame(() => {
        const channel = new MessageChannel();
        channel.port1.onmessage = done;
        channel.port2.postMessage(null);
    });
    const list = document.querySelector("[aria-label=Findings]");
    window.measured = { keys: [], last: 0, findings: null };
    addEventListener("keydown", ({ timeStamp }) => {
        Object.assign(window.measured, { last: timeStamp, findings: null });
        behindFrame(() => window.measured.keys.push(performance.now() - timeStamp));
    }, { capture: true });
    new MutationObserver(() => behindFrame(() => {
        window.measured.findings = performance.now() - window.measured.last;
    })).observe(list, { characterData: true, childList: true, subtree: true });
}"""
FOUND = "() => window.measured.findings !== null"
COLLECT = """() => {
    const { keys, findings } = window.measured;
    window.measured.keys = [];
    return [keys, findings];
}"""


def typed(page: Page, keys: Sequence[str]) -> tuple[Sequence[float], float]:
    """What each key took, and the findings behind the last, in ms."""
    for number, key in enumerate(keys):
        page.keyboard.press(key)
        page.wait_for_timeout(PAUSES_MS[number % len(PAUSES_MS)])
    page.wait_for_function(FOUND)
    keys_ms, findings_ms = page.evaluate(COLLECT)
    page.wait_for_timeout(1000)
    return keys_ms, findings_ms


def measure(page: Page, url: str, turns: int) -> None:
    """Type in an open file, and take it back, and print what it took."""
    page.goto(url)
    page.get_by_role("button", name="Edit rate").first.wait_for(timeout=OPENED_WITHIN_MS)
    for pane in ("Text", "Findings"):
        page.get_by_role("group", name="Unfold").get_by_role("button", name=pane).click()
    page.get_by_role("textbox", name="Rules as text").click()
    for key in ("Control+Home", "ArrowDown", "End"):
        page.keyboard.press(key)
    page.wait_for_timeout(3000)
    page.evaluate(OBSERVE)
    medians_ms: list[float] = []
    most_ms: list[float] = []
    waits_ms: list[float] = []
    for turn in range(1, turns + 1):
        written_ms, error_ms = typed(page, WORDS)
        # The first blank stays, so that the server knows no text from before.
        taken_back_ms, gone_ms = typed(page, ["Backspace"] * (len(WORDS) - 1))
        keys_ms = [*written_ms, *taken_back_ms]
        medians_ms.append(statistics.median(keys_ms))
        most_ms.append(max(keys_ms))
        waits_ms.append(max(error_ms, gone_ms))
        print(
            f"turn {turn}: {len(keys_ms)} keys, median {medians_ms[-1]:.0f} ms, longest "
            f"{most_ms[-1]:.0f} ms; findings {error_ms:.0f} and {gone_ms:.0f} ms behind the last key",
            flush=True,
        )
    print(
        f"medians: a key {statistics.median(medians_ms):.0f} ms (target {KEY_TARGET_MS}), the longest "
        f"{statistics.median(most_ms):.0f} ms; findings {statistics.median(waits_ms):.0f} ms "
        f"(target {FINDINGS_TARGET_MS})"
    )


def main() -> None:
    """Type in a file of so many rules, and take it back, some times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rules", type=int, default=500)
    parser.add_argument("--turns", type=int, default=5)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        (Path(folder) / "many.adirf").write_text(rule_file(options.rules))
        browser = playwright.chromium.launch(executable_path=chromium_path(), args=["--no-sandbox"])
        with served(Path(folder), os.environ) as url:
            page = browser.new_page(viewport={"width": 1440, "height": 900})
            measure(page, f"{url}#/rules/many.adirf", options.turns)
        browser.close()


if __name__ == "__main__":
    main()
