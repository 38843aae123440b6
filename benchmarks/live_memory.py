# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the memory of ``testudo run`` stays flat.

Run it with ``python benchmarks/live_memory.py`` where ROS 2 is installed; it takes half an hour. The demo's
robot patrols, an operator hears every relay, and the rules change once a minute. Resident memory is read
every ten seconds; its growth is the slope of a straight line through the readings after the first minutes.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from importlib.resources import files
from pathlib import Path

from live.cases import TURTLEBOT3
from live.contenders import role
from live.processes import Process, environment, growth_mb_an_hour, processes

DOMAIN = 72
SAMPLE_S = 10.0
RELOAD_S = 60.0
WARM_S = 120.0


def measure(seconds: float, domain: int) -> list[tuple[float, float]]:
    """Readings of the runtime's resident memory: seconds since the start, MB."""
    with tempfile.TemporaryDirectory() as folder:
        rules = Path(folder) / "warehouse.adirf"
        text = files("smarttestudo.simulation").joinpath("warehouse.adirf").read_text("utf-8")
        rules.write_text(text, "utf-8")
        commands = [
            [sys.executable, "-m", "smarttestudo", "run", "--rules", str(rules)],
            [sys.executable, "-m", "smarttestudo", "simulate"],
            role("operator", [topic for topic in TURTLEBOT3 if topic.name != "/cmd_vel"]),
        ]
        with processes(commands, environment(domain, large_messages=False)) as (runtime, *_):
            return readings(runtime, rules, text, seconds)


def readings(runtime: Process, rules: Path, text: str, seconds: float) -> list[tuple[float, float]]:
    """One reading every ten seconds, and other rules once a minute."""
    started_s, read, reloads = time.monotonic(), [], 0
    while (elapsed_s := time.monotonic() - started_s) < seconds:
        read.append((elapsed_s, runtime.resident_mb))
        if elapsed_s // RELOAD_S > reloads:
            reloads += 1
            rules.write_text(f"{text}// reload {reloads}\n", "utf-8")
        time.sleep(SAMPLE_S)
    return read


def main() -> None:
    """Measure, and print a reading a minute."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", type=float, default=1800.0)
    parser.add_argument("--domain", type=int, default=DOMAIN)
    arguments = parser.parse_args()
    read = measure(arguments.seconds, arguments.domain)
    for elapsed_s, resident_mb in read[:: round(RELOAD_S / SAMPLE_S)]:
        print(f"{elapsed_s / 60:5.1f} min  {resident_mb:6.1f} MB")
    warm = [reading for reading in read if reading[0] >= WARM_S]
    if len(warm) > 1:
        print(f"growth after {WARM_S / 60:.0f} min: {growth_mb_an_hour(warm):+.2f} MB an hour")


if __name__ == "__main__":
    main()
