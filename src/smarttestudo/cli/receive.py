# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo receive``: the operator's end of links to robots."""

from __future__ import annotations

import argparse
import os
import secrets
import shutil
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from typing import TYPE_CHECKING, Any, TextIO

from smarttestudo.cli.arguments import LAST_PORT, file_path, whole_number_type
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.link_options import add_datagrams, add_openmetrics, add_security, served_metrics
from smarttestudo.cli.loop_options import settings_of
from smarttestudo.cli.output import write_line
from smarttestudo.cli.terminal import stop_signals
from smarttestudo.cli.top_table import Line, Style, open_screen
from smarttestudo.domain.errors import RosError, UsageError, said
from smarttestudo.domain.link import Sink, command_topics
from smarttestudo.domain.names import STATUS_TOPIC, full_topic_names
from smarttestudo.domain.robot import receiving_node, relaying_nodes
from smarttestudo.domain.units import NS_PER_S, utc_time
from smarttestudo.link.foxglove import open_foxglove_sink
from smarttestudo.link.parts.options import (
    DATAGRAM_OPTIONS,
    INSECURE,
    SECURITY_OPTIONS,
    ZENOH_CONFIG,
    with_datagrams,
)
from smarttestudo.link.protocol.messages import MAX_PREDICTED
from smarttestudo.link.receive.arrival_log import ArrivalLog
from smarttestudo.link.receive.incident_mirror import IncidentMirror, MirrorFolders
from smarttestudo.link.receive.prediction import Predictor
from smarttestudo.link.receive.reception import ReceivedRobot, ReceivedTopic, Reception
from smarttestudo.link.receive.reception_metrics import ReceptionMetrics, StatusSink
from smarttestudo.link.receive.sending import CommandRoute, Sending
from smarttestudo.link.worker import Worker
from smarttestudo.link.zenoh import open_operator_end, require_zenoh, suspended_too_ns
from smarttestudo.link.zenoh.arrivals import LinkEvent
from smarttestudo.link.zenoh.security import LinkOptions
from smarttestudo.report.table import WHOLE, Column, Table, decimals, plain_table
from smarttestudo.robot.ros import open_robot
from smarttestudo.robot.ros.graph_sink import GraphSink
from smarttestudo.robot.ros.loading import has_rclpy

if TYPE_CHECKING:
    # It needs Zenoh.
    from smarttestudo.link.zenoh.commands import CommandOutbox


def reception_lines(
    reception: Reception, width: int | None = None, routes: Sequence[CommandRoute] = ()
) -> list[Line]:
    """Lines for each robot with its topics, as of the last poll, and what is sent to them."""
    lines: list[Line] = []
    for name, robot in sorted(reception.robots.items()):
        lines += [Line("")] * bool(lines)
        lines += [_heading(name, robot), Line(""), *_topics(robot, width)]
    if routes:
        lines += [Line("")] * bool(lines)
        lines += _sent(routes, width)
    return lines or [Line("Waiting for a robot: start 'testudo run --link' there.", Style.QUIET)]


def _heading(name: str, robot: ReceivedRobot) -> Line:
    total = sum(topic.meter.kb_per_s for topic in robot.topics.values())
    if not robot.boots:
        return Line(f"{name}   not connected", Style.ERROR)
    twice = f"   {len(robot.boots)} robots have this name" if len(robot.boots) > 1 else ""
    style = Style.WARN if twice else Style.HEADING
    return Line(f"{name}   {total:.1f} KB/s of messages{twice}", style)


def _topics(robot: ReceivedRobot, width: int | None) -> list[Line]:
    table = Table(columns=tuple(_topic_columns(robot)), rows=sorted(robot.topics.items()))
    return _lines(table, width, [_topic_style(topic) for _, topic in table.rows])


