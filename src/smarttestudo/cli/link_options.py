# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Options of the commands that have an end of a link."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from smarttestudo.cli.budget import budget_kb_per_s
from smarttestudo.cli.output import write_line
from smarttestudo.cli.paths import file_path
from smarttestudo.domain.errors import UsageError

if TYPE_CHECKING:
    from smarttestudo.domain.robot import RobotLog
    from smarttestudo.link.zenoh.robot_end import RobotEnd
    from smarttestudo.link.zenoh.security import LinkOptions

_NEED_A_LINK = ("accept", "robot", "fetch_budget", "zenoh_config", "insecure")


def add_link(parser: argparse.ArgumentParser) -> None:
    """Add ``--link`` and ``--link-listen``, which begin a link, and what goes with them."""
    group = parser.add_argument_group("link to an operator")
    group.add_argument(
        "--link",
        metavar="ENDPOINT",
        action="append",
        default=[],
        help="send what is relayed to 'testudo receive' there, as in tls/192.168.1.5:7447; the ROS graph "
        "gets it too only with --output-topic or --output-domain",
    )
    group.add_argument(
        "--link-listen",
        metavar="ENDPOINT",
        action="append",
        default=[],
        help="wait there for 'testudo receive --connect' instead",
    )
    group.add_argument(
        "--robot", metavar="NAME", help="the robot's name for operators (default: this host's name)"
    )
    group.add_argument(
        "--accept",
        metavar="TOPIC",
        nargs="+",
        action="extend",
        default=[],
        help="publish what 'testudo receive --send' sends of these topics, unless it is older than 0.5 s",
    )
    group.add_argument(
        "--fetch-budget",
        metavar="N",
        type=budget_kb_per_s,
        help="KB/s of the link that incidents and gaps may take when operators fetch them (default: all "
        "that live topics leave)",
    )
    add_zenoh_config(group)


def add_zenoh_config(parser: argparse._ActionsContainer) -> None:
    """Add ``--zenoh-config`` and ``--insecure``."""
    parser.add_argument(
        "--zenoh-config",
        metavar="FILE",
        type=file_path,
        help="certificates, users and access control of the link: a Zenoh configuration (JSON5)",
    )
    parser.add_argument(
        "--insecure",
        action="store_true",
        help="allow endpoints that other machines reach without TLS: others can read and change what is sent",
    )


class LinkWarnings:
    """Warnings of a link, from any thread: on standard error, in the log of a node once that is there."""

    def __init__(self) -> None:
        self._say: Callable[[str], None] = warn

    def __call__(self, sentence: str) -> None:
        """Say it."""
        self._say(sentence)

    @contextmanager
    def logged(self, log: RobotLog) -> Iterator[None]:
        """Say it in that log, which has time and node."""
        self._say = log.warning
        try:
            yield
        finally:
            self._say = warn


@contextmanager
def open_link(
    arguments: argparse.Namespace, robot: str, warn: Callable[[str], None]
) -> Iterator[RobotEnd | None]:
    """The link's end at the robot of that name, if there is to be one.

    Raises ``LinkError`` as ``open_robot_end`` does, and ``UsageError`` for options of a link without one.
    """
    from smarttestudo.domain.link import command_topics  # noqa: PLC0415  most commands have no link

    options = _robot_options(arguments, command_topics(arguments.accept, "--accept"))
    if options is None:
        yield None
        return
    from smarttestudo.link.zenoh import open_robot_end  # noqa: PLC0415  most runs have no link

    with open_robot_end(robot, options, warn) as link:
        yield link


def _robot_options(arguments: argparse.Namespace, accepted: tuple[str, ...]) -> LinkOptions | None:
    if arguments.link or arguments.link_listen:
        from smarttestudo.link.zenoh.security import LinkOptions  # noqa: PLC0415  most runs have no link

        return LinkOptions(
            listen=tuple(arguments.link_listen),
            connect=tuple(arguments.link),
            config_file=arguments.zenoh_config,
            insecure=arguments.insecure,
            commands=accepted,
            fetch_budget_kb_per_s=math.inf if arguments.fetch_budget is None else arguments.fetch_budget,
        )
    for name in _NEED_A_LINK:
        given = getattr(arguments, name)
        if given or isinstance(given, float):
            option = "--" + name.replace("_", "-")
            raise UsageError("it needs a link", place=option, remedy="add --link or --link-listen")
    return None


def add_connect(parser: argparse.ArgumentParser) -> None:
    """Add ``--connect`` for who only watches and asks, and what goes with it."""
    group = parser.add_argument_group("robots over a link, without ROS here")
    group.add_argument(
        "--connect",
        metavar="ENDPOINT",
        action="append",
        default=[],
        help="where 'testudo receive', a Zenoh router or a robot (--link-listen) listens, as in "
        "tls/192.168.1.5:7447",
    )
    add_zenoh_config(group)


def connect_options(arguments: argparse.Namespace) -> LinkOptions | None:
    """Where to connect to, if anywhere. Raises ``UsageError`` for what only goes with it."""
    if arguments.connect:
        from smarttestudo.link.zenoh.security import LinkOptions  # noqa: PLC0415  most commands ask over ROS

        return LinkOptions(
            connect=tuple(arguments.connect),
            config_file=arguments.zenoh_config,
            insecure=arguments.insecure,
        )
    for name in ("zenoh_config", "insecure", "robot"):
        if getattr(arguments, name, None) not in (None, False):
            option = "--" + name.replace("_", "-")
            raise UsageError("it needs a link", place=option, remedy="add --connect")
    return None


def warn(sentence: str) -> None:
    """Say on standard error what somebody should read."""
    write_line(f"testudo: {sentence}", sys.stderr)
    sys.stderr.flush()
