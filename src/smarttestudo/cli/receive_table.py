# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What ``testudo receive`` shows on a terminal."""

from __future__ import annotations

from smarttestudo.cli.top_table import Line, Look
from smarttestudo.use_cases.receive.reception import ReceivedRobot, Reception
from smarttestudo.visualizer.table import Align, Column, Number, Row, Table, Text, plain_table, printable

_COLUMNS = (
    Column(heading="Topic", align=Align.LEFT),
    Column(heading="Rate", unit="Hz"),
    Column(heading="In", unit="KB/s"),
    Column(heading="Age", unit="ms"),
    Column(heading="Messages"),
    Column(heading="Type", align=Align.LEFT),
)


def reception_lines(reception: Reception, width: int | None = None) -> list[Line]:
    """Each robot with its topics, as of the last look."""
    lines: list[Line] = []
    for name, robot in sorted(reception.robots.items()):
        lines += [Line("")] * bool(lines)
        lines += [_heading(name, robot), Line(""), *_topics(robot, width)]
    return lines or [Line("Waiting for a robot: start 'testudo run --link' there.", Look.QUIET)]


def _heading(name: str, robot: ReceivedRobot) -> Line:
    total = sum(topic.meter.kb_per_s for topic in robot.topics.values())
    if not robot.boots:
        return Line(printable(f"{name}   not connected"), Look.ERROR)
    twice = f"   {len(robot.boots)} robots have this name" if len(robot.boots) > 1 else ""
    look = Look.WARN if twice else Look.HEADING
    return Line(printable(f"{name}   {total:.1f} KB/s of messages{twice}"), look)


def _topics(robot: ReceivedRobot, width: int | None) -> list[Line]:
    topics = sorted(robot.topics.items())
    rows = tuple(
        Row(
            cells=(
                Text(name),
                Number(topic.meter.rate_hz),
                Number(topic.meter.kb_per_s, decimals=1),
                Number(topic.age_ms, decimals=0),
                Number(topic.flow.messages, decimals=0),
                Text(topic.type_name),
            )
        )
        for name, topic in topics
    )
    lines = plain_table(Table(title="", columns=_COLUMNS, rows=rows), width=width).split("\n")
    heading_lines = len(lines) - len(topics)
    looks = [Look.HEADING] * heading_lines
    looks += [Look.STALE if topic.meter.is_silent else Look.PLAIN for _, topic in topics]
    return [Line(text, look) for text, look in zip(lines, looks, strict=True)]
