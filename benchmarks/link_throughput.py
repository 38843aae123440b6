# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How much of what is offered arrives over a loopback that nothing limits, and what a MB takes of both ends.

SmartTestudo's two ends and plain Zenoh take turns in the same run. Payloads cannot be compressed. CPU is that
of both processes, the making and the noting of the messages included, for each MB that arrived.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import socket
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from statistics import median

from live.processes import Process, processes
from thin_link.roles import be_operator, be_robot
from thin_link.tables import spread
from thin_link.traffic import Topic

CONTENDERS = {"testudo": "SmartTestudo", "zenoh": "plain Zenoh"}
GRACE_S = 0.5
WARM_S = 2.0
KEPT_UP = 0.99
LEAST_ARRIVED = 0.95
MOST_CPU = 1.5
_HUNDRED_KB = Topic(name="/topic_0", size_bytes=100_000, hz=500, priority=1, zenoh_priority="DATA")


def _topics(count: int, size_bytes: int, hz: float) -> tuple[Topic, ...]:
    """Topics that are offered ``hz`` messages a second together."""
    one = replace(_HUNDRED_KB, size_bytes=size_bytes, hz=hz / count)
    return tuple(replace(one, name=f"/topic_{number}") for number in range(count))


CASES: Mapping[str, tuple[str, tuple[Topic, ...]]] = {
    "ten": ("10 MB/s: 100 KB at 100 Hz", _topics(1, 100_000, 100)),
    "fifty": ("50 MB/s: 100 KB at 500 Hz", _topics(1, 100_000, 500)),
    "fifty_of_ten": ("50 MB/s: ten topics of 100 KB at 50 Hz", _topics(10, 100_000, 500)),
    "hundred": ("100 MB/s: 100 KB at 1000 Hz", _topics(1, 100_000, 1_000)),
    "hundred_of_ten": ("100 MB/s: ten topics of 100 KB at 100 Hz", _topics(10, 100_000, 1_000)),
    "small": ("5 MB/s: 1 KB at 5000 Hz", _topics(1, 1_000, 5_000)),
    "small_of_ten": ("1 MB/s: ten topics of 1 KB at 100 Hz", _topics(10, 1_000, 1_000)),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Brought:
    """What arrived of what was published after the warm-up, and what was published of what was due.

    CPU of both ends is in ms for each MB that arrived.
    """

    share: float
    published: float
    robot_ms_per_mb: float
    operator_ms_per_mb: float

    @property
    def cpu_ms_per_mb(self) -> float:
        """That of both ends together."""
        return self.robot_ms_per_mb + self.operator_ms_per_mb


def measure(name: str, contender: str, seconds: float) -> Brought:
    """One run of one contender. Exits where its ends do not meet."""
    topics = CASES[name][1]
    endpoint = _free_endpoint()

    def role(which: str) -> list[str]:
        options = ["--only", name, "--seconds", str(seconds), "--endpoint", endpoint]
        return [sys.executable, __file__, "--be", which, contender, *options]

    with ExitStack() as opened:
        (operator,) = opened.enter_context(processes([role("operator")], dict(os.environ)))
        operator.line()
        (robot,) = opened.enter_context(processes([role("robot")], dict(os.environ)))
        if not robot.line():
            sys.exit("the two ends did not meet")
        start_ns = robot.ask("go")
        time.sleep(WARM_S)
        before = _cpu_s(robot, operator)
        warm_ns = time.monotonic_ns()
        told = json.loads(robot.line())
        time.sleep(GRACE_S)
        after = _cpu_s(robot, operator)
        arrived = [one for one in operator.ask("end") if one[2] >= warm_ns]
    warm_s = (warm_ns - start_ns) / 1e9
    # A message's time is when it was due.
    published = sum(
        count - math.ceil(warm_s * one.hz) for count, one in zip(told["published"], topics, strict=True)
    )
    arrived_mb = sum(size_bytes for *_, size_bytes in arrived) / 1e6
    robot_s, operator_s = (late - early for early, late in zip(before, after, strict=True))
    return Brought(
        share=len(arrived) / published,
        published=published / ((seconds - warm_s) * sum(topic.hz for topic in topics)),
        robot_ms_per_mb=robot_s * 1e3 / arrived_mb,
        operator_ms_per_mb=operator_s * 1e3 / arrived_mb,
    )


def _cpu_s(*ends: Process) -> list[float]:
    return [end.cpu_s for end in ends]


def _free_endpoint() -> str:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


def compare(names: Sequence[str], seconds: float, rounds: int) -> None:
    """The table of docs/contributors/benchmark-link.md: medians, and the least and the greatest."""
    print(f"Load of this machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors\n", flush=True)
    print(
        "| offered | arrived: SmartTestudo | plain Zenoh | CPU ms a MB: SmartTestudo | plain Zenoh | ratio |"
    )
    print("| --- | ---: | ---: | ---: | ---: | ---: |", flush=True)
    for name in names:
        turns = [{one: measure(name, one, seconds) for one in CONTENDERS} for _ in range(rounds)]
        ratios = [turn["testudo"].cpu_ms_per_mb / turn["zenoh"].cpu_ms_per_mb for turn in turns]
        cells = [CASES[name][0]]
        cells += [_shares([turn[one] for turn in turns]) for one in CONTENDERS]
        cells += [_cost([turn[one] for turn in turns]) for one in CONTENDERS]
        print(f"| {' | '.join(cells)} | {spread(ratios, '.2f')} |", flush=True)
    print(
        f"\nTargets: {LEAST_ARRIVED:.0%} arrive; at 10 MB/s at most {MOST_CPU} times the CPU of plain Zenoh."
    )


def _shares(runs: Sequence[Brought]) -> str:
    arrived = spread([one.share * 100 for one in runs], ".1f") + " %"
    published = median(one.published for one in runs)
    return arrived if published >= KEPT_UP else f"{arrived} of the {published:.0%} that the source published"


def _cost(runs: Sequence[Brought]) -> str:
    robot_ms, operator_ms = (
        median(getattr(one, end) for one in runs) for end in ("robot_ms_per_mb", "operator_ms_per_mb")
    )
    return f"{robot_ms:.2f} + {operator_ms:.2f}"


def main() -> None:
    """Compare, or be one of the processes of a comparison."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", choices=CASES, nargs="+", default=list(CASES), help="some cases")
    parser.add_argument("--seconds", type=float, default=8.0, help="a run (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=3, help="runs of each (default: %(default)s)")
    parser.add_argument("--be", nargs=2, help=argparse.SUPPRESS)
    parser.add_argument("--endpoint", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    match arguments.be:
        case None:
            compare(arguments.only, arguments.seconds, arguments.rounds)
        case ["robot", contender]:
            topics = CASES[arguments.only[0]][1]
            be_robot(contender, topics, arguments.seconds, arguments.endpoint)
        case ["operator", contender]:
            be_operator(contender, CASES[arguments.only[0]][1], arguments.endpoint)


if __name__ == "__main__":
    main()
