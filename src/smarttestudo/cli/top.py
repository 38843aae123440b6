# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo top``: the status of the SmartTestudo nodes of a ROS graph."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack

from smarttestudo.adapters.json.status import status_to_json
from smarttestudo.adapters.ros import open_robot
from smarttestudo.cli.terminal import add_timeout, key_presses, stop_signals
from smarttestudo.cli.top_table import (
    Line,
    Look,
    SortKey,
    open_screen,
    print_lines,
    summary_lines,
    topic_lines,
)
from smarttestudo.domain.errors import RosError, UsageError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.robot import Robot
from smarttestudo.use_cases.live.status_topics import STATUS_TOPIC, StatusWatch

_SHOW_PERIOD_S = 1.0
_WAIT_S = 0.1
_LOST_AFTER_S = 5.0


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add ``top`` to the subcommands."""
    parser = commands.add_parser(
        "top",
        help="show what running SmartTestudo nodes relay, and why",
        description="Show the rates of every relayed topic, the rule that decided them and why a topic is "
        "silent, for all running SmartTestudo nodes, once a second. q or Ctrl-C ends it.",
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
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Show until a key or a signal comes, or once."""
    if arguments.json and not arguments.once:
        raise UsageError("--json goes with --once only", place="--json", remedy="add --once")
    with ExitStack() as opened:
        stopped = opened.enter_context(stop_signals())
        robot = opened.enter_context(open_robot(name=f"testudo_top_{os.getpid()}"))
        watch = StatusWatch(robot, time.monotonic)
        if arguments.once:
            _wait_for_all(watch, robot, stopped, arguments.timeout)
            _print_once(watch, arguments)
        else:
            _show(watch, robot, stopped, SortKey(arguments.sort))
    return 0


def _wait_for_all(watch: StatusWatch, robot: Robot, stopped: Callable[[], bool], timeout_s: float) -> None:
    end_s = time.monotonic() + timeout_s
    while not watch.has_heard_all and time.monotonic() < end_s and not stopped():
        robot.wait(None, _WAIT_S)
    if not watch.heard:
        cause = "no readable status was received" if watch.unreadable else "no status was received"
        raise RosError(
            f"{cause} within {timeout_s:g} s",
            place=STATUS_TOPIC,
            remedy="start `testudo run`, in this version and with the same ROS_DOMAIN_ID",
        )


def _print_once(watch: StatusWatch, arguments: argparse.Namespace) -> None:
    if arguments.json:
        nodes = {node: status_to_json(heard.status) for node, heard in sorted(watch.heard.items())}
        sys.stdout.write(json_text({"nodes": nodes}, ascii_only=False, indent=2) + "\n")
    else:
        print_lines(_lines(watch, SortKey(arguments.sort), _width()))


def _show(watch: StatusWatch, robot: Robot, stopped: Callable[[], bool], sort: SortKey) -> None:
    with key_presses() as pressed, open_screen() as show:
        show_s, shown = time.monotonic(), [Line("")]
        while not stopped() and "q" not in pressed():
            robot.wait(None, _WAIT_S)
            if time.monotonic() < show_s:
                continue
            show_s = time.monotonic() + _SHOW_PERIOD_S
            lines = _lines(watch, sort, _width())
            if lines != shown:
                show(lines)
                shown = lines


def _width() -> int | None:
    """The columns of a terminal; ``None`` in a pipe, where nothing is cut."""
    return shutil.get_terminal_size().columns if sys.stdout.isatty() else None


def _lines(watch: StatusWatch, sort: SortKey, width: int | None) -> list[Line]:
    lines: list[Line] = []
    for _, heard in sorted(watch.heard.items()):
        silent_s = time.monotonic() - heard.heard_s
        lines += [Line("")] * bool(lines)
        lines += summary_lines(heard.status, silent_s=silent_s if silent_s > _LOST_AFTER_S else None)
        lines += [Line(""), *topic_lines(heard.status, sort, width)]
    if not lines:
        lines = [Line(f"Waiting for a status on {STATUS_TOPIC} …", Look.QUIET)]
    if watch.unreadable:
        lines.append(Line(f"{watch.unreadable} statuses of another version could not be read", Look.WARN))
    return lines
