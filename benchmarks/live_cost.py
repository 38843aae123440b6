# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a relay costs: CPU, added latency, memory and DDS endpoints, SmartTestudo beside two rivals.

Run it with ``python benchmarks/live_cost.py`` where ROS 2 is installed; it takes ten minutes. The rivals: (a)
a plain rclpy relay of raw messages with the usual gate (``live/roles.py``), (b) topic_tools throttle, one
process for each topic, where that is installed. Of each process only a window of steady traffic counts.

CPU is that of the relay's processes for each message that the sources sent. The added latency is the age of
relayed messages of at most 64 KB (if a case has any) at the operator's, less the median age of messages of
the same size that come directly. The sources' CPU is what a message costs them with the relay, less what it
costs them without. Where a case has images, all processes use the Fast DDS profile for large messages.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from live.cases import CASES, Topic
from live.contenders import CONTENDERS, Contender, role
from live.processes import Process, cpu_us_a_message, environment, p99, processes

DOMAIN = 71
SETTLE_S = 4.0
TIMEOUT_S = 30.0
DIRECT_SMALL_HZ = 50.0
DIRECT_LARGE_HZ = 5.0
LARGE_BYTES = 1_000_000
COLUMNS = (
    "CPU µs per received message",
    "added latency µs, p50",
    "p99",
    "resident MB",
    "readers + writers",
    "sources' CPU µs per message",
)


@dataclass(frozen=True, kw_only=True)
class Cost:
    """What one contender cost in one case; ``added_us`` are the median and the 99th percentile."""

    cpu_us: float
    added_us: tuple[float, float]
    resident_mb: float
    endpoints: tuple[int, int]
    source_cpu_us: float


@dataclass(frozen=True, kw_only=True)
class Station:
    """What stands around a relay: the sources, and who hears relayed and direct messages."""

    source: Process
    operator: Process
    direct: Process


def measure(contender: Contender, topics: Sequence[Topic], seconds: float, domain: int) -> Cost | None:
    """The cost of a contender; ``None`` where it is not installed or relays nothing."""
    fastest = max(topics, key=lambda topic: topic.hz)
    direct_hz = DIRECT_LARGE_HZ if fastest.size_bytes >= LARGE_BYTES else DIRECT_SMALL_HZ
    direct = Topic(
        name="/direct", type=fastest.type, hz=direct_hz, target_hz=direct_hz, size_bytes=fastest.size_bytes
    )
    around = [
        role("source", topics),
        role("operator", topics),
        role("operator", [direct]),
        role("source", [direct]),
    ]
    has_large = any(topic.size_bytes >= LARGE_BYTES for topic in topics)
    settings = environment(domain, large_messages=has_large)
    with tempfile.TemporaryDirectory() as folder, processes(around, settings) as started:
        commands = contender.commands(topics, Path(folder))
        if not commands:
            return None
        station = Station(source=started[0], operator=started[1], direct=started[2])
        time.sleep(SETTLE_S)
        (alone_us,) = cpu_us_a_message(station.source, [station.source], seconds)
        with processes(commands, settings) as relays:
            if not hears(station.operator, topics):
                return None
            time.sleep(SETTLE_S)
            return cost(station, relays, contender, seconds, alone_us)


def hears(operator: Process, topics: Sequence[Topic]) -> bool:
    """Whether relayed messages arrive, about as many as in a second."""
    end_s = time.monotonic() + TIMEOUT_S
    enough = max(min(topic.target_hz, topic.hz) for topic in topics)
    while len(operator.ask("ages")) < enough:
        if time.monotonic() > end_s:
            return False
        time.sleep(0.2)
    return True


def cost(
    station: Station, relays: Sequence[Process], contender: Contender, seconds: float, alone_us: float
) -> Cost:
    """What the relay costs in a window of ``seconds``; a message alone costs the sources ``alone_us``."""
    station.operator.ask("forget")
    station.direct.ask("forget")
    with_relay_us, *relays_us = cpu_us_a_message(station.source, [station.source, *relays], seconds)
    ages_us = station.operator.ask("ages")
    direct_us = statistics.median(station.direct.ask("ages"))
    readers, writers = station.operator.ask(f"endpoints {contender.node}")
    return Cost(
        cpu_us=sum(relays_us),
        added_us=(statistics.median(ages_us) - direct_us, p99(ages_us) - direct_us),
        resident_mb=sum(relay.resident_mb for relay in relays),
        endpoints=(readers * len(relays), writers * len(relays)),
        source_cpu_us=with_relay_us - alone_us,
    )


def line(name: str, result: Cost | None) -> str:
    """A row of the table."""
    if result is None:
        return f"| {name} | not run |" + " |" * (len(COLUMNS) - 1)
    median_us, worst_us = result.added_us
    cells = [
        f"{result.cpu_us:.0f}",
        f"{median_us:.0f}",
        f"{worst_us:.0f}",
        f"{result.resident_mb:.0f}",
        "{} + {}".format(*result.endpoints),
        f"{result.source_cpu_us:.0f}",
    ]
    return f"| {name} | " + " | ".join(cells) + " |"


def main() -> None:
    """Measure all cases, or those whose name holds a text."""
    parser = argparse.ArgumentParser(description="What a relay costs.")
    parser.add_argument("--case", default="", help="only cases whose name holds this text")
    parser.add_argument("--seconds", type=float, default=10.0, help="length of each window")
    parser.add_argument("--domain", type=int, default=DOMAIN, help="a ROS domain that nobody uses")
    arguments = parser.parse_args()
    for case, topics in CASES.items():
        if arguments.case not in case:
            continue
        print(f"\n| {case} | " + " | ".join(COLUMNS) + " |")
        print("| --- |" + " ---: |" * len(COLUMNS))
        for contender in CONTENDERS:
            result = measure(contender, topics, arguments.seconds, arguments.domain)
            print(line(contender.name, result), flush=True)


if __name__ == "__main__":
    main()
