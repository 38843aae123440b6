# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What SmartTestudo's ends take of their machines, also where an operator takes nothing, or has 50 robots."""

from __future__ import annotations

import json
import math
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

from live.processes import Process
from thin_link.cases import IMAGE, SMALL, Target
from thin_link.emulated_path import wire
from thin_link.ends import process, role
from thin_link.fleet import FLEET_BYTES_PER_S, ROUTER
from thin_link.network_namespaces import ThinLink, thin_link
from thin_link.roles import ENDPOINT
from thin_link.traffic import Topic

STOPPED_S, STOP_AT_S, GO_ON_S = 30.0, 5.0, 20.0
FULL_S, COST_S, FLEET_S = 45.0, 20.0, 15.0
COST_TOPICS = (*SMALL, replace(IMAGE, size_bytes=96_000))
FULL_TOPICS = (*SMALL, replace(IMAGE, size_bytes=250_000))
FLEET = 50
_POLL_S = 0.25


@contextmanager
def receive(namespace: str, *link: str) -> Iterator[Process]:
    """``testudo receive``, which records."""
    with tempfile.TemporaryDirectory() as folder:
        to_disk = ("--no-ros", "--record", str(Path(folder, "recorded")))
        command = [sys.executable, "-m", "smarttestudo", "receive", *to_disk, *link, "--insecure"]
        with process(namespace, command) as operator:
            operator.line()
            yield operator


def drive(
    link: ThinLink,
    operator: Process,
    traffic: str,
    seconds: float,
    acts: Mapping[float, Callable[[], None]],
    *,
    most_mb: float,
) -> list[Target]:
    """The source's rate, and how much both ends grow after the first two seconds, while ``acts`` happen."""
    with role(link.robot, "robot", "testudo", "--traffic", traffic, "--seconds", str(seconds)) as robot:
        robot.line()
        robot.ask("go")
        start_s, left = time.monotonic(), sorted(acts.items())
        seen: list[tuple[float, float]] = []
        while (passed_s := time.monotonic() - start_s) < seconds:
            while left and left[0][0] <= passed_s:
                left.pop(0)[1]()
            if passed_s > 2.0:
                seen.append((robot.resident_mb, operator.resident_mb))
            time.sleep(_POLL_S)
        told = json.loads(robot.line())
    due = sum(math.ceil((seconds - one.from_s) * one.hz) for one in TRAFFIC[traffic])
    robot_mb, operator_mb = (max(values) - values[0] for values in zip(*seen, strict=True))
    return [
        Target(
            name="source's rate, share of its own",
            value=sum(told["published"]) / due,
            least=0.99,
        ),
        Target(name="robot's end grew by MB", value=robot_mb, most=20),
        Target(name="operator's end grew by MB", value=operator_mb, most=most_mb),
    ]


def stopped_operator(link: ThinLink) -> list[Target]:
    """``testudo receive`` stopped by SIGSTOP for a quarter of a minute."""
    link.change(wire(2e6))
    with receive(link.operator, "--listen", ENDPOINT) as operator:
        acts = {
            STOP_AT_S: lambda: operator.signal(signal.SIGSTOP),
            GO_ON_S: lambda: operator.signal(signal.SIGCONT),
        }
        return drive(link, operator, "stopped", STOPPED_S, acts, most_mb=20)


def full_sink(link: ThinLink) -> list[Target]:
    """An operator's end whose events nobody takes from the fifth second on."""
    link.change(wire(25e6))
    with role(link.operator, "stuck") as operator:
        operator.line()
        acts = {STOP_AT_S: lambda: operator.ask("stop")}
        # 64 MB may wait, and each message takes some more than its bytes.
        return drive(link, operator, "full", FULL_S, acts, most_mb=80)


def cost(link: ThinLink) -> list[Target]:
    """A robot that sends 1 MB/s, beside the same source without a link."""
    link.change(wire(25e6))
    cpu_s, resident_mb = {}, {}
    before_bytes = link.carried_bytes()
    with receive(link.operator, "--listen", ENDPOINT):
        for contender in ("none", "testudo"):
            arguments = ("robot", contender, "--traffic", "cost", "--seconds", str(COST_S))
            with role(link.robot, *arguments) as robot:
                robot.line()
                robot.ask("go")
                cpu_s[contender] = json.loads(robot.line())["cpu_s"]
                resident_mb[contender] = robot.resident_mb
    sent_mb_per_s = (link.carried_bytes() - before_bytes) / 1e6 / COST_S
    return [
        Target(name="MB/s sent", value=sent_mb_per_s, least=0.99),
        Target(name="robot's end, % of a core", value=100 * cpu_s["testudo"] / COST_S, most=10),
        Target(name="of it the source, % of a core", value=100 * cpu_s["none"] / COST_S, most=10),
        Target(
            name="more MB than without a link", value=resident_mb["testudo"] - resident_mb["none"], most=60
        ),
    ]


def fleet(link: ThinLink) -> list[Target]:
    """One ``testudo receive`` with few and with many robots, which connect to it."""
    return _fleet(link, ENDPOINT, ("--listen", ENDPOINT), "")


def routed_fleet(link: ThinLink) -> list[Target]:
    """The same with a Zenoh router between."""
    with role(link.operator, "router") as router:
        router.line()
        return _fleet(link, ROUTER, ("--connect", ROUTER), ", routed")


def _fleet(link: ThinLink, endpoint: str, options: tuple[str, ...], how: str) -> list[Target]:
    link.change(wire(100e6))
    seen = {}
    for count in (1, FLEET):
        with ExitStack() as opened:
            operator = opened.enter_context(receive(link.operator, *options))
            robots = opened.enter_context(role(link.robot, "fleet", str(count), endpoint))
            robots.line()
            before_bytes = link.carried_bytes()
            cpu_s = operator.cpu_s
            time.sleep(FLEET_S)
            link.require_carried(0.5 * count * FLEET_BYTES_PER_S * FLEET_S, before_bytes)
            seen[count] = (100 * (operator.cpu_s - cpu_s) / FLEET_S, operator.resident_mb)
    share, memory_mb = ((many - few) / (FLEET - 1) for few, many in zip(seen[1], seen[FLEET], strict=True))
    return [
        Target(name=f"{FLEET} robots{how}: operator's end, % of a core", value=seen[FLEET][0], most=100),
        Target(name=f"a robot{how}, % of a core", value=share, most=2),
        Target(name=f"a robot{how}, MB", value=memory_mb, most=2),
    ]


TRAFFIC: Mapping[str, tuple[Topic, ...]] = {
    "stopped": (*SMALL, IMAGE),
    "full": FULL_TOPICS,
    "cost": COST_TOPICS,
}
LIMITS: Mapping[str, tuple[str, Callable[[ThinLink], list[Target]]]] = {
    "stopped": ("2 Mbit/s, the operator's process stopped for 15 s", stopped_operator),
    "full": ("25 Mbit/s, a sink that takes nothing for 40 s", full_sink),
    "cost": ("25 Mbit/s, 1 MB/s sent", cost),
    "fleet": (f"{FLEET} robots at one operator's end", fleet),
    "routed": (f"{FLEET} robots through a Zenoh router", routed_fleet),
}


def measure_limit(name: str) -> list[Target]:
    """One of them, on a link of its own."""
    with thin_link(wire(25e6)) as link:
        return LIMITS[name][1](link)
