# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One run of a case by one contender: both ends, the link's course, and what came of it."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from typing import Any

from live.processes import Process
from thin_link.cases import WARM_S, Arrival, Case, Seen
from thin_link.ends import role
from thin_link.network_namespaces import NetworkError, ThinLink, thin_link

CONTENDERS: Mapping[str, str] = {
    "testudo": "SmartTestudo",
    "zenoh": "plain Zenoh",
    "zenoh-quic": "Zenoh, QUIC datagrams",
    "zenoh-udp": "Zenoh, udp",
    "foxglove": "Foxglove",
    "fastdds": "Fast DDS",
}
_GRACE_S = 0.5
"""What is under way when the robot stops may arrive so much later."""
_TRIPS_OF_GRACE = 6


def measured(case: Case, traffic: str, contender: str, seconds: float, seed: int = 1) -> Seen | None:
    """One run on a link of its own; ``None``, with a line that says why, where it showed nothing.

    ``traffic`` is what the processes know the case by.
    """
    print(f"{case.title}: {CONTENDERS[contender]}", file=sys.stderr)
    conditions = case.course[0][1]
    assert conditions is not None
    try:
        with thin_link(conditions, seed) as link:
            brought = _measure(case, traffic, contender, seconds, link)
    except NetworkError as error:
        print(error, file=sys.stderr)
        return None
    if brought is None:
        print("its ends did not meet", file=sys.stderr)
    return brought


def _measure(case: Case, traffic: str, contender: str, seconds: float, link: ThinLink) -> Seen | None:
    with ExitStack() as opened:
        operator = opened.enter_context(role(link.operator, "operator", contender, "--traffic", traffic))
        operator.line()
        sink = opened.enter_context(role(link.operator, "flow-sink")) if case.has_flow else None
        if sink is not None:
            sink.line()
        arguments = ("robot", contender, "--traffic", traffic, "--seconds", str(seconds))
        robot = opened.enter_context(role(link.robot, *arguments))
        if not robot.line():
            return None
        start_bytes = link.carried_bytes()
        start_ns = robot.ask("go")
        if case.has_flow:
            opened.enter_context(role(link.robot, "flow-source", "--seconds", str(seconds)))
        warm_bytes, end_bytes = _run_link(case, seconds, start_ns, link)
        told, counts = json.loads(robot.line()), _counts(robot, link)
        carried_bytes = link.carried_bytes() - start_bytes
        arrived = operator.ask("end")
        flow = sink.ask("end") if sink is not None else None
    least_share = 0.9 * min(topic.noise for topic in case.topics)
    link.require_carried(least_share * sum(each[4] for each in arrived), start_bytes)
    return Seen(
        arrived=_by_topic(arrived, start_ns),
        seconds=seconds,
        used=(end_bytes - warm_bytes) / case.capacity_bytes(WARM_S, seconds),
        cpu_s_per_mb=told["cpu_s"] / (carried_bytes / 1e6),
        flow_share=None if flow is None else _flow_bytes(flow, start_ns, seconds) / (end_bytes - warm_bytes),
        published={one.name: count for one, count in zip(case.topics, told["published"], strict=True)},
        begun={topic: begun for topic, (begun, _) in counts.items()},
        overflowed={topic: overflowed for topic, (_, overflowed) in counts.items()},
    )


def _counts(robot: Process, link: ThinLink) -> dict[str, tuple[int, int]]:
    """What the robot's end counts once what was under way has had the time to arrive."""
    time.sleep(_GRACE_S + _TRIPS_OF_GRACE * 2 * link.conditions.delay_ms / 1e3)
    found: dict[str, tuple[int, int]] = robot.ask("count")
    return found


def _run_link(case: Case, seconds: float, start_ns: int, link: ThinLink) -> tuple[int, int]:
    """Change the link as the case says; what it had carried after the warm-up and at the end."""
    changes = {at_s: conditions for at_s, conditions in case.course[1:] if at_s < seconds}
    counters = []
    for at_s in sorted({*changes, WARM_S, seconds}):
        time.sleep(max(0.0, at_s - (time.monotonic_ns() - start_ns) / 1e9))
        if at_s in {WARM_S, seconds}:
            counters.append(link.carried_bytes())
        if at_s not in changes:
            continue
        if (conditions := changes[at_s]) is None:
            link.cut()
        else:
            link.mend()
            link.change(conditions)
    return counters[0], counters[1]


def _by_topic(arrived: Sequence[Sequence[Any]], start_ns: int) -> dict[str, list[Arrival]]:
    """The arrivals of each topic, in s from the start."""
    found: dict[str, list[Arrival]] = {}
    for topic, number, sent_ns, at_ns, _ in arrived:
        one = Arrival(number=number, sent_s=(sent_ns - start_ns) / 1e9, at_s=(at_ns - start_ns) / 1e9)
        found.setdefault(topic, []).append(one)
    return found


def _flow_bytes(seen: Sequence[tuple[int, int]], start_ns: int, seconds: float) -> int:
    """What the TCP flow brought after the warm-up."""
    totals = [total for at_ns, total in seen if WARM_S <= (at_ns - start_ns) / 1e9 < seconds]
    return totals[-1] - totals[0] if totals else 0
