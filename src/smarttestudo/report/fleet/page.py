# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The report over many recordings as one HTML document."""

from __future__ import annotations

from calendar import month_abbr
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import date, timedelta
from operator import attrgetter

from smarttestudo.domain.units import counted, grouped
from smarttestudo.report.fleet.numbers import RecordingNumbers, Sums, of_recording
from smarttestudo.report.fleet.tables import (
    bound_table,
    cost_percent,
    recording_table,
    robot_table,
    rule_table,
    share_text,
    topic_table,
    worst,
)
from smarttestudo.report.fleet.totals import FleetTotals, Lines, Step, TrendColumn
from smarttestudo.report.markup import Child, Markup, html_table, name_parts, tag
from smarttestudo.report.page import (
    MANY_SCRIPTS,
    Bar,
    bars,
    figure,
    html_document,
    kept_together,
    provenance_section,
    section,
    topic_name,
)
from smarttestudo.report.run_report import Fact, Series, SeriesPoint
from smarttestudo.report.summary import time_text, volume_text, volume_unit
from smarttestudo.report.table import percent_text
from smarttestudo.report.time_chart import MOST_LAYERS, ChartStretch, Layer, TimeChart, value_heights
from smarttestudo.report.time_drawing import SMALL, WIDE, Frame, draw_chart, layer_legend

_MOST_SMALL = 6
_SIDES = (0.08, 0.92)
"""The sides of a column, of which each takes a stretch of 1."""
_POINTS_OF_A_COLUMN = 4
_EACH = {Step.RECORDING: "of each recording", Step.HOUR: "an hour", Step.DAY: "a day"}
_YEAR = timedelta(days=300)
_COUNTS = ((1_000_000, "million"), (10_000, "thousand"))

SumsBy = Callable[[TrendColumn], Mapping[str, Sums]]
"""Sums of a column by topic or by robot."""
_by_topic: SumsBy = attrgetter("topics")
_by_robot: SumsBy = attrgetter("robots")


def trend_section(totals: FleetTotals) -> Iterator[Markup]:
    """Bytes, messages and losses over time; nothing where there is but one column."""
    columns = totals.trend.columns()
    if len(columns) < 2:
        return
    cost = "Received bytes" if totals.are_pairs else "Bytes"
    each = _EACH[totals.trend.step]
    yield section(
        "Over time",
        *_stacked(totals, columns, f"{cost} {each}, by topic", _by_topic, is_bytes=True),
        *(
            _stacked(totals, columns, f"{cost} {each}, by robot", _by_robot, is_bytes=True)
            if totals.robots
            else ()
        ),
        *_stacked(totals, columns, f"Messages of the robots {each}, by topic", _by_topic, is_bytes=False),
        explanation=_explanation(totals, columns),
    )
    if totals.all.lost:
        yield section(
            "Lost messages over time",
            *_small(totals, columns, "of each topic", totals.topics, _by_topic),
            *_small(totals, columns, "of each robot", totals.robots, _by_robot),
            explanation="In percent of the messages of topics that both have, those with the most lost ones.",
        )


def _explanation(totals: FleetTotals, columns: Sequence[TrendColumn]) -> str:
    step = totals.trend.step
    if step is Step.DAY:
        most = max(len(column.steps) for column in columns)
        stands = f"the mean of at most {grouped(most)} days" if most > 1 else "a day"
        return f"Each column is {stands} on which recordings began, in UTC. Days without one are left out."
    if step is Step.HOUR:
        return f"Each column is an hour of {totals.trend.day} in which recordings began, in UTC."
    return f"Each column is a recording of {totals.trend.day}, by the time in UTC at which it began."


def _cost_bytes(totals: FleetTotals, sums: Sums) -> int:
    return sums.received_bytes if totals.are_pairs else sums.size_bytes


def _stacked(
    totals: FleetTotals, columns: Sequence[TrendColumn], name: str, sums_by: SumsBy, *, is_bytes: bool
) -> Iterator[Markup]:
    """The parts of the largest topics or robots in each column, and of all others together."""
    whole: dict[str, float] = {}
    of_columns: list[dict[str, float]] = []
    for column in columns:
        amounts = {
            key: _cost_bytes(totals, sums) if is_bytes else sums.messages
            for key, sums in sums_by(column).items()
        }
        of_columns.append({key: value / len(column.steps) for key, value in amounts.items()})
        for key, value in amounts.items():
            whole[key] = whole.get(key, 0.0) + value
    ranked = sorted((key for key in whole if whole[key]), key=lambda key: (-whole[key], key))
    if not ranked:
        return
    most = MOST_LAYERS if len(ranked) > MOST_LAYERS + 1 else len(ranked)
    own, rest = ranked[:most], ranked[most:]
    parts = {key or "Robot not known": [of_column.get(key, 0.0) for of_column in of_columns] for key in own}
    texts = {key or "Robot not known": whole[key] for key in own}
    if rest:
        others = f"{len(rest)} others"
        parts[others] = [sum(of_column.get(key, 0.0) for key in rest) for of_column in of_columns]
        texts[others] = sum(whole[key] for key in rest)
    highest = max(map(sum, zip(*parts.values(), strict=True)))
    if is_bytes:
        unit_size, unit = volume_unit(highest)
    else:
        unit_size, unit = next((count_unit for count_unit in _COUNTS if highest >= count_unit[0]), (1, ""))
    layers = tuple(
        Layer(name=key, points=_steps([value / unit_size for value in values]))
        for key, values in parts.items()
    )
    chart = TimeChart(
        name=name,
        meaning=f"{name}, over time",
        unit=unit,
        duration_s=len(columns),
        heights=value_heights(highest / unit_size, None),
        layers=layers,
        stretches=_stretches(totals, columns),
    )
    yield tag("h3", name)
    in_words = volume_text if is_bytes else grouped
    yield layer_legend(layers, lambda layer: in_words(texts[layer.name]))
    yield figure(_drawn(chart, WIDE))


