# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The decisions of a run, as a list and a section."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smarttestudo.domain.decision import Decision, Reason
from smarttestudo.domain.units import grouped
from smarttestudo.report.axes import label
from smarttestudo.report.decision_chart import Lane, decision_chart
from smarttestudo.report.markup import Markup, name_parts, tag
from smarttestudo.report.rule_timeline import DEFAULTS, RuleStyles, deciding_block
from smarttestudo.report.run_report import RuleText, RunReport
from smarttestudo.report.sections import section
from smarttestudo.report.table import format_number

MAX_DECISIONS = 200
_DIGITS = 5
_HEADINGS = ("Time", "Topic", "Rate", "Decided by, and what it read")
_NOTES = {
    Reason.UNKNOWN: "unknown",
    Reason.FLOOR: "KeepAtLeast",
    Reason.BUDGET: "budget",
    Reason.LINK: "link",
    Reason.FALLBACK: "fallback",
    Reason.RELOAD: "reload",
}


def decision_list(decisions: Sequence[Decision], styles: RuleStyles) -> Markup:
    """The first ``MAX_DECISIONS`` decisions, and how many more there are."""
    shown = decisions[:MAX_DECISIONS]
    more = len(decisions) - len(shown)
    note = [tag("p", f"… and {grouped(more)} more in the decisions file.", class_="note")] if more else []
    head = (
        tag("th", heading, *_unit(heading), class_="right" if heading == "Time" else "left", scope="col")
        for heading in _HEADINGS
    )
    rows = (
        _row(decision, styles, is_first=before is None or before.t_s != decision.t_s)
        for before, decision in zip((None, *shown), shown, strict=False)
    )
    caption = tag("caption", "Decisions in the order of time", class_="unseen")
    table = tag("table", caption, tag("thead", tag("tr", *head)), tag("tbody", *rows))
    return tag("figure", table, *note, class_="wide decisions")


def _unit(heading: str) -> list[Markup]:
    return [tag("span", "s", class_="unit")] if heading == "Time" else []


def _row(decision: Decision, styles: RuleStyles, *, is_first: bool) -> Markup:
    planned = decision.planned
    before = "start" if decision.from_rate is None else str(decision.from_rate)
    return tag(
        "tr",
        tag("td", format_number(decision.t_s, 1), class_="right"),
        tag("td", *name_parts(decision.topic), class_="left words name"),
        tag("td", before, tag("span", " → ", class_="quiet"), str(planned.rate), class_="left steady"),
        tag("td", *_decider(decision, styles), *_values(decision), class_="left words"),
        class_="first" if is_first else "again",
        data_time=f"{decision.t_s:.3f}",
    )


def _values(decision: Decision) -> list[Markup]:
    """The values that the condition read; a topic is named once for all its properties in a row."""
    parts: list[str] = []
    last_topic = ""
    for signal, value in decision.values.items():
        topic, _, property_name = signal.partition(" ")
        shown = property_name if topic == last_topic else signal
        last_topic = topic
        parts.append(f"{shown} = {'unknown' if value is None else label(value, _DIGITS)}")
    return [tag("span", ", ".join(parts), class_="values quiet")] if parts else []


def _decider(decision: Decision, styles: RuleStyles) -> list[Markup | str]:
    """The block with its line and its colour, else the reason."""
    planned = decision.planned
    block = deciding_block(decision)
    parts: list[Markup | str] = [tag("span", class_=f"dot {styles.of(block).css_class}")]
    parts.append(DEFAULTS.name if block is None else block.rule)
    notes = [f"line {planned.line}"] if planned.line is not None else []
    if planned.reason in _NOTES:
        notes.append(_NOTES[planned.reason])
    return [*parts, tag("span", " · " + " · ".join(notes), class_="quiet")] if notes else parts


MAX_RULE_LINES = 400
MAX_RULE_CHARACTERS = 30_000
_EXPLANATION = "A decision changes the rate of a topic, because a rule begins or ceases to hold."


def decision_section(report: RunReport, rows: Sequence[Lane], styles: RuleStyles) -> Markup:
    """The decisions over time, then each of them beside the rules, as far as there are any."""
    chart, columns = [], []
    if rows:
        drawing = decision_chart(rows, report.duration_s, report.incident)
        chart = [tag("figure", drawing, class_="chart timeline", data_chart="lanes")]
        columns.append(_scrolling("Decisions", [decision_list(report.decisions, styles)]))
    if report.rules:
        columns.append(_scrolling("Rules", list(_rule_files(report.rules))))
    heading = "What the rules decided" if rows else "The rules"
    return section(
        heading,
        *chart,
        tag("div", *columns, class_="columns"),
        explanation=_EXPLANATION if rows else "",
    )


def _scrolling(heading: str, content: Sequence[Markup]) -> Markup:
    """A box of its own height, which a keyboard can scroll too."""
    box = tag("div", *content, class_="scrolling", tabindex="0", role="region", aria_label=heading)
    return tag("div", tag("h3", heading), box)


def _rule_files(rules: Sequence[RuleText]) -> Iterator[Markup]:
    """The files with the line numbers that decisions name, as much of them all as there is room for."""
    lines_left, characters_left = MAX_RULE_LINES, MAX_RULE_CHARACTERS
    for rule in rules:
        lines = rule.text[:characters_left].splitlines()[:lines_left]
        lines_left -= len(lines)
        characters_left -= sum(map(len, lines))
        yield tag("h4", rule.path, class_="words name")
        yield tag("pre", *_numbered(lines), tabindex="0")
        if len(lines) < len(rule.text.splitlines()):
            yield tag("p", "The file goes on; this is its beginning.", class_="note")


def _numbered(lines: Sequence[str]) -> Iterator[Markup | str]:
    for number, line in enumerate(lines, start=1):
        yield tag("span", f"{number:>4}  ", class_="number")
        yield f"{line}\n"
