# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The report of a run as one HTML document."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smarttestudo.accuracy.accuracy_curve import AccuracyCurve
from smarttestudo.accuracy.comparison import AccuracyComparison
from smarttestudo.accuracy.loss_report import LossReport
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.units import counted, grouped
from smarttestudo.report.accuracy_curve import accuracy_curve_parts
from smarttestudo.report.accuracy_tables import accuracy_sentences, accuracy_tables
from smarttestudo.report.axes import legend, line_entry
from smarttestudo.report.comparison_tables import RunNames
from smarttestudo.report.decisions import decision_section
from smarttestudo.report.floor_map import FloorMap, draw_floor_map, floor_map
from smarttestudo.report.link import link_section
from smarttestudo.report.loss_tables import excess_note, loss_tables
from smarttestudo.report.markup import Markup, tag
from smarttestudo.report.page import (
    RUN_SCRIPTS,
    Bar,
    bars,
    figure,
    folded_tables,
    html_document,
    kept_together,
    provenance_section,
    run_data,
    section,
    topic_name,
)
from smarttestudo.report.rule_timeline import (
    RuleSpan,
    RuleStyle,
    RuleStyles,
    by_topic,
    deciding_spans,
    most_topics,
    styles_of,
)
from smarttestudo.report.run_report import RunReport
from smarttestudo.report.summary import (
    bandwidth_text,
    fixed_price,
    length_text,
    position_error,
    summary_sentence,
)
from smarttestudo.report.table import format_number, percent_text
from smarttestudo.report.time_chart import TimeChart, rate_charts, total_chart
from smarttestudo.report.time_drawing import STRIP, WIDE, draw_chart


def render_report(report: RunReport) -> str:
    """One HTML document that needs nothing else: no network, no other file.

    Each drawing is there once, for the screen, for paper and without scripts; scripts add a cursor and a zoom
    through all of them. Its size is bounded, whatever the length of the run and the number of topics.
    """
    spans = deciding_spans(report.decisions, report.duration_s)
    styles = styles_of(report.decisions, report.duration_s, report.actions)
    plan = floor_map(report.floor_plan, report.path, spans, styles, incident=report.incident)
    main = tag("main", opening(report, plan, spans, styles), *_sections(report, styles))
    data = run_data(report.duration_s, plan.places if plan else ())
    return html_document(report.title, main, data, scripts=RUN_SCRIPTS)


def _sections(report: RunReport, styles: RuleStyles) -> Iterator[Markup]:
    if report.decisions or report.rules:
        yield decision_section(report, styles)
    yield topics_section(report, styles)
    if report.link is not None:
        total = report.total.after if report.is_pair else report.total.before
        yield link_section(report.link, total.kb_per_s, report.duration_s)
    if report.loss is not None:
        yield loss_section(report.loss, report.names, report.accuracy, report.accuracy_curve)
    elif report.accuracy_curve is not None:
        yield section(_COST, *accuracy_curve_parts(report.accuracy_curve))
    if report.provenance or report.notices:
        yield provenance_section(report.provenance, report.notices)


def opening(
    report: RunReport, plan: FloorMap | None, spans: Sequence[RuleSpan], styles: RuleStyles
) -> Markup:
    """The report's head, beside the map where there is one."""
    topics = len(report.comparison.topics)
    extent = f"{counted(topics, 'topic')}, {format_number(report.duration_s, 0)} s"
    sentence = summary_sentence(report.comparison, report.loss)
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


_POINTS_OF_ALL_CHARTS = 2000
_FEWEST_POINTS, _MOST_POINTS = 80, 1000
_WIDE_POINTS = 400
_TOPICS, _COST = "Rates and bandwidth", "What an accuracy costs"