def _topic_columns(robot: ReceivedRobot) -> Iterator[Column[tuple[str, ReceivedTopic]]]:
    yield Column("Topic", "", lambda row: row[0], is_text=True)
    yield Column("Rate", "Hz", lambda row: row[1].meter.rate_hz)
    yield Column("In", "KB/s", lambda row: row[1].meter.kb_per_s, decimals(1))
    yield Column("Age", "ms", lambda row: row[1].age_ms, WHOLE)
    yield Column("Messages", "", lambda row: row[1].flow.messages, WHOLE)
    if any(topic.predicted for topic in robot.topics.values()):
        yield Column("Predicted", "", lambda row: row[1].predicted, WHOLE)
    yield Column("Type", "", lambda row: row[1].type_name, is_text=True)
    if any(topic.problem for topic in robot.topics.values()):
        yield Column("State", "", lambda row: row[1].problem or "", is_text=True)


def _lines(table: Table[Any], width: int | None, styles: Sequence[Style]) -> list[Line]:
    """The lines of ``table``, the headings and then each row in its style."""
    lines = plain_table(table, width=width).split("\n")
    headings = [Style.HEADING] * (len(lines) - len(styles))
    return [Line(text, style) for text, style in zip(lines, [*headings, *styles], strict=True)]


def _topic_style(topic: ReceivedTopic) -> Style:
    if topic.problem is not None:
        return Style.WARN
    return Style.STALE if topic.meter.is_silent else Style.PLAIN


def _sent(routes: Sequence[CommandRoute], width: int | None) -> list[Line]:
    table: Table[CommandRoute] = Table(
        columns=(
            Column("Sent topic", "", lambda route: route.source, is_text=True),
            Column("Robot", "", lambda route: route.boot.robot, is_text=True),
            Column("Sent", "", lambda route: route.counts.sent, WHOLE),
            Column("Dropped", "", _dropped, WHOLE),
            Column("Delivered", "", lambda route: route.accepted.delivered, WHOLE),
            Column("Too old", "", lambda route: route.accepted.too_old, WHOLE),
            Column("Age", "ms", lambda route: route.accepted.age_ms, WHOLE),
            Column("State", "", lambda route: route.problem or "", is_text=True),
        ),
        rows=routes,
    )
    return _lines(table, width, list(map(_style, routes)))


def _dropped(route: CommandRoute) -> int:
    """Messages that never left, most of them because a newer one did."""
    counts = route.counts
    return counts.replaced + counts.expired + counts.too_large + route.suspect


def _style(route: CommandRoute) -> Style:
    if route.problem is None:
        return Style.PLAIN
    return Style.QUIET if route.is_quiet else Style.WARN


