# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The first screen: what happened, in one sentence, two bars and a map."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.visualizer.page.legends import rule_legend
from smarttestudo.visualizer.page.markup import Markup, tag
from smarttestudo.visualizer.page.page_input import PageInput
from smarttestudo.visualizer.page.rule_styles import RuleStyles
from smarttestudo.visualizer.rule_timeline import RuleSpan
from smarttestudo.visualizer.summary import bandwidth_text, summary_sentence
from smarttestudo.visualizer.table import format_number


def opening(page: PageInput, drawing: Markup | None, spans: Sequence[RuleSpan], styles: RuleStyles) -> Markup:
    """The page's head, beside the map where there is one."""
    topics = len(page.comparison.topics)
    extent = f"{topics:,} {'topic' if topics == 1 else 'topics'}, {format_number(page.duration_s, 0)} s"
    words = tag(
        "div",
        tag("h1", page.title, class_="words"),
        tag("p", _kept_together(summary_sentence(page.comparison, len(page.decisions))), class_="lead"),
        _bars(page),
        tag("p", extent, class_="note"),
        *([] if drawing is None else _path_legend(spans, styles)),
    )
    if drawing is None:
        return tag("header", words)
    return tag("header", words, tag("figure", drawing), class_="with-map")


def _kept_together(sentence: str) -> str:
    """``sentence`` with lines that break after commas only."""
    return ", ".join(part.replace(" ", "\N{NO-BREAK SPACE}") for part in sentence.split(", "))


def _path_legend(spans: Sequence[RuleSpan], styles: RuleStyles) -> list[Markup]:
    explanation = "The path has the colour of the rule that decided the most topics at that time."
    return [tag("p", explanation, class_="path-note"), rule_legend(spans, styles)]


def _bars(page: PageInput) -> Markup:
    """The bandwidth of all topics in both runs, to one scale."""
    runs = (
        (page.names.before, page.comparison.before_kb_per_s, "run-before"),
        (page.names.after, page.comparison.after_kb_per_s, "run-after"),
    )
    most = max((value for _, value, _ in runs if value is not None), default=0.0)
    entries = (
        tag("div", tag("dt", name), tag("dd", _bar(value, most, look), tag("span", bandwidth_text(value))))
        for name, value, look in runs
        if value is not None
    )
    return tag("dl", *entries, class_="bars")


def _bar(value: float, most: float, look: str) -> Markup:
    share = 100 * value / most if most > 0 else 0.0
    bar = tag("rect", class_=look, x=0.0, y=0.0, width=share, height=10.0)
    return tag("svg", bar, viewBox="0 0 100 10", preserveAspectRatio="none", aria_hidden="true")