def topics_section(report: RunReport, styles: RuleStyles) -> Markup:
    """The rates of each topic that has a chart, the bandwidth of all under them, and the numbers."""
    charts = rate_charts(report)
    target = [line_entry("target", "Target")] if report.decisions else []
    budget = [] if report.budget_kb_per_s is None else [line_entry("budget", "Budget")]
    tints = [line_entry(f"strip {style.css_class}", style.name) for style in styles.all if report.decisions]
    shading = ", shaded by the rule that decided the topic" if report.decisions else ""
    tables = folded_tables(report.shown_tables)
    if not report.series:
        return section(_TOPICS, *tables)
    total = draw_chart(total_chart(report), WIDE, _WIDE_POINTS)
    left_out = len(report.series) - len(charts)
    note = [tag("p", f"In the tables: {counted(left_out, 'more topic')}.", class_="note")] if left_out else []
    return section(
        _TOPICS,
        legend(*_runs(report), *target, *budget, *_incident(report), *tints),
        tag(
            "div",
            *_rate_figures(report, charts),
            figure(total, tag("span", report.total.topic, class_="name"), kind="total"),
            class_="strips",
        ),
        *note,
        *tables,
        explanation=f"Messages in each second{shading}, and what all topics carry.{_stretches(report)}",
    )


def _runs(report: RunReport) -> Iterator[Markup]:
    yield line_entry("before", report.names.before)
    if report.is_pair:
        yield line_entry("after", report.names.after)


def _incident(report: RunReport) -> Iterator[Markup]:
    if report.incident is not None:
        yield line_entry("incident", report.incident.name)


def _rate_figures(report: RunReport, charts: Sequence[TimeChart]) -> Iterator[Markup]:
    pairs = {pair.topic: pair for pair in report.comparison.topics}
    max_points = min(max(_POINTS_OF_ALL_CHARTS // max(len(charts), 1), _FEWEST_POINTS), _MOST_POINTS)
    for chart in charts:
        change = pairs[chart.name].change_percent if chart.name in pairs else None
        text = "" if change is None else percent_text(change, decimals=0, signed=True)
        readout = tag("span", text, class_="quiet readout")
        yield figure(draw_chart(chart, STRIP, max_points), topic_name(chart.name), readout, kind="rate")


def _stretches(report: RunReport) -> str:
    """Says so where a point of a chart stands for more than a second, or where there is none."""
    if not any(topic_series.before.rate_hz or topic_series.after.rate_hz for topic_series in report.series):
        return " There is none to show: the recording holds no whole second."
    points = next(
        (
            topic_series.before.rate_hz
            for topic_series in report.series
            if len(topic_series.before.rate_hz) > 1
        ),
        (),
    )
    seconds = points[1].t_s - points[0].t_s if points else 1.0
    if seconds < 2:
        return ""
    return f" Each point stands for {grouped(seconds)} s, from the least to the greatest rate among them."


def loss_section(
    loss: LossReport,
    names: RunNames,
    accuracy: AccuracyComparison | None = None,
    curve: AccuracyCurve | None = None,
) -> Markup:
    """The error of the position as bars, rules and bounds beside fixed rates, then the numbers."""
    excess = [tag("p", line, class_="note") for line in excess_note(loss, names)]
    return section(
        "What the operator lost",
        *_position(loss, names),
        *excess,
        *folded_tables(loss_tables(loss, names)),
        *(_beside_fixed(accuracy) if accuracy else ()),
        *((tag("h3", _COST), *accuracy_curve_parts(curve)) if curve else ()),
        explanation="The error of the operator's data when the last message received is held. Fixed: the "
        "baseline, which is the best fixed rates for the same bytes, without rules.",
    )


def _beside_fixed(comparison: AccuracyComparison) -> Iterator[Markup]:
    """How far the operator's picture was off at fixed rates and under rules."""
    yield tag("h3", "Fixed rates, rates by rules, and bounds")
    yield tag("p", " ".join(accuracy_sentences(comparison)), class_="explanation")
    yield from folded_tables(accuracy_tables(comparison))


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
