# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The report over many recordings as one HTML document."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from smarttestudo.domain.units import counted, grouped
from smarttestudo.report.document import html_document
from smarttestudo.report.fleet.recording_numbers import RecordingNumbers
from smarttestudo.report.fleet.sums import Sums, of_recording
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
from smarttestudo.report.fleet.totals import FleetTotals, Lines
from smarttestudo.report.fleet.trend_section import trend_section
from smarttestudo.report.headline import Bar, bars, kept_together
from smarttestudo.report.markup import Child, Markup, html_table, name_parts, tag
from smarttestudo.report.run_report import Fact
from smarttestudo.report.scripts import many_script
from smarttestudo.report.sections import provenance_section, section
from smarttestudo.report.summary import time_text, volume_text
from smarttestudo.report.table import percent_text

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
    script = many_script()
    main = tag("main", *_parts(report))
    return html_document(report.title, main, tag("script", Markup(script)), script=script)


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
    told: list[Child] = [" ".join(_worst_sentences(totals))]
    if totals.failures.count:
        told += [" ", tag("a", "What could not be read, and what helps.", href=f"#{_UNREADABLE}")]
    return tag(
        "header",
        tag("h1", report.title, class_="words"),
        tag("p", kept_together(sentence(totals)), class_="lead"),
        tag("p", *told, class_="explanation words"),
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
    names = [_name(one, report.own_report(one)) for one in report.totals.worst]
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
