# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Legends of the lines and colours of the report."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from smarttestudo.domain.units import grouped
from smarttestudo.report.markup import Markup, tag
from smarttestudo.report.rule_styles import RuleStyle, RuleStyles
from smarttestudo.report.rule_timeline import RuleSpan
from smarttestudo.report.run_report import RunReport
from smarttestudo.report.table import percent_text
from smarttestudo.report.time_chart import Layer


def rule_legend(spans: Sequence[RuleSpan], styles: RuleStyles) -> Markup:
    """The style and name of each deciding block, with how long it decided most topics."""
    seconds: dict[RuleStyle, float] = {}
    for span in spans:
        style = styles.of(span.block)
        seconds[style] = seconds.get(style, 0.0) + span.end_s - span.start_s
    total_s = sum(seconds.values())
    entries = (_rule(style, seconds[style], total_s) for style in styles.all if style in seconds)
    return tag("ul", *entries, class_="legend rules")


def rate_legend(report: RunReport, styles: RuleStyles) -> Markup:
    """The lines of a rate chart, and the tints behind them."""
    target = [_line("target", "Target")] if report.decisions else []
    tints = (_entry(_sample(_strip(style)), style.name) for style in styles.all) if report.decisions else ()
    return tag("ul", *_runs(report), *target, *_incident(report), *tints, class_="legend")


def run_legend(report: RunReport) -> Markup:
    """The lines of the recordings, and the budget's."""
    budget = [] if report.budget_kb_per_s is None else [_line("budget", "Budget")]
    return tag("ul", *_runs(report), *budget, *_incident(report), class_="legend")


def chart_legend(lines: Sequence[tuple[str, str]], tints: Sequence[RuleStyle]) -> Markup:
    """Lines by class and name, and what tints behind them mean."""
    shaded = (_entry(_sample(_strip(style)), style.name) for style in tints)
    return tag("ul", *(_line(style, name) for style, name in lines), *shaded, class_="legend")


def layer_legend(stack: Sequence[Layer], amount: Callable[[Layer], str]) -> Markup:
    """The layers of a stacked chart from top to bottom, each with its ``amount`` in words."""
    entries = [
        _entry(
            _sample(tag("rect", class_=f"layer share-{index}", x=1.0, y=1.0, width=32.0, height=10.0)),
            layer.name,
            tag("span", amount(layer), class_="quiet"),
        )
        for index, layer in enumerate(stack, start=1)
    ]
    return tag("ul", *reversed(entries), class_="legend")


def _runs(report: RunReport) -> Iterator[Markup]:
    yield _line("before", report.names.before)
    if report.is_pair:
        yield _line("after", report.names.after)


def _incident(report: RunReport) -> Iterator[Markup]:
    if report.incident is not None:
        yield _line("incident", report.incident.name)


def _line(style: str, name: str) -> Markup:
    return _entry(_sample(tag("path", class_=style, d="M1 6H33")), name)


def _rule(style: RuleStyle, seconds: float, total_s: float) -> Markup:
    share = (
        f"{grouped(seconds)} s · {percent_text(100 * seconds / total_s, decimals=0)}"
        if total_s > 0
        else f"{grouped(seconds)} s"
    )
    sample = _sample(tag("path", class_=f"path {style.css_class}", d="M1 6H33"))
    return _entry(sample, style.name, tag("span", share, class_="quiet"))


def _entry(sample: Markup, name: str, *more: Markup) -> Markup:
    return tag("li", sample, tag("span", name, class_="words"), *more)


def _strip(style: RuleStyle) -> Markup:
    return tag("path", class_=f"strip {style.css_class}", d="M1 6H33")


def _sample(shape: Markup) -> Markup:
    return tag("svg", shape, class_="sample", viewBox="0 0 34 12", aria_hidden="true")
