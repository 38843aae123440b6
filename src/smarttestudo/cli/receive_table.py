# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Table that ``testudo receive`` shows on a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from smarttestudo.cli.top_table import Line, Style
from smarttestudo.link.receive.reception import ReceivedRobot, ReceivedTopic, Reception
from smarttestudo.link.receive.sending import CommandRoute
from smarttestudo.report.table import WHOLE, Column, Table, decimals, plain_table


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
            Column("Delivered", "", lambda route: route.told.delivered, WHOLE),
            Column("Too old", "", lambda route: route.told.too_old, WHOLE),
            Column("Age", "ms", lambda route: route.told.age_ms, WHOLE),
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
