# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the lines and colours of the page mean."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from smarttestudo.visualizer.comparison_tables import RunNames
from smarttestudo.visualizer.page.markup import Markup, tag
from smarttestudo.visualizer.page.rule_styles import RuleStyle, RuleStyles
from smarttestudo.visualizer.rule_timeline import RuleSpan


def rule_legend(spans: Sequence[RuleSpan], styles: RuleStyles) -> Markup:
    """Each deciding block's look and name, with how long it decided most topics."""
    seconds: dict[RuleStyle, float] = {}
    for span in spans:
        style = styles.of(span.block)
        seconds[style] = seconds.get(style, 0.0) + span.end_s - span.start_s
    total_s = sum(seconds.values())
    entries = (_rule(style, seconds[style], total_s) for style in styles.all if style in seconds)
    return tag("ul", *entries, class_="legend rules")


def chart_legend(names: RunNames, styles: Iterable[RuleStyle]) -> Markup:
    """The lines of a rate chart, and the tints behind them."""
    meanings = (("before", names.before), ("after", names.after), ("target", "Target"))
    lines = (_entry(_sample(tag("path", class_=look, d="M1 6H33")), name) for look, name in meanings)
    tints = (_entry(_sample(_strip(style)), style.name) for style in styles)
    return tag("ul", *lines, *tints, class_="legend")


def _rule(style: RuleStyle, seconds: float, total_s: float) -> Markup:
    share = f"{seconds:,.0f} s · {100 * seconds / total_s:.0f} %" if total_s > 0 else f"{seconds:,.0f} s"
    sample = _sample(tag("path", class_=f"path {style.css_class}", d="M1 6H33"))
    return _entry(sample, style.name, tag("span", share, class_="quiet"))


def _entry(sample: Markup, name: str, *more: Markup) -> Markup:
    return tag("li", sample, tag("span", name, class_="words"), *more)


def _strip(style: RuleStyle) -> Markup:
    return tag("rect", class_=f"strip {style.css_class}", x=1.0, y=4.0, width=32.0, height=4.0)


def _sample(shape: Markup) -> Markup:
    return tag("svg", shape, class_="sample", viewBox="0 0 34 12", aria_hidden="true")
