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

MAX_RULE_LINES = 1000
MAX_RULE_CHARACTERS = 60_000
_EXPLANATION = "A decision changes the rate of a topic, because a rule begins or ceases to hold."


def decision_section(report: RunReport, rows: Sequence[Lane], styles: RuleStyles) -> Markup:
    """The decisions over time, then each of them beside the rules, as far as there are any."""
    chart, columns = [], []
    if rows:
        drawing = decision_chart(rows, report.duration_s)
        chart = [tag("figure", drawing, class_="chart timeline", data_chart="lanes")]
        columns.append(_scrolling("Decisions", [decision_list(report.decisions, styles)]))
    if report.rules:
        columns.append(_scrolling("Rules", [part for rule in report.rules for part in _rule_file(rule)]))
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


def _rule_file(rule: RuleText) -> Iterator[Markup]:
    lines = rule.text[:MAX_RULE_CHARACTERS].splitlines()
    numbered = (
        part
        for number, line in enumerate(lines[:MAX_RULE_LINES], start=1)
        for part in (tag("span", f"{number:>4}  ", class_="number"), line, "\n")
    )
    yield tag("h4", rule.path, class_="words name")
    yield tag("pre", *numbered)
    if len(rule.text) > MAX_RULE_CHARACTERS or len(lines) > MAX_RULE_LINES:
        yield tag("p", "The file goes on; this is its beginning.", class_="note")
