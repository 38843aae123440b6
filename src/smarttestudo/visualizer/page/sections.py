# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The parts of the page, from top to bottom."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smarttestudo.visualizer.comparison import TopicComparison
from smarttestudo.visualizer.page.legends import chart_legend, rule_legend
from smarttestudo.visualizer.page.markup import Markup, tag
from smarttestudo.visualizer.page.page_input import Fact, PageInput, RuleText
from smarttestudo.visualizer.page.rate_chart import rate_chart
from smarttestudo.visualizer.page.rule_styles import RuleStyles
from smarttestudo.visualizer.rule_timeline import RuleSpan, by_topic, deciding_spans, target_spans
from smarttestudo.visualizer.summary import bandwidth_text, summary_sentence
from smarttestudo.visualizer.table import format_number

MAX_RULE_CHARACTERS = 100_000


def header(page: PageInput) -> Markup:
    """What happened, in one sentence and four numbers."""
    comparison = page.comparison
    figures = (
        (page.names.before, bandwidth_text(comparison.before_kb_per_s)),
        (page.names.after, bandwidth_text(comparison.after_kb_per_s)),
        ("Topics", f"{len(comparison.topics):,}"),
        ("Duration", f"{format_number(page.duration_s, 0)} s"),
    )
    return tag(
        "header",
        tag("h1", page.title, class_="words"),
        tag("p", summary_sentence(comparison, len(page.decisions)), class_="lead"),
        tag("dl", *(tag("div", tag("dt", name), tag("dd", value)) for name, value in figures)),
    )


def section(heading: str, *content: Markup, explanation: str = "") -> Markup:
    """A part of the page under its heading."""
    lines = [tag("p", explanation, class_="explanation")] if explanation else []
    return tag("section", tag("h2", heading), *lines, *content)


def map_section(drawing: Markup, spans: Sequence[RuleSpan], styles: RuleStyles) -> Markup:
    """The floor map beside its legend."""
    return section(
        "Where the rules decided",
        tag("div", tag("figure", drawing), rule_legend(spans, styles), class_="map-row"),
        explanation="The robot's path in the colour of the rule that decided the most topics there.",
    )


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
    shown = rule.text[:MAX_RULE_CHARACTERS]
    lines = (
        tag("span", tag("span", f"{number:>4}  ", class_="number"), line, "\n")
        for number, line in enumerate(shown.splitlines(), start=1)
    )
    yield tag("h3", rule.path, class_="words name")
    yield tag("pre", *lines)
    if len(shown) < len(rule.text):
        yield tag("p", f"… and {len(rule.text) - len(shown):,} characters more.", class_="note")
