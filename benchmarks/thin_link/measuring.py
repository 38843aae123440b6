# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One run of a case by one contender: both ends, the link's course, and what came of it."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

from live.processes import Process
from thin_link.cases import WARM_S, Arrival, Beside, Case, Seen
from thin_link.ends import role
from thin_link.network_namespaces import OPERATOR_ADDRESS, NetworkError, ThinLink, thin_link
from thin_link.roles import ENDPOINT

CONTENDERS: Mapping[str, str] = {
    "testudo": "SmartTestudo",
    "testudo-datagrams": "SmartTestudo, --datagrams on",
    "zenoh": "plain Zenoh",
    "zenoh-quic": "Zenoh, QUIC datagrams",
    "zenoh-udp": "Zenoh, udp",
    "foxglove": "Foxglove",
    "fastdds": "Fast DDS",
}
SECOND_ENDPOINT = f"tcp/{OPERATOR_ADDRESS}:7451"
_GRACE_S = 0.5
"""A message under way when the robot stops may arrive so much later."""
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
            brought = _measure(case, _Run(link, contender, traffic, seconds))
    except NetworkError as error:
        print(error, file=sys.stderr)
        return None
    if brought is None:
        print("its ends did not meet", file=sys.stderr)
    return brought


@dataclass(frozen=True, slots=True)
class _Run:
    """One run, whose processes it starts."""

    link: ThinLink
    contender: str
    traffic: str
    seconds: float

    def pair(self, opened: ExitStack, endpoint: str) -> tuple[Process, Process] | None:
        """An operator and a robot that have met; ``None`` where they do not."""
        options = ("--traffic", self.traffic, "--endpoint", endpoint)
        operator = opened.enter_context(role(self.link.operator, "operator", self.contender, *options))
        operator.line()
        arguments = ("robot", self.contender, *options, "--seconds", str(self.seconds))
        robot = opened.enter_context(role(self.link.robot, *arguments))
        return (operator, robot) if robot.line() else None

    def other(self, opened: ExitStack, beside: Beside) -> _Other | None:
        """The traffic beside them; ``None`` where its ends do not meet."""
        if beside is Beside.NOTHING:
            return _Other()
        if beside is Beside.FLOW:
            return _Flow(opened, self.seconds, self.link)
        pair = self.pair(opened, SECOND_ENDPOINT)
        return None if pair is None else _SecondRobot(*pair)


def _measure(case: Case, run: _Run) -> Seen | None:
    link, seconds = run.link, run.seconds
    with ExitStack() as opened:
        pair, other = run.pair(opened, ENDPOINT), run.other(opened, case.beside)
        if pair is None or other is None:
            return None
        operator, robot = pair
        start_bytes = link.carried_bytes()
        start_ns = robot.ask("go")
        other.start()
        warm_bytes, end_bytes = _run_link(case, seconds, start_ns, link)
        told, counts = json.loads(robot.line()), _counts(robot, link)
        carried_bytes = link.carried_bytes() - start_bytes
        arrived = operator.ask("end")
        other_bytes = other.bytes_between(start_ns + int(WARM_S * 1e9), start_ns + int(seconds * 1e9))
    least_share = 0.9 * min(topic.noise for topic in case.topics)
    link.require_carried(least_share * sum(each[4] for each in arrived), start_bytes)
    return Seen(
        arrived=_by_topic(arrived, start_ns),
        seconds=seconds,
        used=(end_bytes - warm_bytes) / case.capacity_bytes(WARM_S, seconds),
        cpu_s_per_mb=told["cpu_s"] / (carried_bytes / 1e6),
        other_share=None if case.beside is Beside.NOTHING else other_bytes / (end_bytes - warm_bytes),
        published={one.name: count for one, count in zip(case.topics, told["published"], strict=True)},
        begun={topic: begun for topic, (begun, _) in counts.items()},
        overflowed={topic: overflowed for topic, (_, overflowed) in counts.items()},
    )


class _Other:
    """Traffic beside what is measured: none."""

    def start(self) -> None:
        """Begin."""

    def bytes_between(self, _from_ns: int, _to_ns: int) -> int:
        """End, and tell how many bytes arrived in that time."""
        return 0


class _Flow(_Other):
    """A TCP flow that takes what it gets."""

    def __init__(self, opened: ExitStack, seconds: float, link: ThinLink) -> None:
        self._opened = opened
        self._seconds = seconds
        self._link = link
        self._sink = opened.enter_context(role(link.operator, "flow-sink"))
        self._sink.line()

    def start(self) -> None:
        arguments = ("flow-source", "--seconds", str(self._seconds))
        self._opened.enter_context(role(self._link.robot, *arguments))

    def bytes_between(self, from_ns: int, to_ns: int) -> int:
        totals = [total for at_ns, total in self._sink.ask("end") if from_ns <= at_ns < to_ns]
        return totals[-1] - totals[0] if totals else 0


class _SecondRobot(_Other):
    """A robot that sends the same to an operator of its own."""

    def __init__(self, operator: Process, robot: Process) -> None:
        self._operator = operator
        self._robot = robot

    def start(self) -> None:
        self._robot.ask("go")

    def bytes_between(self, from_ns: int, to_ns: int) -> int:
        return sum(size for *_, at_ns, size in self._operator.ask("end") if from_ns <= at_ns < to_ns)


def _counts(robot: Process, link: ThinLink) -> dict[str, tuple[int, int]]:
    """The counts of the robot's end once what was under way has had the time to arrive."""
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
