# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator sees over a thin link: SmartTestudo's two ends beside plain Zenoh and Fast DDS.

Run it as root with ``python benchmarks/link_ages.py``; it takes eighteen minutes. It makes two network
namespaces with a link between them (veth, token buckets with a queue of 400 ms at both ends) and removes
them. Zenoh publishes with its priorities, drops what does not fit its queues, and compresses where that
helps. Ages are those of messages that arrived after the first two seconds; the share of the link counts all
headers.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from typing import Any

from thin_link.cases import CASES, WARM_S, Arrival, Case, Seen, Target
from thin_link.ends import role
from thin_link.fleet import be_fleet, be_router, be_stuck
from thin_link.limits import LIMITS, TRAFFIC, measure_limit
from thin_link.network_namespaces import NetworkError, ThinLink, require_links, thin_link
from thin_link.roles import Topic, be_flow_sink, be_flow_source, be_operator, be_robot
from thin_link.tables import print_ages, print_limits, print_rates, print_targets

CONTENDERS = {"testudo": "SmartTestudo", "zenoh": "plain Zenoh", "fastdds": "Fast DDS"}
GRACE_S = 0.5
BITS_PER_MBIT = 1e6


def topics_of(traffic: str) -> Sequence[Topic]:
    """What the robot sends in the case of that name."""
    return CASES[traffic].topics if traffic in CASES else TRAFFIC[traffic]


def measure(case: Case, contender: str, seconds: float, link: ThinLink) -> Seen | None:
    """One run of one contender; ``None`` where its ends do not meet."""
    link.set_rate(case.steps[0][1] * BITS_PER_MBIT)
    name = next(name for name, one in CASES.items() if one is case)
    with ExitStack() as opened:
        operator = opened.enter_context(role(link.operator, "operator", contender, "--traffic", name))
        operator.line()
        sink = opened.enter_context(role(link.operator, "flow-sink")) if case.has_flow else None
        if sink is not None:
            sink.line()
        arguments = ("robot", contender, "--traffic", name, "--seconds", str(seconds))
        robot = opened.enter_context(role(link.robot, *arguments))
        if not robot.line():
            return None
        start_bytes = link.carried_bytes()
        start_ns = robot.ask("go")
        if case.has_flow:
            opened.enter_context(role(link.robot, "flow-source", "--seconds", str(seconds)))
        counters = run_link(case, seconds, start_ns, link)
        told = json.loads(robot.line())
        time.sleep(GRACE_S)
        carried_bytes = link.carried_bytes() - start_bytes
        arrived = operator.ask("end")
        flow = sink.ask("end") if sink is not None else None
    least_share = 0.9 * min(topic.noise for topic in case.topics)
    link.require_carried(least_share * sum(each[4] for each in arrived), start_bytes)
    span_bytes = counters[1] - counters[0]
    return Seen(
        arrived=by_topic(arrived, start_ns),
        seconds=seconds,
        used=span_bytes / case.capacity_bytes(WARM_S, seconds),
        cpu_s_per_mb=told["cpu_s"] / (carried_bytes / 1e6),
        flow_share=None if flow is None else flow_bytes(flow, start_ns, seconds) / span_bytes,
    )


def run_link(case: Case, seconds: float, start_ns: int, link: ThinLink) -> tuple[int, int]:
    """Change the link as the case says; what it had carried after the warm-up and at the end."""
    acts = [(at_s, rate) for at_s, rate in case.steps[1:] if at_s < seconds]
    counters = []
    for at_s, rate in sorted([*acts, (WARM_S, None), (seconds, None)], key=lambda act: act[0]):
        time.sleep(max(0.0, at_s - (time.monotonic_ns() - start_ns) / 1e9))
        if rate is None:
            counters.append(link.carried_bytes())
        elif rate == 0:
            link.cut()
        else:
            link.mend()
            link.set_rate(rate * BITS_PER_MBIT)
    return counters[0], counters[1]


def by_topic(arrived: Sequence[Sequence[Any]], start_ns: int) -> dict[str, list[Arrival]]:
    """The arrivals of each topic, in s from the start."""
    found: dict[str, list[Arrival]] = {}
    for topic, number, sent_ns, at_ns, _ in arrived:
        one = Arrival(number=number, sent_s=(sent_ns - start_ns) / 1e9, at_s=(at_ns - start_ns) / 1e9)
        found.setdefault(topic, []).append(one)
    return found


