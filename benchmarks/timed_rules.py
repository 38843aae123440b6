# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a step costs when a robot crosses one border, among 10 000 rules with For and Within against among 10.

Run it with ``python benchmarks/timed_rules.py``. Each crossing is a step, and so is each alarm that it sets:
the zone that the robot entered has held for 200 ms then, or it left another one 300 ms ago. Both rule sets
are stepped in turns in one process, and the medians of the turns are compared.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

from live.zone_rules import in_zone, knowledge_of, odometry_at
from smarttestudo.domain.profile import TopicProfile
from smarttestudo.loop import step

CROSSINGS = 1000
PERIOD_NS = 500_000_000
AIM = 2.0


def row_of_zones(y: int, columns: int) -> str:
    """A rule file with a block for each square metre of one row of a grid."""
    blocks = [
        f"If {in_zone(x, y)} {'For 200 ms' if x % 2 else 'Within 300 ms'} "
        f"Then SetFrequency /scan {1 + (7 * x + 3 * y) % 20} EndIf"
        for x in range(columns)
    ]
    return "\n".join(["begin", "SetFrequency /scan 1", *blocks, "end"])


def stepper(columns: int, rows: int) -> Callable[[], tuple[float, int]]:
    """A function that crosses ``CROSSINGS`` borders; returns the microseconds and the number of its steps."""
    odometry = TopicProfile(type_name="nav_msgs/msg/Odometry", stale_after_s=3600.0)
    knowledge = knowledge_of((row_of_zones(y, columns) for y in range(rows)), odometry)
    place = now_ns = 0

    def run() -> tuple[float, int]:
        nonlocal now_ns, place
        arrivals = []
        for _ in range(CROSSINGS):
            place += 1
            there = place % (2 * columns - 2)
            arrivals.append(odometry_at(min(there, 2 * columns - 2 - there) + 0.5, 0.5))
        steps = decisions = 0
        start = time.perf_counter()
        for arrival in arrivals:
            now_ns += PERIOD_NS
            result = step(knowledge, (arrival,), now_ns)
            steps, decisions = steps + 1, decisions + len(result.decisions)
            until_ns = now_ns + PERIOD_NS
            while result.next_wake_ns is not None and result.next_wake_ns < until_ns:
                result = step(knowledge, (), result.next_wake_ns)
                steps, decisions = steps + 1, decisions + len(result.decisions)
        took = time.perf_counter() - start
        if decisions < CROSSINGS:
            raise AssertionError(f"{CROSSINGS} borders crossed, but only {decisions} decisions")
        return took / steps * 1e6, steps

    return run


def main() -> None:
    """Measure both sizes in turns, and print the ratio of the medians."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--side", type=int, default=100, help="as many columns and rows of zones")
    parser.add_argument("--turns", type=int, default=9)
    arguments = parser.parse_args()
    few, many = stepper(10, 1), stepper(arguments.side, arguments.side)
    few(), many()
    turns = [(few(), many()) for _ in range(arguments.turns)]
    few_us = statistics.median(one for (one, _), _ in turns)
    many_us = statistics.median(one for _, (one, _) in turns)
    print(
        f"10 rules {few_us:6.1f} µs, {arguments.side**2} rules {many_us:6.1f} µs a step "
        f"({turns[0][0][1] / CROSSINGS:.1f} and {turns[0][1][1] / CROSSINGS:.1f} steps a crossing): "
        f"{many_us / few_us:.2f} times (aim: at most {AIM:g})"
    )


if __name__ == "__main__":
    main()
