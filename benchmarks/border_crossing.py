# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a step costs when a robot crosses one border, among 100 × 100 zones against among 10.

Run it with ``python benchmarks/border_crossing.py``. Both rule sets are stepped in turns in one process, and
the medians of the turns are compared.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable, Iterator

from live.zone_rules import in_zone, knowledge_of, odometry_at
from smarttestudo.domain.profile import TopicProfile
from smarttestudo.loop import step

CROSSINGS = 2000
STEP_NS = 50_000_000
AIM = 2.0


def column_of_zones(x: int, rows: int, *, with_else: bool) -> str:
    """A rule file with a block for each square metre of one column of a grid."""
    blocks = [
        f"If {in_zone(x, y)} Then SetFrequency /scan {1 + (7 * x + 3 * y) % 20} "
        + ("Else SetFrequency /imu 5 " if with_else else "")
        + "EndIf"
        for y in range(rows)
    ]
    return "\n".join(["begin", "SetFrequency /scan 1", *blocks, "end"])


def walk(columns: int, rows: int) -> Iterator[tuple[float, float]]:
    """The middle of zones along a snake through the grid and back: one border is crossed at each step."""
    path = [
        (x + 0.5, y + 0.5)
        for y in range(rows)
        for x in (range(columns) if y % 2 == 0 else reversed(range(columns)))
    ]
    while True:
        yield from path
        yield from path[-2:0:-1]


def stepper(columns: int, rows: int, *, with_else: bool) -> Callable[[], float]:
    """A function that crosses ``CROSSINGS`` borders and returns the microseconds of one step."""
    texts = (column_of_zones(x, rows, with_else=with_else) for x in range(columns))
    knowledge = knowledge_of(texts, TopicProfile(type_name="nav_msgs/msg/Odometry"))
    positions = walk(columns, rows)
    now_ns = 0

    def run() -> float:
        nonlocal now_ns
        arrivals = [odometry_at(*next(positions)) for _ in range(CROSSINGS)]
        start = time.perf_counter()
        decisions = 0
        for arrival in arrivals:
            now_ns += STEP_NS
            decisions += len(step(knowledge, (arrival,), now_ns).decisions)
        took = time.perf_counter() - start
        if decisions < CROSSINGS:
            raise AssertionError(f"{CROSSINGS} borders crossed, but only {decisions} decisions")
        return took / CROSSINGS * 1e6

    return run


def compare(side: int, turns: int, *, with_else: bool) -> None:
    """Measure both sizes in turns, and print the ratio of the medians."""
    few = stepper(10, 1, with_else=with_else)
    many = stepper(side, side, with_else=with_else)
    few(), many()
    taken = [(few(), many()) for _ in range(turns)]
    few_us, many_us = (statistics.median(column) for column in zip(*taken, strict=True))
    kind = "If … Else" if with_else else "If"
    print(
        f"{kind:9}  10 zones {few_us:6.1f} µs, {side * side} zones {many_us:6.1f} µs a step: "
        f"{many_us / few_us:.2f} times (aim: at most {AIM:g})"
    )


def main() -> None:
    """Compare without and with Else."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--side", type=int, default=100, help="as many columns and rows of zones")
    parser.add_argument("--turns", type=int, default=15)
    arguments = parser.parse_args()
    for with_else in (False, True):
        compare(arguments.side, arguments.turns, with_else=with_else)


if __name__ == "__main__":
    main()
