# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The headline of a report: the numbers that matter most."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from smarttestudo.domain.decision import Decision
from smarttestudo.domain.units import counted, grouped
from smarttestudo.report.axes import legend, line_entry
from smarttestudo.report.floor_map import FloorMap, draw_floor_map
from smarttestudo.report.markup import Markup, tag
from smarttestudo.report.rule_timeline import RuleSpan, RuleStyle, RuleStyles, by_topic, most_topics
from smarttestudo.report.run_report import RunReport
from smarttestudo.report.summary import bandwidth_text, summary_sentence
from smarttestudo.report.table import format_number, percent_text


@dataclass(frozen=True, slots=True, kw_only=True)
class Bar:
    """A number of at least 0, what it is called, how it reads with its unit, and its style."""

    name: str
    value: float
    text: str
    css_class: str


def bars(entries: Sequence[Bar]) -> Markup:
    """A list that names each number and shows it."""
    most = max((entry.value for entry in entries), default=0.0)
    return tag("dl", *(_entry(entry, most) for entry in entries), class_="bars")


def _entry(entry: Bar, most: float) -> Markup:
    share = 100 * entry.value / most if most > 0 else 0.0
    bar = tag("rect", class_=entry.css_class, x=0.0, y=0.0, width=share, height=10.0)
    drawing = tag("svg", bar, viewBox="0 0 100 10", preserveAspectRatio="none", aria_hidden="true")
    return tag("div", tag("dt", entry.name), tag("dd", drawing, tag("span", entry.text)))


def opening(
    report: RunReport, plan: FloorMap | None, spans: Sequence[RuleSpan], styles: RuleStyles
) -> Markup:
    """The report's head, beside the map where there is one."""
    topics = len(report.comparison.topics)
    extent = f"{counted(topics, 'topic')}, {format_number(report.duration_s, 0)} s"
    sentence = summary_sentence(report.comparison, len(report.decisions), report.loss)
    words = tag(
        "div",
        tag("h1", report.title, class_="words"),
        tag("p", kept_together(sentence), class_="lead"),
        *(tag("p", text, class_="explanation words") for text in _explanations(report)),
        _bars(report),
        tag("p", extent, class_="note"),
        *(_path_legend(report.decisions, spans, styles) if plan and spans else []),
    )
    if plan is None:
        return tag("header", words)
    return tag("header", words, tag("figure", draw_floor_map(plan)), class_="with-map")


def _explanations(report: RunReport) -> Iterator[str]:
    if report.explanation:
        yield report.explanation
    if report.incident is not None:
        yield f"Incident {report.incident.text}"


def kept_together(sentence: str) -> str:
    """``sentence`` with lines that break after commas only."""
    return ", ".join(part.replace(" ", "\N{NO-BREAK SPACE}") for part in sentence.split(", "))


def _path_legend(
    decisions: Sequence[Decision], spans: Sequence[RuleSpan], styles: RuleStyles
) -> list[Markup]:
    topics = counted(len(by_topic(decisions)), "topic")
    explanation = (
        "The path has the colour of the rule that decided more topics than other rules at that time: "
        f"at most {most_topics(decisions)} of {topics}."
    )
    if any(span.block is not None and span.block.is_in_doubt for span in spans):
        explanation += " In doubt: what the rule reads was not known, so that topics had the higher rate."
    return [tag("p", explanation, class_="path-note"), rule_legend(spans, styles)]


def _bars(report: RunReport) -> Markup:
    """The bandwidth of all topics in each recording, and the budget."""
    values = (
        (report.names.before, report.comparison.before_kb_per_s, "run-before"),
        (report.names.after, report.comparison.after_kb_per_s, "run-after"),
        ("Budget", report.budget_kb_per_s, "run-budget"),
    )
    return bars(
        [
            Bar(name=name, value=value, text=bandwidth_text(value), css_class=style)
            for name, value, style in values
            if value is not None
        ]
    )


def rule_legend(spans: Sequence[RuleSpan], styles: RuleStyles) -> Markup:
    """The style and name of each deciding block, with how long it decided most topics."""
    seconds: dict[RuleStyle, float] = {}
    for span in spans:
        style = styles.of(span.block)
        seconds[style] = seconds.get(style, 0.0) + span.end_s - span.start_s
    total_s = sum(seconds.values())

    def share(style: RuleStyle) -> str:
        percent = f" · {percent_text(100 * seconds[style] / total_s, decimals=0)}" if total_s > 0 else ""
        return f"{grouped(seconds[style])} s{percent}"

    shown = (style for style in styles.all if style in seconds)
    return legend(
        *(line_entry(f"path {style.css_class}", style.name, share(style)) for style in shown), kind="rules"
    )
