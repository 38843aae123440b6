# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo top``: the status of the SmartTestudo nodes of a ROS graph, or of robots over a link."""

from __future__ import annotations

import argparse
import shutil
import sys
import time
from collections.abc import Callable

from smarttestudo.cli.arguments import add_timeout
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.link_options import add_connect, warn
from smarttestudo.cli.output import write_lines
from smarttestudo.cli.robots import open_robots, wait_for_all
from smarttestudo.cli.terminal import key_presses, stop_signals
from smarttestudo.cli.top_table import (
    Line,
    SortKey,
    Style,
    open_screen,
    print_lines,
    summary_lines,
    topic_lines,
)
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.record import to_json
from smarttestudo.domain.remote_robots import RemoteRobots
from smarttestudo.domain.units import grouped

_SHOW_PERIOD_S = 1.0
_WAIT_S = 0.1
_LOST_AFTER_S = 5.0


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Show the rates of every relayed topic, the rule that decided them and why a topic is "
        "silent, for all running SmartTestudo nodes, once a second. q or Ctrl-C ends it."
    )
    parser.add_argument(
        "--sort",
        choices=[key.value for key in SortKey],
        default=SortKey.TOPIC.value,
        help="what to order by: the topic's name (default), or a number, largest first",
    )
    parser.add_argument("--once", action="store_true", help="show one table and end")
    parser.add_argument("--json", action="store_true", help="with --once: everything, as one JSON object")
    add_timeout(parser, "with --once: how long to wait for a SmartTestudo node")
    add_connect(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Show until a key or a signal comes, or once."""
    if arguments.json and not arguments.once:
        raise UsageError("--json goes with --once only", place="--json", remedy="add --once")
    with stop_signals() as stopped, open_robots(arguments, "testudo_top") as robots:
        if arguments.once:
            wait_for_all(robots, stopped, arguments.timeout)
            print_once(robots, arguments)
        else:
            _show(robots, stopped, SortKey(arguments.sort))
    return 0


def print_once(robots: RemoteRobots, arguments: argparse.Namespace) -> None:
    """Print what was heard of ``robots``; as JSON, what could not be heard is on standard error."""
    if arguments.json:
        for line in _unheard(robots):
            warn(line.text)
        nodes = {node: to_json(heard.status) for node, heard in sorted(robots.heard.items())}
        write_lines(json_text({"nodes": nodes}, ascii_only=False, indent=2).split("\n"))
    else:
        print_lines(_lines(robots, SortKey(arguments.sort), _width()))


def _show(robots: RemoteRobots, stopped: Callable[[], bool], sort: SortKey) -> None:
    with key_presses() as pressed, open_screen() as show:
        show_s, shown = time.monotonic(), [Line("")]
        while not stopped() and "q" not in pressed():
            robots.wait(_WAIT_S)
            if time.monotonic() < show_s:
                continue
            show_s = time.monotonic() + _SHOW_PERIOD_S
            lines = _lines(robots, sort, _width())
            if lines != shown:
                show(lines)
                shown = lines


def _width() -> int | None:
    """The columns of a terminal; ``None`` in a pipe, where nothing is cut."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else None


def _lines(robots: RemoteRobots, sort: SortKey, width: int | None) -> list[Line]:
    lines: list[Line] = []
    for _, heard in sorted(robots.heard.items()):
        silent_s = time.monotonic() - heard.heard_s
        lines += [Line("")] * bool(lines)
        is_silent = silent_s > _LOST_AFTER_S or not heard.is_present
        lines += summary_lines(heard.status, silent_s=silent_s if is_silent else None, width=width)
        lines += [Line(""), *topic_lines(heard.status, sort, width)]
    if not lines:
        lines = [Line(f"Waiting for a status at {robots.place} …", Style.QUIET)]
    return lines + _unheard(robots)


def _unheard(robots: RemoteRobots) -> list[Line]:
    """Why some robots may be missing."""
    lines = [Line(robots.problem, Style.ERROR)] if robots.problem else []
    if robots.unreadable:
        unread = f"statuses of another version that could not be read: {grouped(robots.unreadable)}"
        lines.append(Line(unread, Style.WARN))
    return lines
