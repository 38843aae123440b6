# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo receive``: the operator's end of links to robots."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

from smarttestudo.adapters.foxglove import open_foxglove_sink
from smarttestudo.adapters.ros import open_robot
from smarttestudo.adapters.rosbag.recording_sink import RecordingSink
from smarttestudo.adapters.zenoh import open_operator_end
from smarttestudo.adapters.zenoh.security import LinkOptions
from smarttestudo.cli.link_options import add_zenoh_config, warn
from smarttestudo.cli.paths import file_path
from smarttestudo.cli.receive_table import receive_lines
from smarttestudo.cli.terminal import stop_signals
from smarttestudo.cli.top_table import Line, open_screen
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.link import Sink
from smarttestudo.use_cases.receive import Reception

DEFAULT_LISTEN = "tcp/127.0.0.1:7447"
_WAIT_S = 0.05
_SHOW_PERIOD_S = 1.0


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add ``receive`` to the subcommands."""
    parser = commands.add_parser(
        "receive",
        help="receive what robots send with 'testudo run --link'",
        description="Receive the relayed topics of robots over their links, the newest first, and publish them "
        "on the ROS graph here, record them, or serve them to Foxglove. Ends on SIGINT (Ctrl-C) and SIGTERM.",
    )
    parser.add_argument(
        "--listen",
        metavar="ENDPOINT",
        action="append",
        default=[],
        help=f"where robots connect to (default, unless --connect is given: {DEFAULT_LISTEN})",
    )
    parser.add_argument(
        "--connect",
        metavar="ENDPOINT",
        action="append",
        default=[],
        help="where a robot listens with --link-listen, or another 'testudo receive' or Zenoh router does",
    )
    parser.add_argument(
        "--output-topic",
        metavar="NAME",
        default="{topic}",
        help="names of the topics here, with {topic} and, for several robots, {robot} (default: {topic})",
    )
    parser.add_argument("--no-ros", action="store_true", help="publish nothing on the ROS graph")
    parser.add_argument(
        "--record", metavar="DIR", type=file_path, help="record into a new folder, a rosbag2 (mcap) for each robot"
    )
    parser.add_argument(
        "--foxglove", metavar="PORT", type=_port, help="serve all to the Foxglove app on this port of 127.0.0.1"
    )
    add_zenoh_config(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Receive until a signal comes."""
    if arguments.no_ros and arguments.record is None and arguments.foxglove is None:
        raise UsageError(
            "what arrives would go nowhere", place="--no-ros", remedy="add --record DIR or --foxglove PORT"
        )
    with ExitStack() as opened:
        stopped = opened.enter_context(stop_signals())
        say: Callable[[str], None] = warn
        show: Callable[[list[Line]], None] | None = None
        if sys.stdout.isatty():
            show = opened.enter_context(open_screen())
        end = opened.enter_context(open_operator_end(_options(arguments), say))
        turn = opened.enter_context(_ros_turn(arguments))
        reception = Reception(opened.enter_context(_sinks(arguments, turn, say)))
        if show is None:
            sys.stdout.write(f"Receiving at {', '.join(_options(arguments).listen) or 'no endpoint'}\n")
            sys.stdout.flush()
        show_s = time.monotonic()
        while not stopped():
            for event in end.wait(_WAIT_S):
                reception.take(event, time.monotonic())
            if show is not None and time.monotonic() >= show_s:
                show_s = time.monotonic() + _SHOW_PERIOD_S
                show(receive_lines(reception, time.monotonic()))
    return 0
