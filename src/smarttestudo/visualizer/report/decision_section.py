# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the rules decided: over time, one by one, and the rules themselves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smarttestudo.visualizer.report.decision_chart import Lane, decision_chart
from smarttestudo.visualizer.report.decision_list import decision_list
from smarttestudo.visualizer.report.markup import Markup, tag
from smarttestudo.visualizer.report.rule_styles import RuleStyles
from smarttestudo.visualizer.report.run_report import RuleText, RunReport
from smarttestudo.visualizer.report.sections import section

MAX_RULE_LINES = 400
MAX_RULE_CHARACTERS = 30_000
_EXPLANATION = "A decision changes the rate of a topic, because a rule begins or ceases to hold."


def decision_section(report: RunReport, rows: Sequence[Lane], styles: RuleStyles) -> Markup:
    """The decisions over time, then each of them beside the rules, as far as there are any."""
    chart, columns = [], []
    if rows:
        drawing = decision_chart(rows, report.duration_s)
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
        yield tag("pre", *_numbered(lines))
        if len(lines) < len(rule.text.splitlines()):
            yield tag("p", "The file goes on; this is its beginning.", class_="note")


def _numbered(lines: Sequence[str]) -> Iterator[Markup | str]:
    for number, line in enumerate(lines, start=1):
        yield tag("span", f"{number:>4}  ", class_="number")
        yield f"{line}\n"
