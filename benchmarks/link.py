# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator sees over a thin link: SmartTestudo's two ends beside plain Zenoh with the same traffic.

Run it as root with ``python benchmarks/link.py``; it takes nine minutes. It makes two network namespaces with
a link between them (veth, token buckets with a queue of 400 ms at both ends) and removes them at the end. The
rival publishes with Zenoh's priorities, drops what does not fit its queues, and compresses where that helps.
Ages are those of messages that arrived after the first two seconds; the share of the link counts all headers.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any

from live.processes import Process
from thin_link.cases import CASES, WARM_S, Arrival, Case, Seen, quantile
from thin_link.network import NetworkError, ThinLink, can_make_links, thin_link
from thin_link.roles import be_flow_sink, be_flow_source, be_operator, be_robot

CONTENDERS = {"testudo": "SmartTestudo", "zenoh": "plain Zenoh"}
GRACE_S = 0.5


@contextmanager
def role(namespace: str, *arguments: str) -> Iterator[Process]:
    """A process of one end, which is ended at the end."""
    command = ["ip", "netns", "exec", namespace, sys.executable, __file__, "--be", *arguments]
    process = Process(command, dict(os.environ))
    try:
        yield process
    finally:
        process.end()


def measure(name: str, case: Case, contender: str, seconds: float, link: ThinLink) -> Seen | None:
    """One run of one contender; ``None`` where its ends do not meet."""
    link.set_rate(case.steps[0][1])
    with ExitStack() as opened:
        operator = opened.enter_context(role(link.operator, "operator", contender, "--only", name))
        operator.line()
        sink = opened.enter_context(role(link.operator, "flow-sink")) if case.has_flow else None
        if sink is not None:
            sink.line()
        arguments = ("robot", contender, "--only", name, "--seconds", str(seconds))
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
    check_path(sum(each[4] for each in arrived), case, carried_bytes)
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
            link.set_rate(rate)
    return counters[0], counters[1]


def check_path(arrived_bytes: int, case: Case, carried_bytes: int) -> None:
    """Traffic of one machine finds other ways easily; then nothing was measured."""
    least_share = min(topic.noise for topic in case.topics)
    if carried_bytes < 0.9 * least_share * arrived_bytes:
        raise NetworkError(f"{arrived_bytes} bytes arrived, but the link carried only {carried_bytes}")


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


def print_case(case: Case, seen: dict[str, Seen | None]) -> None:
    """A table with a row for each topic, and the targets."""
    print(f"\n**{case.title}**\n")
    columns = "".join(f" {CONTENDERS[one]}: Hz | age p50 s | p95 | max |" for one in seen)
    print(f"| topic | offered Hz |{columns}")
    print("| --- | ---: |" + " ---: |" * (4 * len(seen)))
    for topic in case.topics:
        cells = []
        for one in seen.values():
            ages_s = one.ages_s([topic]) if one is not None else []
            if one is None or not ages_s:
                cells += ["0", "–", "–", "–"]
                continue
            hz = len(ages_s) / (one.seconds - max(WARM_S, topic.from_s))
            cells += [f"{hz:.2f}", *(f"{quantile(ages_s, share):.3f}" for share in (0.5, 0.95, 1.0))]
        print(f"| {topic.name} | {topic.hz:.3g} | " + " | ".join(cells) + " |")
    print()
    for contender, one in seen.items():
        if one is None:
            print(f"- {CONTENDERS[contender]}: its ends did not meet")
            continue
        facts = [f"link used {one.used:.0%}", f"{one.cpu_s_per_mb:.3f} s of CPU a MB sent"]
        print(
            f"- {CONTENDERS[contender]}: {', '.join(facts)}; " + "; ".join(map(str, case.judge(one))),
            flush=True,
        )


def compare(arguments: argparse.Namespace) -> None:
    """All cases, or one."""
    print(f"load of this machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
    for _ in range(arguments.runs):
        for name, case in CASES.items():
            if arguments.only not in (None, name):
                continue
            seconds = arguments.minutes * 60 if case.takes_minutes else case.seconds * arguments.longer
            contenders = [arguments.contender] if arguments.contender else list(CONTENDERS)
            seen = {}
            for contender in contenders:
                with thin_link() as link:
                    seen[contender] = measure(name, case, contender, seconds, link)
            print_case(case, seen)


def main() -> None:
    """Compare, or be one of the processes of a comparison."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", choices=CASES, help="one case")
    parser.add_argument("--contender", choices=CONTENDERS, help="only this one")
    parser.add_argument("--runs", type=int, default=1, help="how often (default: %(default)s)")
    parser.add_argument("--minutes", type=float, default=1.0, help="of the overload (default: %(default)s)")
    parser.add_argument(
        "--longer", type=float, default=1.0, help="times as long, other cases (default: %(default)s)"
    )
    parser.add_argument("--be", nargs="+", help=argparse.SUPPRESS)
    parser.add_argument("--seconds", type=float, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    match arguments.be:
        case None if not can_make_links():
            print("this benchmark makes network namespaces: run it as root, with iproute2 (ip and tc)")
        case None:
            signal.signal(signal.SIGTERM, lambda _number, _frame: sys.exit(1))
            try:
                compare(arguments)
            except NetworkError as error:
                parser.exit(1, f"{error}\n")
        case ["robot", contender]:
            be_robot(contender, CASES[arguments.only].topics, arguments.seconds)
        case ["operator", contender]:
            be_operator(contender, CASES[arguments.only].topics)
        case ["flow-source"]:
            be_flow_source(arguments.seconds)
        case _:
            be_flow_sink()


if __name__ == "__main__":
    main()
