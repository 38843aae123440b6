# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo echo``: what a subscriber receives on topics."""

from __future__ import annotations

import argparse
import math
import os
import shutil
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from typing import TextIO

from smarttestudo.cli.arguments import duration_s, whole_number_type
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.loop_options import add_ros_arguments
from smarttestudo.cli.output import write_line, write_lines, write_styled
from smarttestudo.cli.terminal import stop_signals
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.names import is_topic_name
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.texts import visible
from smarttestudo.domain.units import grouped
from smarttestudo.language.properties import is_field_path
from smarttestudo.report.table import MISSING, format_number
from smarttestudo.robot.echo import Bounds, Echo, EchoedTopic, PlainValue, no_message_error
from smarttestudo.robot.ros import open_robot

_MOST_ON_ONE_LINE = 8
_DIGITS = 10


def echo_block(echo: Echo) -> list[str]:
    """The rates, and each value on a line of its own, by the path that ``--fields`` takes."""
    return [_rates(echo), *(f"  {line}" for line in _value_lines(echo.values))]


def echo_line(echo: Echo, *, with_all: bool) -> str:
    """The rates and values on one line; unless ``with_all``, the first few values after the header."""
    values = [line for line in _value_lines(echo.values) if with_all or not line.startswith("header.")]
    shown = values if with_all else values[:_MOST_ON_ONE_LINE]
    return "  ".join([_rates(echo), *shown, *(["…"] * (len(shown) < len(values)))])


def message_block(echo: Echo) -> list[str]:
    """One message, whole."""
    head = (
        f"{echo.topic}  {echo.type_name}  message {grouped(echo.messages)}  {grouped(echo.size_bytes or 0)} B"
    )
    return ["  ".join([head, *([echo.state] if echo.state else [])]), *_value_lines(echo.values)]


def echo_json(echo: Echo) -> str:
    """Everything as one JSON object; numbers that are not known or not finite are null."""
    record = {
        "topic": echo.topic,
        "type": echo.type_name,
        "messages": echo.messages,
        "rate_hz": None if echo.rate_hz is None else round(echo.rate_hz, 3),
        "kb_per_s": round(echo.kb_per_s, 3),
        "size_bytes": echo.size_bytes,
        "state": echo.state,
        "values": echo.values,
    }
    return json_text(record, ascii_only=False)


def _rates(echo: Echo) -> str:
    words = [echo.topic]
    if echo.messages:
        words += [
            f"{format_number(echo.rate_hz, 2)} Hz",
            f"{format_number(echo.kb_per_s, 1)} KB/s",
            f"{grouped(echo.messages)} message{'s' * (echo.messages != 1)}",
        ]
    if echo.state:
        words.append(echo.state)
    return "  ".join(words)


def _value_lines(values: Mapping[str, PlainValue] | None) -> Iterator[str]:
    for name, value in (values or {}).items():
        yield from _lines(name, value)


def _lines(path: str, value: PlainValue) -> Iterator[str]:
    if isinstance(value, dict) and value:
        for name, inner in value.items():
            yield from _lines(f"{path}.{name}", inner)
    elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
        for index, item in enumerate(value):
            # What was left out of an array is said at its end.
            yield from _lines(path if isinstance(item, str) else f"{path}[{index}]", item)
    else:
        yield f"{path}: {_text(value)}"


def _text(value: PlainValue) -> str:
    match value:
        case None:
            return MISSING
        case bool():
            return str(value).lower()
        case float():
            return format(value, f".{_DIGITS}g")
        case str():
            return value or '""'
        case list():
            return f"[{', '.join(map(_text, value))}]"
        case _:
            return str(value)


