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
from types import SimpleNamespace

from smarttestudo.domain.observation import Arrival
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import compile_rules
from smarttestudo.loop import Knowledge, step

CROSSINGS = 2000
STEP_NS = 50_000_000
AIM = 2.0


def column_of_zones(x: int, rows: int, *, with_else: bool) -> str:
    """A rule file with a block for each square metre of one column of a grid."""
    blocks = [
        f"If (CheckValue /odom pose_x > {x} AND CheckValue /odom pose_x < {x + 1} AND "
        f"CheckValue /odom pose_y > {y} AND CheckValue /odom pose_y < {y + 1}) "
        f"Then SetFrequency /scan {1 + (7 * x + 3 * y) % 20} "
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
    files = [
        parse(column_of_zones(x, rows, with_else=with_else), f"column_{x}.adirf").file for x in range(columns)
    ]
    rule_set = compile_rules(files, lambda name: name)
    odometry = TopicProfile(type_name="nav_msgs/msg/Odometry")
    knowledge = Knowledge(rule_set, Profile(settle_s=0.0, topics={"/odom": odometry}), start_ns=0)
    positions = walk(columns, rows)
    now_ns = 0

    def run() -> float:
        nonlocal now_ns
        arrivals = [_odometry(*next(positions)) for _ in range(CROSSINGS)]
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


def _odometry(x: float, y: float) -> Arrival:
    position = SimpleNamespace(x=x, y=y, z=0.0)
    message = SimpleNamespace(pose=SimpleNamespace(pose=SimpleNamespace(position=position)))
    return Arrival(topic="/odom", size_bytes=720, message=message)


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