DEFAULT_LISTEN = "tcp/127.0.0.1:7447"
_WAIT_S = 0.05
_POLL_PERIOD_S = 1.0
_PLACES = "--record DIR, --incidents DIR, --catch-up DIR, --foxglove PORT or --openmetrics PORT"


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Receive the relayed topics of robots over their links, the newest first, and publish "
        "them on the ROS graph here, record them, or serve them to Foxglove. Ends on SIGINT (Ctrl-C) "
        "and SIGTERM."
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
    parser.add_argument(
        "--no-ros",
        action="store_true",
        help="publish nothing on the ROS graph; needs --record, --incidents, --catch-up, --foxglove or "
        "--openmetrics, and no ROS 2",
    )
    parser.add_argument(
        "--record",
        metavar="DIR",
        type=file_path,
        help="record into a new folder, one rosbag2 a robot",
    )
    parser.add_argument(
        "--foxglove",
        metavar="PORT",
        type=whole_number_type(
            0, LAST_PORT, refusal=f"a port is a number from 0 (any free one) to {LAST_PORT}, not {{}}"
        ),
        help="serve all to the Foxglove app at this port",
    )
    parser.add_argument(
        "--send",
        metavar="TOPIC",
        nargs="+",
        action="extend",
        default=[],
        help="send these topics, by the robot's names, to robots that accept them, unless older than 0.5 s",
    )
    parser.add_argument(
        "--predict",
        metavar="TOPIC",
        nargs="+",
        action="extend",
        default=[],
        help="publish dead reckoning of these topics, by the robot's names, between their messages, at the "
        "source's rate (Odometry, transforms, joint states with a KeepWithin)",
    )
    parser.add_argument(
        "--incidents",
        metavar="DIR",
        type=file_path,
        help="fetch what the robots' rules record into DIR/ROBOT, in the part of the link that topics leave "
        "unused",
    )
    parser.add_argument(
        "--catch-up",
        metavar="DIR",
        type=file_path,
        help="fetch what was missed here in outages, of robots with --catch-up, into DIR/ROBOT likewise",
    )
    add_openmetrics(parser)
    add_security(parser)
    add_datagrams(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Receive until a signal comes."""
    require_zenoh()
    folders = MirrorFolders(incidents=arguments.incidents, outages=arguments.catch_up)
    is_fetching = folders != MirrorFolders()
    options, predicts = _options(arguments), _predicted(arguments)
    _settle_ros(arguments, is_fetching=is_fetching)
    _require_onlookers(arguments)
    folders.make()
    receiver = secrets.randbits(64)
    node = receiving_node(receiver)
    with ExitStack() as opened:
        stopped = opened.enter_context(stop_signals())
        statuses = StatusSink(STATUS_TOPIC)
        metrics = ReceptionMetrics(statuses)
        opened.enter_context(served_metrics(arguments.openmetrics, metrics.metrics))
        sinks: list[Sink] = [opened.enter_context(closing(sink)) for sink in _sinks(arguments, opened, node)]
        end = opened.enter_context(open_operator_end(options, _warn, predicts=predicts, receiver=receiver))
        if is_fetching:
            incidents = opened.enter_context(closing(end.incidents()))
            opened.enter_context(IncidentMirror(incidents, folders, _say, _warn).running())
        sending = None
        if end.commands is not None:
            sending = opened.enter_context(_sending(end.commands, arguments.output_topic, node))
            sinks.append(sending)
        _say_where(options)
        predictor = Predictor(predicts, statuses.source_hz, _warn) if predicts else None
        # On a terminal, what arrives is shown; elsewhere who comes, leaves and changes is said.
        is_shown = sys.stdout.isatty()
        note = (lambda _: None) if is_shown else ArrivalLog(_say).handle
        reception = Reception([*sinks, statuses], predictor, _warn, note)
        polls = [] if arguments.openmetrics is None else [lambda: metrics.update(reception, end)]
        if is_shown:
            show = opened.enter_context(open_screen())
            routes: Callable[[], Sequence[CommandRoute]] = (lambda: sending.routes) if sending else tuple
            polls.append(
                lambda: show(reception_lines(reception, shutil.get_terminal_size().columns, routes()))
            )
        _receive(reception, end.wait, stopped, polls)
    return 0


def _settle_ros(arguments: argparse.Namespace, *, is_fetching: bool) -> None:
    """Go without ROS where it is not here and what arrives has another place; refuse what does not fit."""
    goes_elsewhere = is_fetching or any(
        place is not None for place in (arguments.record, arguments.foxglove, arguments.openmetrics)
    )
    if arguments.no_ros and arguments.send:
        raise UsageError(
            "it sends messages of the ROS graph here", place="--send", remedy="leave out --no-ros"
        )
    if arguments.no_ros and not goes_elsewhere:
        raise UsageError("messages that arrive would go nowhere", place="--no-ros", remedy=f"add {_PLACES}")
    if arguments.no_ros or arguments.send or has_rclpy():
        return
    if not goes_elsewhere:
        raise RosError(
            "publishing what arrives on a ROS graph needs ROS 2 (rclpy)",
            remedy=f"source your ROS setup, or go without: --no-ros and {_PLACES}",
        )
    _warn("ROS 2 (rclpy) is not here: nothing is published on a ROS graph, as with --no-ros")
    arguments.no_ros = True


@contextmanager
def _sending(commands: CommandOutbox, pattern: str, receiving: str) -> Iterator[Sending]:
    """Send in a thread and with a node of its own: a disk that is slow delays no joystick."""
    with open_robot(name=f"testudo_send_{os.getpid()}") as robot:
        sending = Sending(
            robot,
            commands,
            _warn,
            pattern=pattern,
            own_nodes=lambda: {*relaying_nodes(robot), f"/{receiving}"},
            clock=suspended_too_ns,
        )
        worker = Worker(
            "link-commands", lambda error: _warn(f"{said(error)}; nothing more is sent"), sending.step
        )
        worker.start()
        try:
            yield sending
        finally:
            worker.close()
            sending.close()


def _options(arguments: argparse.Namespace) -> LinkOptions:
    has_endpoint = arguments.listen or arguments.connect
    settings = settings_of(arguments, (*SECURITY_OPTIONS, *DATAGRAM_OPTIONS))
    options = LinkOptions(
        listen=tuple(arguments.listen if has_endpoint else [DEFAULT_LISTEN]),
        connect=tuple(arguments.connect),
        config_file=settings[ZENOH_CONFIG],
        insecure=settings[INSECURE],
        commands=command_topics(arguments.send, "--send"),
    )
    return with_datagrams(options, settings)


def _predicted(arguments: argparse.Namespace) -> frozenset[str]:
    return frozenset(full_topic_names(arguments.predict, "--predict", most=MAX_PREDICTED, like="/odom"))


def _require_onlookers(arguments: argparse.Namespace) -> None:
    if arguments.predict and arguments.no_ros and arguments.foxglove is None:
        raise UsageError(
            "predicted messages are shown, not recorded",
            place="--predict",
            remedy="leave out --no-ros, or add --foxglove PORT",
        )


def _sinks(arguments: argparse.Namespace, opened: ExitStack, node: str) -> Iterator[Sink]:
    if not arguments.no_ros:
        robot = opened.enter_context(open_robot(name=node, sends_large=True))
        yield GraphSink(robot.data_path, _warn, pattern=arguments.output_topic)
    if arguments.record is not None:
        from smarttestudo.bags.recording_sink import RecordingSink  # noqa: PLC0415  needs rosbags

        say = (lambda _: None) if sys.stdout.isatty() else _say
        yield RecordingSink(arguments.record, _warn, time.time_ns, pattern=arguments.output_topic, say=say)
    if arguments.foxglove is not None:
        foxglove = open_foxglove_sink(arguments.foxglove, _warn, time.time_ns)
        write_line(f"Foxglove: open the connection ws://127.0.0.1:{foxglove.port}")
        yield foxglove


def _say(sentence: str) -> None:
    _write_timed(sentence, sys.stdout)


def _warn(sentence: str) -> None:
    _write_timed(f"testudo: {sentence}", sys.stderr)


def _write_timed(sentence: str, stream: TextIO) -> None:
    """Write it, in a file with the time, which a terminal needs not and a journal has."""
    has_time = stream.isatty() or "JOURNAL_STREAM" in os.environ
    write_line(sentence if has_time else f"{utc_time(time.time_ns())}  {sentence}", stream)
    stream.flush()


def _say_where(options: LinkOptions) -> None:
    places = [f"at {endpoint}" for endpoint in options.listen]
    places += [f"from {endpoint}" for endpoint in options.connect]
    write_line(f"Receiving {', '.join(places)}")
    sys.stdout.flush()


def _receive(
    reception: Reception,
    wait: Callable[[float], list[LinkEvent]],
    stopped: Callable[[], bool],
    polls: Sequence[Callable[[], None]],
) -> None:
    """Receive until ``stopped``; once a second, call ``polls``, of which none that fails costs another."""
    poll_s = time.monotonic()
    wait_s = _WAIT_S
    failed: set[str] = set()
    while not stopped():
        for event in wait(wait_s):
            reception.handle(event, time.monotonic_ns())
        due_ns, now_ns = reception.predict(time.monotonic_ns()), time.monotonic_ns()
        wait_s = _WAIT_S if due_ns is None else min(max(due_ns - now_ns, 0) / NS_PER_S, _WAIT_S)
        if polls and time.monotonic() >= poll_s:
            poll_s = time.monotonic() + _POLL_PERIOD_S
            reception.measure(time.monotonic_ns())
            for poll in polls:
                if (line := _failure(poll)) and line not in failed:
                    failed.add(line)
                    _warn(line)


def _failure(poll: Callable[[], None]) -> str | None:
    try:
        poll()
    except Exception as error:  # noqa: BLE001 - what is only shown or counted ends nothing
        return said(error)
    return None
