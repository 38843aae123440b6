# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a message costs by each data path, beside a relay of 40 lines of C, all at once in one station.

Run it with ``python benchmarks/relay_paths.py`` where ROS 2 and a C compiler are installed; it takes eight
minutes. All relays hear the same sources at the same time, so that a busy machine is one for all of them,
and the ratios hold. CPU is that of a relay's process for each message that the sources sent, and of that what
its first thread took: ours has Python, which also looks at the graph and tells statuses. The age is that of
relayed messages at arrival, in µs.
"""

from __future__ import annotations

import argparse
import json
import math
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from live.cases import TURTLEBOT3, Topic, imu, imus
from live.contenders import ROLES, smarttestudo
from live.processes import cpu_us_a_message, environment, p99, processes

DOMAIN = 72
SETTLE_S = 6.0
HEARD = 10
C_SOURCE = Path(__file__).parent / "live" / "c_relay.c"
PATHS = ("fast", "librcl")
C_RELAY = "c_relay"


CASES = {
    "Imu 200 → Full": imu(200, math.inf),
    "Imu 200 → 50 Hz": imu(200, 50),
    "Imu 1000 → 100 Hz": imu(1000, 100),
    "eight topics": [topic for topic in TURTLEBOT3 if topic.size_bytes < 1_000_000],
    "50 topics, 20 → 10 Hz": imus(50, 20, 10),
    "50 topics, 20 Hz → Full": imus(50, 20, math.inf),
    "200 topics, 5 → 2 Hz": imus(200, 5, 2),
    "200 topics, 5 Hz → Full": imus(200, 5, math.inf),
}


def role(name: str, topics: Sequence[Topic], prefix: str) -> list[str]:
    """The command of a role of ``roles.py`` that has topics behind ``prefix``."""
    described = [{**topic.to_json(), "prefix": f"/{prefix}"} for topic in topics]
    return [sys.executable, str(ROLES), name, json.dumps(described)]


def commands(topics: Sequence[Topic], folder: Path) -> dict[str, list[str]]:
    """The relays, by name."""
    found = {}
    for path in PATHS:
        options = ("--data-path", path, "--output-topic", f"/{path}{{topic}}")
        (command,) = smarttestudo(*options, "--ros-args", "-r", f"__node:={path}")(topics, folder)
        found[path] = command
    return {**found, C_RELAY: role(C_RELAY, topics, C_RELAY)}


def measure(topics: Sequence[Topic], seconds: float, windows: int, domain: int, folder: Path) -> None:
    """Print a row for each relay, over some windows of so many ``seconds``."""
    settings = {**environment(domain, large_messages=False), "C_RELAY": str(folder / "c_relay.so")}
    relays = commands(topics, folder)
    around = [role("operator", topics, name) for name in relays]
    with (
        processes([role("source", topics, "none"), *around], settings) as (source, *operators),
        processes(list(relays.values()), settings) as started,
    ):
        while not all(len(operator.ask("ages")) > HEARD for operator in operators):
            time.sleep(0.5)
        time.sleep(SETTLE_S)
        costs_us: dict[str, list[float]] = {name: [] for name in relays}
        for operator in operators:
            operator.ask("forget")
        sent, first_threads_s = source.ask("sent"), [relay.main_thread_cpu_s for relay in started]
        for _ in range(windows):
            for name, cost_us in zip(relays, cpu_us_a_message(source, started, seconds), strict=True):
                costs_us[name].append(cost_us)
        sent = source.ask("sent") - sent
        for name, operator, process, since_s in zip(relays, operators, started, first_threads_s, strict=True):
            ages_us = sorted(operator.ask("ages"))
            ratio = statistics.median(
                own / theirs for own, theirs in zip(costs_us[name], costs_us[C_RELAY], strict=True)
            )
            cells = [
                f"{statistics.median(costs_us[name]):.1f}",
                f"{(process.main_thread_cpu_s - since_s) * 1e6 / sent:.1f}",
                f"{ratio:.2f}",
                f"{100 * len(ages_us) / sent:.1f}",
                f"{ages_us[len(ages_us) // 2]:.0f}",
                f"{p99(ages_us):.0f}",
                f"{process.resident_mb:.0f}",
            ]
            print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


def main() -> None:
    """Measure all cases, or those whose name holds a text."""
    parser = argparse.ArgumentParser(description="What a message costs by each data path.")
    parser.add_argument("--case", default="", help="only cases whose name holds this text")
    parser.add_argument("--seconds", type=float, default=10.0, help="length of each window")
    parser.add_argument("--windows", type=int, default=5, help="windows of each case")
    parser.add_argument("--domain", type=int, default=DOMAIN, help="a ROS domain that nobody uses")
    arguments = parser.parse_args()
    compiler = shutil.which("cc")
    if compiler is None:
        sys.exit("error: there is no C compiler")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        flags = ["-std=c11", "-O2", "-shared", "-fPIC"]
        subprocess.run([compiler, *flags, str(C_SOURCE), "-o", str(folder / "c_relay.so")], check=True)
        for case, topics in CASES.items():
            if arguments.case in case:
                print(f"\n| {case} | CPU µs | first thread | to C | relayed of 100 | age p50 | p99 | MB |")
                print("| --- |" + " ---: |" * 7)
                measure(topics, arguments.seconds, arguments.windows, arguments.domain, folder)


if __name__ == "__main__":
    main()
