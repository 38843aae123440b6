# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The table of ``testudo top``, printed or redrawn in place."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import timedelta
from enum import Enum
from pathlib import Path
from textwrap import wrap

from smarttestudo.cli.output import write_lines
from smarttestudo.cli.terminal import is_unicode
from smarttestudo.domain.decision import Reason, bound_texts
from smarttestudo.domain.health import LOST_BEFORE_RELAY, Health, robot_problems, topic_health
from smarttestudo.domain.incident import IncidentState
from smarttestudo.domain.link import StreamCounts
from smarttestudo.domain.robot import DiagnosticLevel
from smarttestudo.domain.status import RulesInForce, RuntimeStatus, Silence, TopicStatus
from smarttestudo.domain.texts import visible
from smarttestudo.domain.units import counted, grouped
from smarttestudo.report.table import (
    WHOLE,
    Column,
    Table,
    Value,
    decimals,
    format_number,
    plain_table,
)
from smarttestudo.robot.diagnostics import accepted_text, recording_text

WIDE = 110
_QUIET = frozenset({Silence.OFF, Silence.NO_SUBSCRIBER})


class Style(Enum):
    """How a line is to be shown where colours are."""

    HEADING = "heading"
    PLAIN = "plain"
    QUIET = "quiet"
    WARN = "warn"
    ERROR = "error"
    STALE = "stale"


class SortKey(Enum):
    """Key that topics are ordered by: the name upwards, numbers downwards."""

    TOPIC = "topic"
    SOURCE = "source"
    TARGET = "target"
    ACTUAL = "actual"
    ERROR = "error"
    OUT = "out"


@dataclass(frozen=True, slots=True)
class Line:
    """One line of the screen."""

    text: str
    style: Style = Style.PLAIN


_LEVEL_STYLES = {
    DiagnosticLevel.OK: Style.PLAIN,
    DiagnosticLevel.WARN: Style.WARN,
    DiagnosticLevel.ERROR: Style.ERROR,
    DiagnosticLevel.STALE: Style.STALE,
}
_MEASURES: dict[SortKey, Callable[[TopicStatus], float | None]] = {
    SortKey.SOURCE: lambda topic: topic.source_hz,
    SortKey.TARGET: lambda topic: topic.target_hz,
    SortKey.ACTUAL: lambda topic: topic.actual_hz,
    SortKey.ERROR: lambda topic: None if topic.error_percent is None else abs(topic.error_percent),
    SortKey.OUT: lambda topic: topic.out_kb_per_s,
}


def summary_lines(
    status: RuntimeStatus, *, silent_s: float | None = None, width: int | None = None
) -> list[Line]:
    """The runtime itself, the link, what is wrong, what is accepted of operators, and what recording costs.

    ``silent_s`` is the time without a status, if it is too long.
    """
    recording = status.incidents
    return [
        Line(_runtime(status), Style.HEADING),
        Line(_link(status)),
        *(line for one in robot_problems(status, silent_s) for line in _problem_lines(one, width)),
        *_waiting(status.rules),
        *(
            Line(
                f"accepts {topic.topic}: {accepted_text(topic)}", Style.WARN if topic.problem else Style.PLAIN
            )
            for topic in status.accepted
        ),
        *([] if recording is None else [_recording(recording)]),
    ]


def _problem_lines(problem: Health, width: int | None) -> Iterator[Line]:
    text = visible(problem.message)
    lines = [text] if width is None else wrap(text, width, subsequent_indent="  ", break_on_hyphens=False)
    yield from (Line(line, _LEVEL_STYLES[problem.level]) for line in lines)


def topic_lines(status: RuntimeStatus, sort: SortKey, width: int | None = None) -> list[Line]:
    """Headings, a rule, and one line for each topic; at most ``width`` wide where that is possible.

    Where nobody subscribes to any of them, a last line says how to.
    """
    is_wide = width is None or width >= WIDE
    topics = _sorted(status, sort)
    table = Table(columns=tuple(_columns(status, is_wide=is_wide)), rows=topics)
    lines = plain_table(table, width=width).split("\n")
    heading_lines = len(lines) - len(topics)
    return [
        *(Line(text, Style.HEADING) for text in lines[:heading_lines]),
        *(Line(text, _style(topic)) for text, (_, topic) in zip(lines[heading_lines:], topics, strict=True)),
        *_how_to_subscribe(status, topics),
    ]


