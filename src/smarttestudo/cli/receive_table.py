# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Table that ``testudo receive`` shows on a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.cli.top_table import Line, Style
from smarttestudo.link.receive.reception import ReceivedRobot, ReceivedTopic, Reception
from smarttestudo.link.receive.sending import CommandRoute
from smarttestudo.report.table import (
    Align,
    Column,
    Number,
    Row,
    Table,
    Text,
    plain_table,
)

_COLUMNS = (
    Column(heading="Topic", align=Align.LEFT),
    Column(heading="Rate", unit="Hz"),
    Column(heading="In", unit="KB/s"),
    Column(heading="Age", unit="ms"),
    Column(heading="Messages"),
    Column(heading="Type", align=Align.LEFT),
)
_PREDICTED = Column(heading="Predicted")
_STATE = Column(heading="State", align=Align.LEFT)

_SENT_COLUMNS = (
    Column(heading="Sent topic", align=Align.LEFT),
    Column(heading="Robot", align=Align.LEFT),
    Column(heading="Sent"),
    Column(heading="Dropped"),
    Column(heading="Delivered"),
    Column(heading="Too old"),
    Column(heading="Age", unit="ms"),
    Column(heading="State", align=Align.LEFT),
)


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
    topics = sorted(robot.topics.items())
    predicts = any(topic.predicted for _, topic in topics)
    has_state = any(topic.problem for _, topic in topics)
    rows = tuple(
        Row(
            cells=(
                Text(name),
                Number(topic.meter.rate_hz),
                Number(topic.meter.kb_per_s, decimals=1),
                Number(topic.age_ms, decimals=0),
                Number(topic.flow.messages, decimals=0),
                *([Number(topic.predicted, decimals=0)] * predicts),
                Text(topic.type_name),
                *([Text(topic.problem or "")] * has_state),
            )
        )
        for name, topic in topics
    )
    columns = (*_COLUMNS[:-1], *([_PREDICTED] * predicts), _COLUMNS[-1], *([_STATE] * has_state))
    lines = plain_table(Table(title="", columns=columns, rows=rows), width=width).split("\n")
    heading_lines = len(lines) - len(topics)
    styles = [Style.HEADING] * heading_lines
    styles += [_topic_style(topic) for _, topic in topics]
    return [Line(text, style) for text, style in zip(lines, styles, strict=True)]


def _topic_style(topic: ReceivedTopic) -> Style:
    if topic.problem is not None:
        return Style.WARN
    return Style.STALE if topic.meter.is_silent else Style.PLAIN


def _sent(routes: Sequence[CommandRoute], width: int | None) -> list[Line]:
    rows = tuple(
        Row(
            cells=(
                Text(route.source),
                Text(route.boot.robot),
                Number(route.counts.sent, decimals=0),
                Number(_dropped(route), decimals=0),
                Number(route.told.delivered, decimals=0),
                Number(route.told.too_old, decimals=0),
                Number(route.told.age_ms, decimals=0),
                Text(route.problem or ""),
            )
        )
        for route in routes
    )
    lines = plain_table(Table(title="", columns=_SENT_COLUMNS, rows=rows), width=width).split("\n")
    styles = [Style.HEADING] * (len(lines) - len(routes))
    styles += [_style(route) for route in routes]
    return [Line(text, style) for text, style in zip(lines, styles, strict=True)]


def _dropped(route: CommandRoute) -> int:
    """Messages that never left, most of them because a newer one did."""
    counts = route.counts
    return counts.replaced + counts.expired + counts.too_large + route.suspect


def _style(route: CommandRoute) -> Style:
    if route.problem is None:
        return Style.PLAIN
    return Style.QUIET if route.is_quiet else Style.WARN
