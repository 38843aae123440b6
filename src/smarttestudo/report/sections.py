# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The sections of a report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smarttestudo.accuracy.comparison import AccuracyComparison
from smarttestudo.accuracy.loss_report import LossReport
from smarttestudo.bags.comparison import TopicComparison
from smarttestudo.domain.units import grouped
from smarttestudo.report.accuracy_tables import accuracy_sentences, accuracy_tables
from smarttestudo.report.comparison_tables import RunNames
from smarttestudo.report.legends import rate_legend, run_legend
from smarttestudo.report.loss_tables import excess_note, loss_tables
from smarttestudo.report.markup import Markup, html_table, name_parts, tag
from smarttestudo.report.page import Bar, bars
from smarttestudo.report.rule_timeline import RuleStyles
from smarttestudo.report.run_report import Fact, RunReport
from smarttestudo.report.summary import bandwidth_text, fixed_price, length_text, position_error
from smarttestudo.report.table import percent_text
from smarttestudo.report.time_chart import Run, TimeChart, stacked_chart, total_chart
from smarttestudo.report.time_drawing import SMALL, WIDE, draw_chart, layer_legend

_POINTS_OF_ALL_CHARTS = 2000
_FEWEST_POINTS, _MOST_POINTS = 80, 1000
_WIDE_POINTS = 400


def section(heading: str, *content: Markup, explanation: str = "") -> Markup:
    """A part of the report under its heading."""
    lines = [tag("p", explanation, class_="explanation")] if explanation else []
    return tag("section", tag("h2", heading), *lines, *content)


def rates_section(report: RunReport, charts: Sequence[TimeChart], styles: RuleStyles) -> Markup:
    """A small chart for each topic that has one."""
    left_out = len(report.series) - len(charts)
    note = (
        [tag("p", f"{grouped(left_out)} more topics are in the tables.", class_="note")] if left_out else []
    )
    shading = ", shaded by the rule that decided the topic" if report.decisions else ""
    return section(
        "Rate of each topic",
        rate_legend(report, styles),
        tag("div", *_rate_figures(report, charts), class_="charts"),
        *note,
        explanation=f"Messages in each second{shading}.{_stretches(report)}",
    )


def bandwidth_section(report: RunReport) -> Markup:
    """All topics together over time, and what they consist of."""
    total, stack = total_chart(report), stacked_chart(report, Run.AFTER if report.is_pair else Run.BEFORE)
    by_topic = f"{stack.name}, by topic" if report.is_pair else "By topic"
    return section(
        "Bandwidth",
        run_legend(report),
        figure("total", [tag("span", total.name, class_="name")], draw_chart(total, WIDE, _WIDE_POINTS)),
        layer_legend(stack.layers, lambda layer: bandwidth_text(layer.mean_kb_per_s)),
        figure("stack", [tag("span", by_topic, class_="name")], draw_chart(stack, WIDE, _WIDE_POINTS)),
        explanation="What the topics shown here carry together in each second.",
    )


def notices_section(notices: Sequence[str]) -> Markup:
    """Notices of what was lost or odd."""
    return section("Good to know", tag("ul", *(tag("li", notice, class_="words") for notice in notices)))


def provenance_section(facts: Sequence[Fact]) -> Markup:
    """Where all this comes from."""
    entries = (tag("div", tag("dt", fact.label), tag("dd", fact.value, class_="words")) for fact in facts)
    return section("Where this comes from", tag("dl", *entries, class_="facts"))


def _rate_figures(report: RunReport, charts: Sequence[TimeChart]) -> Iterator[Markup]:
    pairs = {pair.topic: pair for pair in report.comparison.topics}
    max_points = min(max(_POINTS_OF_ALL_CHARTS // len(charts), _FEWEST_POINTS), _MOST_POINTS)
    for chart in charts:
        yield figure(
            "rate", _caption(chart.name, pairs.get(chart.name)), draw_chart(chart, SMALL, max_points)
        )


def figure(kind: str, caption: Sequence[Markup], drawing: Markup) -> Markup:
    """A drawing that scripts make interactive, as ``kind`` says."""
    return tag("figure", tag("figcaption", *caption), drawing, class_="chart", data_chart=kind)


def _caption(topic: str, pair: TopicComparison | None) -> list[Markup]:
    change = None if pair is None else pair.change_percent
    number = "" if change is None else percent_text(change, decimals=0, signed=True)
    return [tag("span", *name_parts(topic), class_="words name"), tag("span", number, class_="quiet readout")]


def _stretches(report: RunReport) -> str:
    """Says so where a point of a chart stands for more than a second, or where there is none."""
    if not any(one.before.rate_hz or one.after.rate_hz for one in report.series):
        return " There is none to show: the recording holds no whole second."
    points = next((one.before.rate_hz for one in report.series if len(one.before.rate_hz) > 1), ())
    seconds = points[1].t_s - points[0].t_s if points else 1.0
    if seconds < 2:
        return ""
    return f" Each point stands for {grouped(seconds)} s, from the least to the greatest rate among them."


def loss_section(loss: LossReport, names: RunNames) -> Markup:
    """The error of the position as bars, then fields, ages, crossings and images as tables."""
    explanation = (
        "The error of the operator's data when the last message received is held. Fixed: the baseline, which "
        "is the best fixed rates for the same bytes, without rules."
    )
    excess = [tag("p", line, class_="note") for line in excess_note(loss)]
    tables = (part for table in loss_tables(loss) for part in (tag("h3", table.title), html_table(table)))
    letters = f"In the tables, A is {names.before} and B is {names.after}."
    note = [] if names == RunNames(before="A", after="B") else [tag("p", letters, class_="note")]
    return section(
        "What the operator lost", *_position(loss, names), *excess, *note, *tables, explanation=explanation
    )


def accuracy_section(comparison: AccuracyComparison) -> Markup:
    """How far the operator's picture was off at fixed rates and under rules."""
    return section(
        "Fixed rates, rates by rules, and bounds",
        *(html_table(table) for table in accuracy_tables(comparison)),
        explanation=" ".join(accuracy_sentences(comparison)),
    )


def _position(loss: LossReport, names: RunNames) -> Iterator[Markup]:
    error = position_error(loss)
    if error is None:
        return
    arms = ((names.after, error.received_m, "run-after"), ("Best fixed rates", error.fixed_m, "run-before"))
    longest_m = max(error.received_m, error.fixed_m or 0.0)
    yield tag("h3", f"Error of the position in {error.topic} (RMSE)", class_="words")
    yield bars(
        [
            Bar(name=name, value=value, text=length_text(value, beside_m=longest_m), css_class=style)
            for name, value, style in arms
            if value is not None
        ]
    )
    price = fixed_price(loss)
    if price:
        yield tag("p", price, class_="note words")