def _how_to_subscribe(status: RuntimeStatus, topics: Sequence[tuple[str, TopicStatus]]) -> list[Line]:
    """How to get a subscriber; empty for a robot with a link, whose operator's end is one."""
    ready = [topic.output for _, topic in topics if topic.silence is Silence.NO_SUBSCRIBER]
    if not ready or status.link is not None or any(topic.subscribers for _, topic in topics):
        return []
    return [Line(f"A relay runs while somebody subscribes to it, as testudo echo {ready[0]} does.")]


def _runtime(status: RuntimeStatus) -> str:
    rules = ", ".join(Path(path).name for path in status.rules.paths) or "no rules"
    return (
        f"{status.robot_id}   {rules}   up {timedelta(seconds=int(status.uptime_s))}"
        f"   CPU {format_number(status.cpu_percent, 1)} %   {format_number(status.memory_mb, 0)} MB"
    )


def _waiting(rules: RulesInForce) -> list[Line]:
    """Which rules come back, while pushed ones wait to be confirmed."""
    if rules.waits_s is None:
        return []
    text = f"pushed rules: those before come back in {rules.waits_s:.0f} s, unless they are confirmed"
    return [Line(text, Style.WARN)]


def _link(status: RuntimeStatus) -> str:
    text = (
        f"in {format_number(status.in_kb_per_s, 1)} KB/s   out {format_number(status.out_kb_per_s, 1)} KB/s"
    )
    budget_kb_per_s = status.budget_kb_per_s
    if budget_kb_per_s is None:
        limit = "no budget" if status.link is None else "not limited"
        return f"{text}, {limit}{_capacity(status)}"
    share = f" ({100 * status.out_kb_per_s / budget_kb_per_s:.0f} %)" if budget_kb_per_s else ""
    return f"{text} of {format_number(budget_kb_per_s, 1)}{share}{_capacity(status)}"


def _capacity(status: RuntimeStatus) -> str:
    """How the link to the operator does, if there is one."""
    link = status.link
    if link is None or not link.is_connected:
        return ""
    capacity = (
        "not the limit" if link.capacity_kb_per_s is None else f"{grouped(link.capacity_kb_per_s, 1)} KB/s"
    )
    trip = "" if link.round_trip_ms is None else f", round trip {link.round_trip_ms:.0f} ms"
    lost = "" if link.lost_percent is None else f", datagrams: {link.lost_percent:.1f} % lost"
    mb_an_hour = status.mb_an_hour(link.sent_bytes + link.report_bytes)
    hourly = "" if mb_an_hour is None else f", {grouped(mb_an_hour, 1)} MB/h"
    return f"   link: {capacity}{trip}, {counted(link.outages, 'outage')}{lost}{hourly}"


def _recording(state: IncidentState) -> Line:
    # What keeps it from recording is a problem of the node, and said there.
    return Line(f"records {recording_text(replace(state, problem=None))}")


def _sorted(status: RuntimeStatus, sort: SortKey) -> list[tuple[str, TopicStatus]]:
    topics = sorted(status.topics.items(), key=lambda entry: entry[0])
    measure = _MEASURES.get(sort)
    if measure is None:
        return topics
    return sorted(topics, key=lambda entry: _or_least(measure(entry[1])), reverse=True)


def _or_least(number: float | None) -> float:
    return -math.inf if number is None else number


def _columns(status: RuntimeStatus, *, is_wide: bool) -> Iterator[Column[tuple[str, TopicStatus]]]:
    yield Column("Topic", "", _name, is_text=True)
    yield Column("Source", "Hz", lambda row: row[1].source_hz)
    yield Column("Target", "Hz", lambda row: _target(row[1].target_hz))
    yield Column("Actual", "Hz", lambda row: row[1].actual_hz)
    yield Column("Error", "%", lambda row: row[1].error_percent, decimals(2, signed=True))
    if is_wide:
        yield Column("In", "KB/s", lambda row: row[1].in_kb_per_s, decimals(1))
    yield Column("Out", "KB/s", lambda row: row[1].out_kb_per_s, decimals(1))
    if status.link is not None:
        yield Column("Age", "ms", lambda row: row[1].on_link.age_ms if row[1].on_link else None, WHOLE)
        if is_wide:
            yield from _link_columns(status)
    if is_wide:
        yield Column("Rule", "", lambda row: _rule(row[1]), is_text=True)
        yield Column("State", "", lambda row: _state(row[1]), is_text=True)
    else:
        yield Column("Rule, or state", "", lambda row: _problem(row[1]) or _rule(row[1]), is_text=True)


