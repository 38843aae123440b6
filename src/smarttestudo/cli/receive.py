# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo receive``: the operator's end of links to robots."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing

from smarttestudo.adapters.foxglove import open_foxglove_sink
from smarttestudo.adapters.ros import open_robot
from smarttestudo.adapters.ros.graph_sink import GraphSink
from smarttestudo.adapters.rosbag.recording_sink import RecordingSink
from smarttestudo.adapters.zenoh import open_operator_end
from smarttestudo.adapters.zenoh.arrivals import LinkEvent
from smarttestudo.adapters.zenoh.security import LinkOptions
from smarttestudo.cli.link_options import add_zenoh_config, warn
from smarttestudo.cli.paths import file_path
from smarttestudo.cli.receive_table import reception_lines
from smarttestudo.cli.terminal import stop_signals
from smarttestudo.cli.top_table import open_screen
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.link import Sink
from smarttestudo.use_cases.receive.reception import Reception

DEFAULT_LISTEN = "tcp/127.0.0.1:7447"
_WAIT_S = 0.05
_LAST_PORT = 65_535
_SHOW_PERIOD_S = 1.0


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add ``receive`` to the subcommands."""
    parser = commands.add_parser(
        "receive",
        help="receive what robots send with 'testudo run --link'",
        description="Receive the relayed topics of robots over their links, the newest first, and publish "
        "them on the ROS graph here, record them, or serve them to Foxglove. Ends on SIGINT (Ctrl-C) "
        "and SIGTERM.",
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
        "--record",
        metavar="DIR",
        type=file_path,
        help="record into a new folder, one rosbag2 a robot",
    )
    parser.add_argument(
        "--foxglove",
        metavar="PORT",
        type=_port,
        help="serve all to the Foxglove app at this port",
    )
    add_zenoh_config(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Receive until a signal comes."""
    if arguments.no_ros and arguments.record is None and arguments.foxglove is None:
        raise UsageError(
            "what arrives would go nowhere", place="--no-ros", remedy="add --record DIR or --foxglove PORT"
        )
    options = _options(arguments)
    with ExitStack() as opened:
        stopped = opened.enter_context(stop_signals())
        sinks = [opened.enter_context(closing(sink)) for sink in _sinks(arguments, opened)]
        end = opened.enter_context(open_operator_end(options, warn))
        _say_where(options)
        _receive(Reception(sinks), end.wait, stopped)
    return 0


def _options(arguments: argparse.Namespace) -> LinkOptions:
    has_endpoint = arguments.listen or arguments.connect
    return LinkOptions(
        listen=tuple(arguments.listen if has_endpoint else [DEFAULT_LISTEN]),
        connect=tuple(arguments.connect),
        config_file=arguments.zenoh_config,
        insecure=arguments.insecure,
    )


def _sinks(arguments: argparse.Namespace, opened: ExitStack) -> Iterator[Sink]:
    if not arguments.no_ros:
        robot = opened.enter_context(open_robot(name=f"testudo_receive_{os.getpid()}"))
        yield GraphSink(robot.data_path, warn, pattern=arguments.output_topic)
    if arguments.record is not None:
        yield RecordingSink(arguments.record, warn, time.time_ns, pattern=arguments.output_topic)
    if arguments.foxglove is not None:
        foxglove = open_foxglove_sink(arguments.foxglove, warn, time.time_ns)
        sys.stdout.write(f"Foxglove: open the connection ws://127.0.0.1:{foxglove.port}\n")
        yield foxglove


def _say_where(options: LinkOptions) -> None:
    places = [f"at {endpoint}" for endpoint in options.listen]
    places += [f"from {endpoint}" for endpoint in options.connect]
    sys.stdout.write(f"Receiving {', '.join(places)}\n")
    sys.stdout.flush()


def _receive(
    reception: Reception, wait: Callable[[float], list[LinkEvent]], stopped: Callable[[], bool]
) -> None:
    with ExitStack() as opened:
        show = opened.enter_context(open_screen()) if sys.stdout.isatty() else None
        show_s = time.monotonic()
        while not stopped():
            for event in wait(_WAIT_S):
                reception.take(event, time.monotonic_ns())
            if show is not None and time.monotonic() >= show_s:
                show_s = time.monotonic() + _SHOW_PERIOD_S
                reception.look(time.monotonic_ns())
                show(reception_lines(reception, shutil.get_terminal_size().columns))


def _port(text: str) -> int:
    if not (text.isascii() and text.isdigit()) or int(text) > _LAST_PORT:
        raise argparse.ArgumentTypeError(
            f"a port is a number from 0 (any free one) to {_LAST_PORT}, not {text!r}"
        )
    return int(text)