_SHOW_PERIOD_S = 1.0
_POLL_PERIOD_S = 0.2
_WAIT_S = 0.1


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Subscribe to topics, with the QoS of their publishers, and show once a second how fast "
        "and how large their messages come, and what the last one holds. Ctrl-C ends it."
    )
    parser.add_argument("topics", metavar="TOPIC", nargs="+", help="such as /testudo/odom")
    parser.add_argument(
        "--fields",
        metavar="FIELD",
        nargs="+",
        action="extend",
        default=[],
        help="only these values, by property or path: pose_x pose.pose.position.x 'ranges[0]'",
    )
    length = parser.add_mutually_exclusive_group()
    length.add_argument("--once", action="store_const", const=1, dest="count", help="the same as --count 1")
    length.add_argument(
        "--count",
        metavar="N",
        type=whole_number_type(1, math.inf, refusal="a number of messages is a whole number above 0, not {}"),
        help="print the next N messages of each topic, and end",
    )
    length.add_argument(
        "--seconds", metavar="S", type=duration_s, default=math.inf, help="end after S seconds"
    )
    parser.add_argument(
        "--timeout",
        metavar="S",
        type=duration_s,
        help="fail if a topic has no message within S seconds (default: wait)",
    )
    parser.add_argument(
        "--full-length", action="store_true", help="show all of long arrays and texts, not their beginning"
    )
    parser.add_argument("--json", action="store_true", help="one JSON object a line instead of text")
    add_ros_arguments(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Show until all is shown that was asked for, or a signal comes."""
    _require(arguments.topics, arguments.fields)
    bounds = Bounds(items=None, characters=None) if arguments.full_length else Bounds()
    with ExitStack() as opened:
        stopped = opened.enter_context(stop_signals())
        robot = opened.enter_context(open_robot(arguments.ros_args, name=f"testudo_echo_{os.getpid()}"))
        topics = [
            EchoedTopic(robot, topic, fields=arguments.fields, bounds=bounds, keep=arguments.count or 0)
            for topic in dict.fromkeys(map(robot.resolve, arguments.topics))
        ]
        wait = _Listening(robot, topics, stopped, arguments.timeout, arguments.seconds)
        if arguments.count is None:
            _show_rates(wait, topics, _shower(arguments))
        else:
            _print_messages(wait, topics, arguments)
    return 0


class _Listening:
    """Hears the topics, for as long as nothing ends it."""

    def __init__(
        self,
        robot: Robot,
        topics: Sequence[EchoedTopic],
        stopped: Callable[[], bool],
        timeout_s: float | None,
        seconds: float,
    ) -> None:
        self.is_over = self.is_time_up = False
        self._robot = robot
        self._topics = topics
        self._stopped = stopped
        self._timeout_s = timeout_s
        self._start_s = self._poll_s = time.monotonic()
        self._end_s = self._start_s + seconds

    def go_on(self) -> None:
        """Receive what comes next. Raises ``RosError`` if a topic cannot be received, or not in time."""
        now_s = time.monotonic()
        if now_s >= self._poll_s:
            self._poll_s = now_s + _POLL_PERIOD_S
            for topic in self._topics:
                topic.poll()
        errors = [topic.error for topic in self._topics if topic.error is not None]
        if len(errors) == len(self._topics):
            raise errors[0]
        if self._timeout_s is not None and now_s >= self._start_s + self._timeout_s:
            for topic in self._topics:
                if not topic.messages:
                    raise no_message_error(self._robot, topic, self._timeout_s)
        self._robot.wait(None, max(min(_WAIT_S, self._end_s - now_s), 0.0))
        self.is_time_up = time.monotonic() >= self._end_s
        self.is_over = self.is_time_up or self._stopped()


def _show_rates(
    wait: _Listening, topics: Sequence[EchoedTopic], show: Callable[[Sequence[Echo]], None]
) -> None:
    show_s = time.monotonic() + _SHOW_PERIOD_S
    while not wait.is_over:
        wait.go_on()
        if time.monotonic() >= show_s:
            show_s += _SHOW_PERIOD_S
            show([topic.echo() for topic in topics])
    # The last second may not have been whole.
    if wait.is_time_up and time.monotonic() > show_s - _SHOW_PERIOD_S / 2:
        show([topic.echo() for topic in topics])


def _shower(arguments: argparse.Namespace) -> Callable[[Sequence[Echo]], None]:
    """Function that shows the topics: in place on a terminal, line by line in a pipe."""
    if arguments.json:
        return lambda echoes: _write([echo_json(echo) for echo in echoes])
    if sys.stdout.isatty():
        show = live_lines(sys.stdout)
        return lambda echoes: show([line for echo in echoes for line in echo_block(echo)])
    note = _Notes()

    def show_lines(echoes: Sequence[Echo]) -> None:
        note.all(echoes)
        _write([echo_line(echo, with_all=bool(arguments.fields)) for echo in echoes if echo.messages])

    return show_lines


def _print_messages(wait: _Listening, topics: Sequence[EchoedTopic], arguments: argparse.Namespace) -> None:
    note, note_s = _Notes(), time.monotonic() + _SHOW_PERIOD_S
    left = arguments.count * len(topics)
    while left and not wait.is_over:
        wait.go_on()
        if time.monotonic() >= note_s:
            note_s += _SHOW_PERIOD_S
            note.all([topic.echo() for topic in topics])
        for echo in (echo for topic in topics for echo in topic.take_kept()):
            _write([echo_json(echo)] if arguments.json else [*message_block(echo), ""])
            left -= 1


class _Notes:
    """Writes to standard error why a topic is not received, each reason once."""

    def __init__(self) -> None:
        self._said: dict[str, str] = {}

    def all(self, echoes: Sequence[Echo]) -> None:
        for echo in echoes:
            if echo.state != self._said.get(echo.topic, ""):
                self._said[echo.topic] = echo.state
                if echo.state:
                    write_line(f"note: {echo.topic}: {echo.state}", sys.stderr)


def _write(lines: Sequence[str]) -> None:
    write_lines(lines)
    sys.stdout.flush()


def _require(topics: Sequence[str], fields: Sequence[str]) -> None:
    for topic in topics:
        if not is_topic_name(topic):
            raise UsageError(f"{topic!r} is not a topic's name", remedy="write it as in /testudo/odom")
    for field in fields:
        if not is_field_path(field):
            remedy = "write it as in pose.pose.position.x or ranges[0]"
            raise UsageError(f"{field!r} is not a field", place="--fields", remedy=remedy)


_ERASE_TO_END_OF_LINE = "\x1b[K"
_ERASE_BELOW = "\x1b[J"


def live_lines(stream: TextIO) -> Callable[[Sequence[str]], None]:
    """Function that writes lines to the terminal ``stream`` in place of those of the last call."""
    shown = 0

    def show(lines: Sequence[str]) -> None:
        nonlocal shown
        fitting = cropped([*map(visible, lines)], *shutil.get_terminal_size())
        up = f"\x1b[{shown}A\r" if shown else ""
        text = "".join(f"{_ERASE_TO_END_OF_LINE}{line}\n" for line in fitting)
        write_styled(f"{up}{text}{_ERASE_BELOW}", stream)
        stream.flush()
        shown = len(fitting)

    return show


def cropped(lines: Sequence[str], columns: int, height: int) -> list[str]:
    """As many ``lines`` as fit above the cursor, none too long; the last says how many are missing."""
    rows = max(height - 1, 1)
    if len(lines) > rows:
        lines = [*lines[: rows - 1], f"… {len(lines) - rows + 1} more lines: a taller window, or --fields"]
    return [line if len(line) < columns else line[: max(columns - 2, 0)] + "…" for line in lines]
