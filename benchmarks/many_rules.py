# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a live relay costs with 10 000 rules beside one with a single rule, and what reloading them costs.

Run it with ``python benchmarks/many_rules.py`` where ROS 2 is installed; it takes some minutes. The rules are
zones of a grid that read the position of an odometry at 23 Hz. Two runtimes hear the same sources at the same
time, and their windows are the same. An Imu at 100 Hz is relayed in Full through both while many rules are
reloaded again and again; what each loses of it is counted, so that what a busy machine loses is known.
``--watched`` has a subscriber of both statuses.
"""

from __future__ import annotations

import argparse
import shlex
import statistics
import sys
import tempfile
import time
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from live.cases import IMU_BYTES, IMU_TYPE, Topic
from live.contenders import TESTUDO, role
from live.processes import Process, cpu_us_a_message, environment, p99, processes
from live.zone_rules import in_zone

DOMAIN = 87
START_TIMEOUT_S = 120.0
RELOAD_TIMEOUT_S = 120.0
SETTLE_S = 5.0
DRAIN_S = 1.0
ODOM = Topic(name="/odom", type="nav_msgs/msg/Odometry", hz=23, target_hz=23, size_bytes=720)
IMU = Topic(name="/imu", type=IMU_TYPE, hz=100, target_hz=100, size_bytes=IMU_BYTES)
AIMS = {"CPU a message": 1.2, "p99": 1.3, "memory": 1.5}


def zones(count: int, turn: int) -> str:
    """A rule file with ``count`` zones of a square metre each; another ``turn`` asks for other rates."""
    side = max(int(count**0.5), 1)
    blocks = [
        f"If {in_zone(x, y)} Then SetFrequency /scan {1 + (7 * x + 3 * y + turn) % 20} EndIf"
        for x, y in (divmod(number, side) for number in range(count))
    ]
    return "\n".join(["begin", "SetFrequency /odom Full", "SetFrequency /imu Full", *blocks, "end", ""])


@dataclass(frozen=True, kw_only=True)
class Relay:
    """A runtime with ``count`` rules in ``rules``; its operator hears what it relays of each topic."""

    count: int
    rules: Path
    log: Path
    process: Process
    odom: Process
    imu: Process

    def reloads(self) -> int:
        """How often its rules were reloaded so far."""
        return self.log.read_text(encoding="utf-8").count("rules reloaded")

    def reload(self, turn: int) -> float:
        """Write other rules, and wait until they are in force: how long that took, in s."""
        before, start_s = self.reloads(), time.monotonic()
        self.rules.write_text(zones(self.count, turn), encoding="utf-8")
        while self.reloads() == before:
            if time.monotonic() - start_s > RELOAD_TIMEOUT_S:
                sys.exit(f"{self.count} rules: not reloaded within {RELOAD_TIMEOUT_S:g} s")
            time.sleep(0.05)
        return time.monotonic() - start_s


def start(count: int, folder: Path, settings: dict[str, str], opened: ExitStack, *, watched: bool) -> Relay:
    """A runtime that relays, and its operators; prints how long it took to begin."""
    name = f"rules_{count}"
    rules, log = folder / f"{name}.adirf", folder / f"{name}.log"
    rules.write_text(zones(count, 0), encoding="utf-8")
    arguments = ["run", "--rules", str(rules), "--output-topic", f"/{name}{{topic}}"]
    node = ["--ros-args", "-r", f"__node:={name}", "-r", f"/testudo/status:=/{name}/status"]
    command = shlex.join([sys.executable, "-c", TESTUDO, *arguments, *node])
    heard = [[replace(topic, name=f"/{name}{topic.name}")] for topic in (ODOM, IMU)]
    operators = opened.enter_context(processes([role("hearer", topics) for topics in heard], settings))
    if watched:
        status = Topic(name=f"/{name}/status", type="std_msgs/msg/String", hz=1, target_hz=1, size_bytes=0)
        opened.enter_context(processes([role("hearer", [status])], settings))
    start_s = time.monotonic()
    (process,) = opened.enter_context(
        processes([["sh", "-c", f"exec {command} 2>{shlex.quote(str(log))}"]], settings)
    )
    while not operators[0].ask("ages"):
        if time.monotonic() - start_s > START_TIMEOUT_S:
            sys.exit(f"{count} rules: nothing is relayed within {START_TIMEOUT_S:g} s")
        time.sleep(0.05)
    print(f"{count:6} rules: the first message after {time.monotonic() - start_s:.1f} s", flush=True)
    return Relay(count=count, rules=rules, log=log, process=process, odom=operators[0], imu=operators[1])


def window(relays: list[Relay], source: Process, seconds: float) -> list[dict[str, float]]:
    """What each relay cost a message in the same window of the same source."""
    for relay in relays:
        relay.odom.ask("forget")
    costs_us = cpu_us_a_message(source, [relay.process for relay in relays], seconds)
    readings = []
    for relay, cost_us in zip(relays, costs_us, strict=True):
        ages_us = relay.odom.ask("ages")
        readings.append(
            {
                "CPU a message": cost_us,
                "p99": p99(ages_us),
                "memory": relay.process.resident_mb,
                "Hz": len(ages_us) / seconds,
            }
        )
    return readings


def compare(relays: list[Relay], source: Process, seconds: float, windows: int) -> None:
    """Print what both cost, and the ratios of their medians."""
    rows = [window(relays, source, seconds) for _ in range(windows)]
    units = {"CPU a message": "µs", "p99": "µs", "memory": "MB", "Hz": ""}
    for name, unit in units.items():
        few, many = (statistics.median(row[place][name] for row in rows) for place in (0, 1))
        aim = f" (aim: at most {AIMS[name]:g})" if name in AIMS else ""
        print(f"{name:14} {few:9.1f} {many:9.1f} {unit}: {many / few:.2f} times{aim}", flush=True)


def count_losses(relays: list[Relay], source: Process, reloads: int) -> None:
    """Print how many messages of the Imu each relay loses while the one with many rules reloads them."""
    source.ask("pause")
    time.sleep(DRAIN_S)
    for relay in relays:
        relay.imu.ask("forget")
    sent = source.ask("sent")
    source.ask("resume")
    took_s = [relays[-1].reload(turn) for turn in range(1, reloads + 1)]
    source.ask("pause")
    time.sleep(DRAIN_S)
    sent = source.ask("sent") - sent
    print(f"{reloads} reloads of {relays[-1].count} rules, {statistics.median(took_s):.1f} s each:")
    for relay in relays:
        ages_us = sorted(relay.imu.ask("ages"))
        print(
            f"{relay.count:6} rules: {sent - len(ages_us)} of {sent} messages lost, p99 "
            f"{p99(ages_us) / 1000:.1f} ms, the oldest {ages_us[-1] / 1000:.1f} ms, "
            f"{relay.process.resident_mb:.0f} MB afterwards",
            flush=True,
        )


def main() -> None:
    """Measure."""
    parser = argparse.ArgumentParser(description="What a live relay costs with many rules.")
    parser.add_argument("--rules", type=int, default=10_000)
    parser.add_argument("--seconds", type=float, default=10.0, help="length of each window")
    parser.add_argument("--windows", type=int, default=3)
    parser.add_argument("--reloads", type=int, default=50)
    parser.add_argument("--domain", type=int, default=DOMAIN, help="a ROS domain that nobody uses")
    parser.add_argument("--watched", action="store_true", help="have somebody subscribe to both statuses")
    arguments = parser.parse_args()
    settings = environment(arguments.domain, large_messages=False)
    with tempfile.TemporaryDirectory() as folder, ExitStack() as opened:
        odom, imu = opened.enter_context(processes([role("source", [ODOM]), role("source", [IMU])], settings))
        relays = [
            start(count, Path(folder), settings, opened, watched=arguments.watched)
            for count in (1, arguments.rules)
        ]
        imu.ask("pause")
        time.sleep(SETTLE_S)
        compare(relays, odom, arguments.seconds, arguments.windows)
        imu.ask("resume")
        time.sleep(SETTLE_S)
        if arguments.reloads:
            count_losses(relays, imu, arguments.reloads)


if __name__ == "__main__":
    main()