def flow_bytes(seen: Sequence[tuple[int, int]], start_ns: int, seconds: float) -> int:
    """What the TCP flow brought after the warm-up."""
    totals = [total for at_ns, total in seen if WARM_S <= (at_ns - start_ns) / 1e9 < seconds]
    return totals[-1] - totals[0] if totals else 0


def measured(case: Case, contender: str, seconds: float) -> Seen | None:
    """One run on a link of its own; ``None``, with a line that says why, where it showed nothing."""
    print(f"{case.title}: {CONTENDERS[contender]}", file=sys.stderr)
    try:
        with thin_link() as link:
            brought = measure(case, contender, seconds, link)
    except NetworkError as error:
        print(error, file=sys.stderr)
        return None
    if brought is None:
        print("its ends did not meet", file=sys.stderr)
    return brought


def compare(arguments: argparse.Namespace) -> None:
    """All cases, or one, and what came of them as the tables of docs/contributors/benchmark-link.md."""
    print(f"Load of this machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors", flush=True)
    chosen = [name for name in (*CASES, *LIMITS) if arguments.only in (None, name)]
    contenders = [arguments.contender] if arguments.contender else list(CONTENDERS)
    seen: dict[Case, dict[str, list[Seen]]] = {CASES[name]: {} for name in chosen if name in CASES}
    limits: dict[str, list[list[Target]]] = {name: [] for name in chosen if name in LIMITS}
    try:
        for _ in range(arguments.runs):
            run_once(arguments, contenders, seen, limits)
    finally:
        # Whatever ends it, an hour's figures are not lost.
        names = {one: CONTENDERS[one] for one in contenders}
        if seen:
            print_rates(seen, names)
            print_ages(seen, names)
            print_targets(seen, names)
        if limits:
            print_limits({LIMITS[name][0]: runs for name, runs in limits.items() if runs})


def run_once(
    arguments: argparse.Namespace,
    contenders: Sequence[str],
    seen: dict[Case, dict[str, list[Seen]]],
    limits: dict[str, list[list[Target]]],
) -> None:
    """Measure each case and limit once more."""
    for case, brought in seen.items():
        seconds = arguments.minutes * 60 if case.takes_minutes else case.seconds * arguments.longer
        for contender in contenders:
            one = measured(case, contender, seconds)
            if one is not None:
                brought.setdefault(contender, []).append(one)
    for name, runs in limits.items():
        runs.extend(measured_limit(name))


def measured_limit(name: str) -> list[list[Target]]:
    """One run, if it showed anything."""
    print(LIMITS[name][0], file=sys.stderr)
    try:
        return [measure_limit(name)]
    except NetworkError as error:
        print(error, file=sys.stderr)
        return []


def main() -> None:
    """Compare, or be one of the processes of a comparison."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", choices=[*CASES, *LIMITS], help="one case")
    parser.add_argument("--contender", choices=CONTENDERS, help="only this one")
    parser.add_argument("--runs", type=int, default=1, help="how often (default: %(default)s)")
    parser.add_argument("--minutes", type=float, default=1.0, help="of the overload (default: %(default)s)")
    parser.add_argument(
        "--longer", type=float, default=1.0, help="times as long, other cases (default: %(default)s)"
    )
    parser.add_argument("--be", nargs="+", help=argparse.SUPPRESS)
    parser.add_argument("--seconds", type=float, help=argparse.SUPPRESS)
    parser.add_argument("--traffic", choices=[*CASES, *TRAFFIC], help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    match arguments.be:
        case None:
            signal.signal(signal.SIGTERM, lambda _number, _frame: sys.exit(1))
            try:
                require_links()
                compare(arguments)
            except NetworkError as error:
                parser.exit(1, f"{error}\n")
        case ["robot", contender]:
            be_robot(contender, topics_of(arguments.traffic), arguments.seconds)
        case ["operator", contender]:
            be_operator(contender, topics_of(arguments.traffic))
        case ["fleet", count, endpoint]:
            be_fleet(int(count), endpoint)
        case ["router"]:
            be_router()
        case ["stuck"]:
            be_stuck()
        case ["flow-source"]:
            be_flow_source(arguments.seconds)
        case _:
            be_flow_sink()


if __name__ == "__main__":
    main()
