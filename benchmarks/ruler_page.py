# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the memory of the Ruler's page stays flat beside a running robot.

Run it with ``python benchmarks/ruler_page.py`` where ROS 2 and Chromium are installed; it takes ten minutes.
A source publishes fifty topics, ``testudo run`` relays them, and the page shows the tab Robot with twenty
updates a second. The heap is read after a collection, which does not reach what is under way; its growth is
the slope of a straight line through the smallest reading of each minute after the first.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import CDPSession, Page, sync_playwright

from live.cases import imus
from live.contenders import role
from live.processes import environment, growth_mb_an_hour, processes
from live.ruler_server import chromium_path, served

DOMAIN = 75
TOPIC_COUNT = 50
SAMPLE_S = 10.0
MINUTE_S = 60.0
TOPICS = imus(TOPIC_COUNT, 20, 5)
RULE = 'Rule "Fast" If (CheckValue /imu0 rate > 10) Then SetFrequency /imu1 7 EndIf'
Reading = tuple[float, float, int]


def show_robot(page: Page, url: str) -> None:
    """Open the rules, and the robot with as many updates as there can be."""
    page.goto(url)
    places = page.get_by_role("navigation", name="Places")
    places.get_by_role("link", name="Robots").click()
    page.get_by_role("link", name="/smarttestudo").click()
    page.get_by_text("Details", exact=True).click()
    page.get_by_label("Updates (1/s)").select_option("20")
    places.get_by_role("link", name="Rules").click()
    page.get_by_role("link", name="rules.adirf").click()
    page.get_by_role("button", name="Robot", exact=True).click()
    page.get_by_role("row").nth(TOPIC_COUNT).wait_for()


def heap_mb(session: CDPSession) -> float:
    """The page's JavaScript heap after a collection."""
    session.send("HeapProfiler.collectGarbage")
    metrics = session.send("Performance.getMetrics")["metrics"]
    return float(next(one["value"] for one in metrics if one["name"] == "JSHeapUsedSize")) / 1e6


def readings(page: Page, frames: list[None], seconds: float) -> list[Reading]:
    """Seconds since the start, MB of heap, messages that the page got so far; every ten seconds."""
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable")
    read = [(0.0, heap_mb(session), len(frames))]
    for number in range(1, int(seconds / SAMPLE_S) + 1):
        page.wait_for_timeout(1000 * SAMPLE_S)
        read.append((number * SAMPLE_S, heap_mb(session), len(frames)))
    return read


def measure(seconds: float, domain: int) -> list[Reading]:
    """Everything as processes of their own, and what the page's heap did."""
    settings = environment(domain, large_messages=False)
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        rules = Path(name) / "rules.adirf"
        rates = [f"SetFrequency {topic.name} {topic.target_hz}" for topic in TOPICS]
        rules.write_text("\n".join(["begin", *rates, RULE, "end"]), encoding="utf-8")
        run = [sys.executable, "-m", "smarttestudo", "run", "--rules", str(rules)]
        commands = [run, role("source", TOPICS), role("operator", TOPICS)]
        with processes(commands, settings), served(rules.parent, settings) as url:
            browser = playwright.chromium.launch(executable_path=chromium_path(), args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1280, "height": 2400})
            frames: list[None] = []
            page.on("websocket", lambda socket: socket.on("framereceived", lambda _: frames.append(None)))
            show_robot(page, url)
            read = readings(page, frames, seconds)
            browser.close()
            return read


def main() -> None:
    """Measure, and print the readings."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--domain", type=int, default=DOMAIN)
    arguments = parser.parse_args()
    read = measure(arguments.seconds, arguments.domain)
    for elapsed_s, used_mb, frames in read:
        print(f"{elapsed_s:5.0f} s  {used_mb:6.2f} MB  {frames} messages")
    print(f"{read[-1][2] / read[-1][0]:.1f} messages a second" if read[-1][0] else "")
    lowest: dict[int, float] = {}
    for elapsed_s, used_mb, _ in read:
        minute = int(elapsed_s // MINUTE_S)
        lowest[minute] = min(used_mb, lowest.get(minute, used_mb))
    warm = {minute: used_mb for minute, used_mb in lowest.items() if minute > 0}
    print("smallest of each minute:", ", ".join(f"{used_mb:.1f} MB" for used_mb in lowest.values()))
    if len(warm) > 1:
        growth = growth_mb_an_hour([(MINUTE_S * minute, used_mb) for minute, used_mb in warm.items()])
        print(f"growth after the first: {growth:+.2f} MB an hour")


if __name__ == "__main__":
    main()
