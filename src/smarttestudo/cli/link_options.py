# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Options of the commands that have an end of a link, or that Prometheus can watch."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from typing import TYPE_CHECKING

from smarttestudo.cli.arguments import LAST_PORT
from smarttestudo.cli.loop_options import add_option, settings_of
from smarttestudo.cli.output import write_line
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.metric import Metric
from smarttestudo.link.openmetrics import open_metrics_server
from smarttestudo.link.parts.options import (
    DATAGRAM_OPTIONS,
    INSECURE,
    SECURITY_OPTIONS,
    ZENOH_CONFIG,
    link_options,
    robot_name,
)
from smarttestudo.link.zenoh.security import LinkOptions
from smarttestudo.robot.option import Settings

if TYPE_CHECKING:
    from smarttestudo.domain.robot import RobotLog
    from smarttestudo.link.zenoh.robot_end import RobotEnd
    from smarttestudo.robot.part import PartKind


LOOPBACK = "127.0.0.1"
_ADDRESS = re.compile(r"(?:(?P<host>[^\s\[\]:]+|\[[0-9A-Fa-f:.]+\]):)?(?P<port>[0-9]{1,5})", re.ASCII)


def add_openmetrics(parser: argparse._ActionsContainer) -> None:
    parser.add_argument(
        "--openmetrics",
        metavar="[HOST:]PORT",
        type=metrics_address,
        help=f"serve metrics for Prometheus there, at /metrics (default host: {LOOPBACK})",
    )


def metrics_address(text: str) -> tuple[str, int]:
    """Host and port from the command line; ``ArgumentTypeError`` for anything else."""
    found = _ADDRESS.fullmatch(text)
    if found is None or int(found["port"]) > LAST_PORT:
        raise argparse.ArgumentTypeError(
            f"an address is written as in 9464, 0.0.0.0:9464 or [::]:9464, not {text!r}"
        )
    return (found["host"] or LOOPBACK).strip("[]"), int(found["port"])


@contextmanager
def served_metrics(
    address: tuple[str, int] | None, metrics: Callable[[], Iterable[Metric]]
) -> Iterator[None]:
    """Serve ``metrics`` while the block lasts, if there is an ``address``, and say where.

    Raises ``MissingPackageError`` and ``PortError``.
    """
    if address is None:
        yield
        return
    host, port = address
    with closing(open_metrics_server(host, port, metrics)) as server:
        named = f"[{host}]" if ":" in host else host
        write_line(f"Metrics: http://{named}:{server.port}/metrics")
        sys.stdout.flush()
        yield


@contextmanager
def served_run(address: tuple[str, int] | None, robot: str) -> Iterator[Sequence[PartKind]]:
    """The part of a run whose metrics are served, under the name ``robot``; none without an ``address``."""
    if address is None:
        yield ()
        return
    from smarttestudo.link.openmetrics.run_metrics import RunMetrics  # noqa: PLC0415  most runs serve none
    from smarttestudo.robot.part import PartKind  # noqa: PLC0415  an operator's end has no parts

    watched = RunMetrics(robot)
    with served_metrics(address, watched.metrics):
        yield (PartKind(make=lambda _context: watched),)


def add_security(parser: argparse._ActionsContainer) -> None:
    """Add ``--zenoh-config`` and ``--insecure``."""
    for option in SECURITY_OPTIONS:
        add_option(parser, option.flag or "", option)


def add_datagrams(parser: argparse._ActionsContainer) -> None:
    """Add ``--datagrams`` and ``--dscp``."""
    for option in DATAGRAM_OPTIONS:
        add_option(parser, option.flag or "", option)


class LinkWarnings:
    """Warnings of a link, from any thread: on standard error, in the log of a node once that is there."""

    def __init__(self) -> None:
        self._say: Callable[[str], None] = warn

    def __call__(self, sentence: str) -> None:
        self._say(sentence)

    @contextmanager
    def logged(self, log: RobotLog) -> Iterator[None]:
        """Warn in ``log``, which has time and node."""
        self._say = log.warning
        try:
            yield
        finally:
            self._say = warn


@contextmanager
def open_link(settings: Settings, warn: Callable[[str], None]) -> Iterator[RobotEnd | None]:
    """The link's end at the robot, if there is to be one.

    Raises ``LinkError`` as ``open_robot_end`` does, and ``UsageError`` for options of a link without one.
    """
    options = link_options(settings)
    if options is None:
        yield None
        return
    from smarttestudo.link.zenoh import open_robot_end  # noqa: PLC0415  most runs have no link

    with open_robot_end(robot_name(settings), options, warn) as link:
        yield link


def add_connect(parser: argparse.ArgumentParser) -> None:
    """Add ``--connect``, for commands that watch and ask robots, and the options that go with it."""
    group = parser.add_argument_group("robots over a link, without ROS here")
    group.add_argument(
        "--connect",
        metavar="ENDPOINT",
        action="append",
        default=[],
        help="where 'testudo receive', a Zenoh router or a robot (--link-listen) listens, as in "
        "tls/192.168.1.5:7447",
    )
    add_security(group)


def connect_options(arguments: argparse.Namespace) -> LinkOptions | None:
    """Where to connect to, if anywhere. Raises ``UsageError`` for what only goes with it."""
    settings = settings_of(arguments, SECURITY_OPTIONS)
    if arguments.connect:
        return LinkOptions(
            connect=tuple(arguments.connect), config_file=settings[ZENOH_CONFIG], insecure=settings[INSECURE]
        )
    given = {
        "--zenoh-config": settings[ZENOH_CONFIG] is not None,
        "--insecure": settings[INSECURE],
        "--robot": getattr(arguments, "robot", None) is not None,
    }
    for option in (option for option, is_given in given.items() if is_given):
        raise UsageError("it needs a link", place=option, remedy="add --connect")
    return None


def warn(sentence: str) -> None:
    """Say on standard error what somebody should read."""
    write_line(f"testudo: {sentence}", sys.stderr)
    sys.stderr.flush()