def _link_columns(status: RuntimeStatus) -> Iterator[Column[tuple[str, TopicStatus]]]:
    """Columns of what each topic takes of the link, and of what the radio lost."""

    def counts(row: tuple[str, TopicStatus]) -> StreamCounts:
        return StreamCounts() if row[1].on_link is None else row[1].on_link.counts

    yield Column("Link", "MB/h", lambda row: status.mb_an_hour(counts(row).sent_bytes), decimals(1))
    all_counts = [counts(row) for row in status.topics.items()]
    if any(one.repaired or one.lost for one in all_counts):
        yield Column("Repaired", "", lambda row: counts(row).repaired, WHOLE)
        yield Column("Lost", "", lambda row: counts(row).lost, WHOLE)


def _name(row: tuple[str, TopicStatus]) -> str:
    source, topic = row
    return source if topic.frames is None or topic.frames == 1 else f"{source} ({topic.frames} streams)"


def _target(target_hz: float) -> Value:
    if math.isinf(target_hz):
        return "Full"
    return target_hz or "Off"


def _problem(topic: TopicStatus) -> str:
    """The state in a word or two; nothing for a topic that is well."""
    health = topic_health(topic)
    is_well = topic.silence is None and health.level is DiagnosticLevel.OK
    return "" if is_well else health.summary


def _state(topic: TopicStatus) -> str:
    problem = _problem(topic)
    if topic.loss is not None and problem == LOST_BEFORE_RELAY:
        # What to do about it is said above.
        return f"{problem}: {topic.loss.percent:.0f} %"
    return problem and topic_health(topic).message


def _rule(topic: TopicStatus) -> str:
    """Reason for the rate, then those for the bounds."""
    rate = f"{topic.reason.value}: {topic.rule}"
    if topic.rule is None:
        rate = topic.reason.value
    elif topic.reason is Reason.BLOCK:
        rate = topic.rule
    return "; ".join([rate, *bound_texts(topic.within, topic.bound_reasons)])


def _style(topic: TopicStatus) -> Style:
    return Style.QUIET if topic.silence in _QUIET else _LEVEL_STYLES[topic_health(topic).level]


Show = Callable[[Sequence[Line]], None]

_RICH_STYLES = {
    Style.HEADING: "bold",
    Style.PLAIN: "",
    Style.QUIET: "dim",
    Style.WARN: "yellow",
    Style.ERROR: "bold red",
    Style.STALE: "magenta",
}


@contextmanager
def open_screen() -> Iterator[Show]:
    """Open a display of lines on standard output; a terminal's own content is back at the end."""
    if sys.stdout.isatty() and is_unicode(sys.stdout):
        try:
            import rich.live  # noqa: F401, PLC0415  a robot has no rich
        except ModuleNotFoundError:
            pass
        else:
            with _rich_screen() as show:
                yield show
            return
    yield print_lines


def print_lines(lines: Sequence[Line]) -> None:
    """Write ``lines`` and an empty one to standard output."""
    write_lines([*(line.text for line in lines), ""])
    sys.stdout.flush()


@contextmanager
def _rich_screen() -> Iterator[Show]:
    from rich.console import Console  # noqa: PLC0415
    from rich.live import Live  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    console = Console(highlight=False, markup=False, emoji=False)
    with Live(console=console, screen=True, auto_refresh=False) as live:

        def show(lines: Sequence[Line]) -> None:
            text = Text(no_wrap=True, overflow="ellipsis")
            for line in cropped(lines, console.height):
                text.append(f"{visible(line.text)}\n", style=_RICH_STYLES[line.style])
            text.right_crop(1)
            live.update(text, refresh=True)

        yield show


def cropped(lines: Sequence[Line], height: int) -> Sequence[Line]:
    """``lines``, as many as fit; the last one says how many are missing."""
    if len(lines) <= height:
        return lines
    hidden = len(lines) - height + 1
    return [*lines[: height - 1], Line(f"… {hidden} more lines: a taller window, or --sort", Style.QUIET)]