def _small(
    totals: FleetTotals, columns: Sequence[TrendColumn], name: str, of: Mapping[str, Sums], sums_by: SumsBy
) -> Iterator[Markup]:
    """A small chart of the lost share of each topic or robot that lost most, on one scale."""
    shown = [key for key, sums in worst(totals, of)[0] if sums.lost][:_MOST_SMALL]
    shares = {key: [(sums_by(column).get(key) or Sums()).lost_percent for column in columns] for key in shown}
    highest = max((share or 0.0 for values in shares.values() for share in values), default=0.0)
    if not shown:
        return
    charts = []
    for key, values in shares.items():
        chart = TimeChart(
            name=key,
            meaning=f"Lost messages of {key} over time, in percent",
            unit="%",
            duration_s=len(columns),
            heights=value_heights(highest, None),
            layers=(Layer(name=key, points=_steps([share or 0.0 for share in values])),),
            stretches=tuple(
                ChartStretch(
                    label=_label(totals, columns, number), meaning=f"{_when(column)}: {share_text(share)}"
                )
                for number, (column, share) in enumerate(zip(columns, values, strict=True))
            ),
        )
        lost = tag("span", share_text(of[key].lost_percent), class_="quiet")
        charts.append(figure(_drawn(chart, SMALL), topic_name(key), lost))
    yield tag("h3", name.capitalize())
    yield tag("div", *charts, class_="charts")


def _drawn(chart: TimeChart, frame: Frame) -> Markup:
    return draw_chart(chart, frame, _POINTS_OF_A_COLUMN * len(chart.stretches))


def _steps(values: Sequence[float]) -> Series:
    """A column of each value, with gaps between them."""
    points = []
    for number, value in enumerate(values):
        left, right = (number + side for side in _SIDES)
        for t_s, height in ((left, 0.0), (left, value), (right, value), (right, 0.0)):
            points.append(SeriesPoint(t_s=t_s, lowest=height, mean=height, highest=height))
    return tuple(points)


def _stretches(totals: FleetTotals, columns: Sequence[TrendColumn]) -> tuple[ChartStretch, ...]:
    return tuple(
        ChartStretch(label=_label(totals, columns, number), meaning=_meaning(totals, column))
        for number, column in enumerate(columns)
    )


def _label(totals: FleetTotals, columns: Sequence[TrendColumn], number: int) -> str:
    """The time of a column: of a day the month, too, and of more than a year of them the year."""
    first = columns[number].first
    if totals.trend.step is not Step.DAY:
        return first
    day, begin, end = (
        date.fromisoformat(day_text) for day_text in (first, columns[0].first, columns[-1].last)
    )
    month = month_abbr[day.month]
    return f"{day.day} {month}" if end - begin < _YEAR else f"{month} {day.year}"


def _when(column: TrendColumn) -> str:
    return column.first if column.first == column.last else f"{column.first} to {column.last}"


def _meaning(totals: FleetTotals, column: TrendColumn) -> str:
    sums = column.total
    parts = [
        counted(sums.recordings, "recording"),
        volume_text(_cost_bytes(totals, sums)),
        counted(sums.messages, "message"),
    ]
    if sums.lost_percent is not None:
        parts.append(f"{share_text(sums.lost_percent)} lost")
    return f"{_when(column)}: {', '.join(parts)}"


_UNREADABLE = "unreadable"


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnReport:
    """The command that makes the report of a recording alone, and the name of its file beside this page.

    ``is_made``: the file is there.
    """

    command: str
    file_name: str
    is_made: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class FleetReport:
    """The contents of the page; ``own_report`` is asked for the recordings that it lists."""

    title: str
    totals: FleetTotals
    own_report: Callable[[RecordingNumbers], OwnReport]
    provenance: tuple[Fact, ...] = ()


def render_fleet_report(report: FleetReport) -> str:
    """One HTML document that needs nothing else, and whose size is bounded; see ``render_report``."""
    return html_document(report.title, tag("main", *_parts(report)), scripts=MANY_SCRIPTS)


