# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One drive of the simulated robot across a thin link, its operator's end recorded."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from enum import Enum
from functools import partial
from pathlib import Path

from smarttestudo.demo.link_side import ENDPOINT, READY, LinkRole
from smarttestudo.demo.network_namespaces import ThinLink, in_namespace
from smarttestudo.demo.processes import ChildProcess, child_process, testudo_command
from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.robot import DiscoveryRange
from smarttestudo.domain.units import BITS_PER_BYTE, NS_PER_S
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.robot.ros.discovery import discovery_variables
from smarttestudo.simulation.readings import Topic

WARM_S = 3.0
"""The time that is not counted at the beginning: nothing is known of the link then."""
_ROBOT_DOMAIN, _OPERATOR_DOMAIN = 77, 78
_ROBOT_NAME = "turtlebot3"
_START_TIMEOUT_S = 60.0
_FOUND = f"{Topic.ODOM.value}: nav_msgs"
"""The words of the runtime for the robot once it relays it."""
_POLL_S = 0.2
_TRAFFIC_BYTES = 20_000


class Contender(Enum):
    """Carriers of the relayed messages to the operator; the value is a name."""

    TESTUDO = "SmartTestudo"
    ZENOH = "Zenoh"
    FAST_DDS = "Fast DDS"


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkDrive:
    """How long, with which noise and under which rules the robot drives.

    ``decisions`` is where the runtime's go, and ``logs`` the folder of what the processes say.
    """

    contender: Contender
    rate_bit_per_s: float
    seconds: float
    seed: int
    rules: Path
    profile: Path
    when_slow: WhenSlow
    decisions: Path
    logs: Path


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivenAcross:
    """Recordings of what the robot published and the operator received, and the share of the link used.

    What arrived from ``from_ns`` to ``to_ns`` counts. ``link`` still has the counter that was
    ``before_bytes`` at the start.
    """

    published: Path
    received: Path
    used: float
    from_ns: int
    to_ns: int
    before_bytes: int


def drive_across(
    drive: LinkDrive, link: ThinLink, folder: Path, report: Callable[[float], None]
) -> DrivenAcross:
    """Let the robot drive at one end of ``link``, and record both ends into ``folder``.

    Raises:
        TestudoError: one of the processes failed.
        NetworkError: the link failed.
    """
    link.set_rate(drive.rate_bit_per_s)
    before_bytes = link.carried_bytes()
    published, received = folder / "published", folder / "received"
    with ExitStack() as opened:
        start = partial(_start, drive=drive, link=link, opened=opened)
        operator = start("operator", *_operator(drive.contender, received), of_operator=True)
        witness = start("recorder", _side(LinkRole.WITNESS, published), READY)
        runtime = start("runtime", _run(drive), "Relaying")
        children = [operator, witness, runtime]
        if drive.contender is Contender.ZENOH:
            children.append(start("sender", _side(LinkRole.ZENOH_ROBOT, drive.profile), READY))
        simulate = testudo_command("simulate", "--medium-images", "--seed", str(drive.seed))
        children.append(start("robot", simulate, "Driving the patrol"))
        runtime.await_text(_FOUND, _START_TIMEOUT_S)
        _await_traffic(link)
        start_ns = time.time_ns()
        counters = _watch(drive.seconds, children, link, report)
        to_ns = time.time_ns()
        # They end before the robot does, which would be a change of plans of its own.
        operator.end()
        runtime.end()
    if drive.contender is Contender.TESTUDO:
        received /= _ROBOT_NAME
    span_s = drive.seconds - WARM_S
    return DrivenAcross(
        published=published,
        received=received,
        used=(counters[1] - counters[0]) * BITS_PER_BYTE / (drive.rate_bit_per_s * span_s),
        from_ns=start_ns + round(WARM_S * NS_PER_S),
        to_ns=to_ns,
        before_bytes=before_bytes,
    )


def _start(
    name: str,
    command: Sequence[str],
    ready: str,
    *,
    drive: LinkDrive,
    link: ThinLink,
    opened: ExitStack,
    of_operator: bool = False,
) -> ChildProcess:
    """A process of the robot, or of the operator, that has said ``ready``."""
    namespace = link.operator if of_operator else link.robot
    environment = _environment(drive.contender, of_operator=of_operator)
    log = drive.logs / f"{name}.log"
    child = opened.enter_context(child_process(name, in_namespace(namespace, command), log, environment))
    child.await_text(ready, _START_TIMEOUT_S)
    return child


def _await_traffic(link: ThinLink) -> None:
    """Return once messages cross the link: the processes find each other sooner or later."""
    start_bytes, end_s = link.carried_bytes(), time.monotonic() + _START_TIMEOUT_S
    while link.carried_bytes() - start_bytes < _TRAFFIC_BYTES:
        if time.monotonic() > end_s:
            raise TestudoError(f"nothing crossed the link in {_START_TIMEOUT_S:g} s")
        time.sleep(_POLL_S)


def _watch(
    seconds: float, children: Iterable[ChildProcess], link: ThinLink, report: Callable[[float], None]
) -> tuple[int, int]:
    """Wait while all run; what the link had carried after the warm-up and at the end."""
    start_s = time.monotonic()
    warm_bytes = None
    while (passed_s := time.monotonic() - start_s) < seconds:
        if not all(child.is_running() for child in children):
            raise TestudoError("one of the demo's processes ended too early")
        if warm_bytes is None and passed_s >= WARM_S:
            warm_bytes = link.carried_bytes()
        report(passed_s / seconds)
        time.sleep(min(_POLL_S, seconds - passed_s))
    return warm_bytes or 0, link.carried_bytes()


def _environment(contender: Contender, *, of_operator: bool) -> dict[str, str]:
    """UDP only: namespaces share /dev/shm, in which Fast DDS would pass the link."""
    crosses = contender is Contender.FAST_DDS and of_operator
    discovery = DiscoveryRange.SUBNET if crosses else DiscoveryRange.LOCALHOST
    domain = _OPERATOR_DOMAIN if of_operator else _ROBOT_DOMAIN
    return {
        **os.environ,
        **discovery_variables(discovery),
        "ROS_DOMAIN_ID": str(domain),
        "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
        "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
    }


def _side(role: LinkRole, file: Path) -> list[str]:
    return [sys.executable, "-m", "smarttestudo.demo.link_side", role.value, str(file)]


def _operator(contender: Contender, folder: Path) -> tuple[list[str], str]:
    """The command of the operator's end that records into ``folder``, and what it says when it listens."""
    match contender:
        case Contender.TESTUDO:
            link = ("--listen", ENDPOINT, "--insecure")
            return testudo_command("receive", "--no-ros", "--record", str(folder), *link), "Receiving"
        case Contender.ZENOH:
            return _side(LinkRole.ZENOH_OPERATOR, folder), READY
        case Contender.FAST_DDS:
            return _side(LinkRole.ROS_OPERATOR, folder), READY


def _run(drive: LinkDrive) -> list[str]:
    to_operator = {
        Contender.TESTUDO: ("--link", ENDPOINT, "--insecure", "--robot", _ROBOT_NAME),
        Contender.ZENOH: (),
        Contender.FAST_DDS: ("--output-domain", str(_OPERATOR_DOMAIN), "--output-discovery", "subnet"),
    }
    return testudo_command(
        "run",
        *("--rules", str(drive.rules)),
        *("--profile", str(drive.profile)),
        *("--decisions", str(drive.decisions)),
        *("--when-slow", drive.when_slow.value),
        *to_operator[drive.contender],
    )
