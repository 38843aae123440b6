# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The parts of the page below the first screen."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smarttestudo.visualizer.comparison import TopicComparison
from smarttestudo.visualizer.page.legends import chart_legend
from smarttestudo.visualizer.page.markup import Markup, tag
from smarttestudo.visualizer.page.page_input import Fact, PageInput, RuleText
from smarttestudo.visualizer.page.rate_chart import rate_chart
from smarttestudo.visualizer.page.rule_styles import RuleStyles
from smarttestudo.visualizer.rule_timeline import by_topic, deciding_spans
from smarttestudo.visualizer.table import format_number
from smarttestudo.visualizer.targets import target_spans

MAX_RULE_LINES = 1000
MAX_RULE_CHARACTERS = 100_000


def section(heading: str, *content: Markup, explanation: str = "") -> Markup:
    """A part of the page under its heading."""
    lines = [tag("p", explanation, class_="explanation")] if explanation else []
    return tag("section", tag("h2", heading), *lines, *content)


def rates_section(page: PageInput, styles: RuleStyles) -> Markup:
    """A small chart for each topic."""
    pairs = {pair.topic: pair for pair in page.comparison.topics}
    decisions = by_topic(page.decisions)
    charts = []
    for series in page.series:
        own = decisions.get(series.topic, [])
        spans = deciding_spans(own, page.duration_s)
        targets = target_spans(own, page.duration_s)
        chart = rate_chart(series, targets, spans, styles, duration_s=page.duration_s)
        charts.append(tag("figure", _caption(series.topic, pairs.get(series.topic)), chart))
    return section(
        "Rate of each topic",
        chart_legend(page.names, styles.all),
        tag("div", *charts, class_="charts"),
        explanation="Messages in each second, shaded by the rule that decided the topic.",
    )


def rules_section(rules: Sequence[RuleText]) -> Markup:
    """The rule files, with the line numbers that the decisions name."""
    return section("The rules", *(part for rule in rules for part in _rule_file(rule)))


def provenance_section(facts: Sequence[Fact]) -> Markup:
    """Where all this comes from."""
    entries = (tag("div", tag("dt", fact.label), tag("dd", fact.value, class_="words")) for fact in facts)
    return section("Where this comes from", tag("dl", *entries, class_="facts"))


def _caption(topic: str, pair: TopicComparison | None) -> Markup:
    change = None if pair is None else pair.change_percent
    number = (
        [] if change is None else [tag("span", f"{format_number(change, 0, signed=True)} %", class_="quiet")]
    )
    return tag("figcaption", tag("span", topic, class_="words name"), *number)


def _rule_file(rule: RuleText) -> Iterator[Markup]:
    lines = rule.text[:MAX_RULE_CHARACTERS].splitlines()
    numbered = (
        part
        for number, line in enumerate(lines[:MAX_RULE_LINES], start=1)
        for part in (tag("span", f"{number:>4}  ", class_="number"), line, "\n")
    )
    yield tag("h3", rule.path, class_="words name")
    yield tag("pre", *numbered)
    if len(rule.text) > MAX_RULE_CHARACTERS or len(lines) > MAX_RULE_LINES:
        yield tag("p", "The file goes on; this is its beginning.", class_="note")
