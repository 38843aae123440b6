# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the memory of ``testudo ruler`` stays flat while pages watch a robot.

Run it with ``python benchmarks/ruler_live.py --minutes 10`` where ROS 2 is installed. A robot publishes 50
topics, ``testudo run`` relays them by 50 rules, and three pages ask for 20 updates a second: one reads them,
one comes and goes, one never reads. Resident memory is read every five seconds; its growth is the slope of a
straight line through the readings after the first minute.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin

from live.cases import imus
from live.contenders import TESTUDO, role
from live.processes import Process, environment, growth_mb_an_hour, processes

DOMAIN = 74
TOPICS = 50
SOURCE_HZ = 10
UPDATE_HZ = 20
SAMPLE_S = 5.0
WARM_S = 60.0
STAY_S, SLEEP_S = 2.0, 60.0
WATCH = f'{{"kind": "watch", "node": "/smarttestudo", "update_hz": {UPDATE_HZ}}}'
LIVE = '{"kind":"live"'


@dataclass(kw_only=True)
class Pages:
    """Browsers' ends of the web socket at ``url``."""

    origin: str
    updates: int = 0
    characters: int = 0
    stopped: threading.Event = field(default_factory=threading.Event)

    @contextmanager
    def open(self) -> Iterator[ClientConnection]:
        """A page that watches the robot."""
        url = self.origin.replace("http", "ws") + "/ws"
        with connect(url, origin=Origin(self.origin), proxy=None, ping_interval=None) as page:
            page.send(WATCH)
            yield page

    def read(self) -> None:
        """Read all that comes, until it stops."""
        with self.open() as page:
            while not self.stopped.is_set():
                said = str(page.recv(timeout=60))
                self.updates += said.startswith(LIVE)
                self.characters = len(said) if said.startswith(LIVE) else self.characters

    def come_and_go(self) -> None:
        """Open a page every two seconds."""
        while not self.stopped.is_set():
            with self.open():
                self.stopped.wait(STAY_S)

    def sleep(self) -> None:
        """Open a page that reads nothing: its library's queue fills up, then TCP's buffers."""
        while not self.stopped.is_set():
            with self.open():
                self.stopped.wait(SLEEP_S)

    @contextmanager
    def watching(self) -> Iterator[None]:
        """All three, while the block lasts."""
        threads = [threading.Thread(target=act) for act in (self.read, self.come_and_go, self.sleep)]
        for thread in threads:
            thread.start()
        try:
            yield
        finally:
            self.stopped.set()
            for thread in threads:
                thread.join()


def rules_text() -> str:
    """A default and a rule of two checks for each topic."""
    lines = []
    for number in range(TOPICS):
        topic = f"/imu{number}"
        lines.append(f"SetFrequency {topic} 5")
        turns, comes = f"CheckValue {topic} angular_velocity.z > 1", f"CheckValue {topic} rate > 1"
        lines.append(f'Rule "Rule {number}" If ({turns} AND {comes}) Then SetFrequency {topic} 8 EndIf')
    return "\n".join(["begin", *lines, "end"])


def measure(minutes: float, domain: int) -> list[tuple[float, float]]:
    """Readings of the server's resident memory: seconds since the start, MB."""
    with tempfile.TemporaryDirectory() as folder:
        rules = Path(folder) / "rules.adirf"
        rules.write_text(rules_text(), "utf-8")
        testudo = [sys.executable, "-c", TESTUDO]
        commands = [
            [*testudo, "ruler", folder, "--port", "0", "--no-browser"],
            [*testudo, "run", "--rules", str(rules)],
            role("source", imus(TOPICS, SOURCE_HZ, 5)),
        ]
        with processes(commands, environment(domain, large_messages=False)) as (ruler, runtime, _):
            origin = ruler.line().partition(": ")[2].partition("/ ")[0]
            pages = Pages(origin=origin)
            with pages.watching():
                return readings(ruler, runtime, pages, minutes * 60)


def readings(ruler: Process, runtime: Process, pages: Pages, seconds: float) -> list[tuple[float, float]]:
    """A reading every five seconds, and a line a minute."""
    started_s, read, shown = time.monotonic(), [], 0
    before, at_s = (pages.updates, ruler.cpu_s, runtime.cpu_s), 0.0
    while (elapsed_s := time.monotonic() - started_s) < seconds:
        read.append((elapsed_s, ruler.resident_mb))
        if elapsed_s // 60 > shown:
            shown, now = int(elapsed_s // 60), (pages.updates, ruler.cpu_s, runtime.cpu_s)
            updates, ruler_cpu, runtime_cpu = (
                (b - a) / (elapsed_s - at_s) for a, b in zip(before, now, strict=True)
            )
            print(
                f"{elapsed_s / 60:5.1f} min  ruler {ruler.resident_mb:.1f} MB, {ruler_cpu:.1%} of a core, "
                f"run {runtime.resident_mb:.1f} MB, {runtime_cpu:.1%}; "
                f"{updates:.2f} updates/s of {pages.characters / 1000:.1f} KB",
                flush=True,
            )
            before, at_s = now, elapsed_s
        time.sleep(SAMPLE_S)
    return read


def main() -> None:
    """Measure, and say how memory grew."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--domain", type=int, default=DOMAIN)
    arguments = parser.parse_args()
    read = measure(arguments.minutes, arguments.domain)
    print(f"at the end {read[-1][1]:.1f} MB")
    warm = [reading for reading in read if reading[0] >= WARM_S]
    if len(warm) > 1:
        print(f"growth after {WARM_S:.0f} s: {growth_mb_an_hour(warm):+.2f} MB an hour")


if __name__ == "__main__":
    main()