def sentence(totals: FleetTotals) -> str:
    """The recordings in numbers, and what was lost of them."""
    parts = [counted(totals.all.recordings, "recording")]
    if totals.robots:
        parts.append(counted(len(totals.robots), "robot"))
    parts += [time_text(totals.all.duration_s), volume_text(totals.all.size_bytes)]
    lost = totals.all.lost_percent
    if lost is not None:
        parts.append(f"{percent_text(lost)} lost")
    if totals.failures.count:
        parts.append(f"{grouped(totals.failures.count)} unreadable")
    return ", ".join(parts)


def _parts(report: FleetReport) -> Iterator[Markup]:
    totals = report.totals
    yield _opening(report)
    yield from trend_section(totals)
    if totals.topics:
        yield section("Topics", html_table(topic_table(totals)))
    if totals.robots:
        yield section("Robots", html_table(robot_table(totals)))
    if totals.rules:
        yield section("Rules", html_table(rule_table(totals)))
    if totals.bounds:
        yield section("Bounds of the rules", html_table(bound_table(totals)))
    if totals.all.recordings:
        yield _recordings(report)
    if totals.failures.count:
        lines = _lines(totals.failures, "recording")
        yield tag("section", tag("h2", "Could not be read", id=_UNREADABLE), *lines)
    if totals.notices.count:
        yield section("Good to know", *_lines(totals.notices, "note"))
    if report.provenance:
        yield provenance_section(report.provenance)


def _opening(report: FleetReport) -> Markup:
    totals = report.totals
    words: list[Child] = [" ".join(_worst_sentences(totals))]
    if totals.failures.count:
        words += [" ", tag("a", "What could not be read, and what helps.", href=f"#{_UNREADABLE}")]
    return tag(
        "header",
        tag("h1", report.title, class_="words"),
        tag("p", kept_together(sentence(totals)), class_="lead"),
        tag("p", *words, class_="explanation words"),
        *([_bars(totals)] if totals.are_pairs else []),
    )


def _bars(totals: FleetTotals) -> Markup:
    values = (
        ("Recorded by robots", totals.all.size_bytes, "run-before"),
        ("Received", totals.all.received_bytes, "run-after"),
    )
    return bars(
        [Bar(name=name, value=size, text=volume_text(size), css_class=style) for name, size, style in values]
    )


def _worst_sentences(totals: FleetTotals) -> Iterator[str]:
    """Names what lost and cost most."""
    if not totals.all.recordings:
        return
    if totals.all.lost:
        names = [f"of {_first(totals, totals.topics)}"]
        if len(totals.robots) > 1:
            names.append(f"on {_first(totals, totals.robots)}")
        if totals.all.recordings > 1:
            one = totals.worst[0]
            names.append(f"in {one.a} ({share_text(of_recording(one).lost_percent)})")
        yield f"Most messages were lost {_and(names)}."
    costly = max(
        totals.topics.items(), key=lambda one: (cost_percent(totals, one[1]) or 0.0, one[0]), default=None
    )
    if costly is not None and cost_percent(totals, costly[1]):
        share = percent_text(cost_percent(totals, costly[1]), decimals=0)
        yield f"{costly[0]} cost most: {share} of the bytes{' received' if totals.are_pairs else ''}."
    named = {name: sums for name, sums in totals.rules.items() if name}
    if named:
        name, rule = worst(totals, named)[0][0]
        if rule.lost:
            yield f"Of the rules, “{name}” lost most ({share_text(rule.lost_percent)})."
        elif not totals.are_pairs:
            yield f"Of the rules, “{name}” cost most ({volume_text(rule.size_bytes)})."


def _first(totals: FleetTotals, of: dict[str, Sums]) -> str:
    name, sums = worst(totals, of)[0][0]
    return f"{name} ({share_text(sums.lost_percent)})"


def _and(parts: Sequence[str]) -> str:
    *others, last = parts
    return f"{', '.join(others)} and {last}" if others else last


def _lines(lines: Lines, noun: str) -> Iterator[Markup]:
    more = lines.count - len(lines.first)
    yield tag("ul", *(tag("li", line, class_="words") for line in lines.first))
    if more:
        yield tag(
            "p", f"… and {counted(more, f'more {noun}')}; standard error has named them.", class_="note"
        )


def _recordings(report: FleetReport) -> Markup:
    names = [_name(recording, report.own_report(recording)) for recording in report.totals.worst]
    explanation = (
        "“Its report” has the command that makes the report of that recording alone, beside this page. A "
        "name is a link where that report lay there when this page was made."
    )
    return section("Recordings", html_table(recording_table(report.totals), names), explanation=explanation)


def _name(recording: RecordingNumbers, own: OwnReport) -> Markup:
    text = name_parts(recording.a)
    name = tag("a", *text, href=own.file_name) if own.is_made else tag("span", *text)
    command = tag("code", own.command, class_="command")
    return tag("div", name, tag("details", tag("summary", "Its report"), command), class_="recording")
