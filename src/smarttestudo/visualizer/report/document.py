# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The report as one HTML document."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smarttestudo.visualizer.report.chart_data import chart_data
from smarttestudo.visualizer.report.decision_chart import Lane, lanes
from smarttestudo.visualizer.report.decision_section import decision_section
from smarttestudo.visualizer.report.floor_map import FloorMap, floor_map
from smarttestudo.visualizer.report.html_table import html_table
from smarttestudo.visualizer.report.loss_section import loss_section
from smarttestudo.visualizer.report.markup import Markup, tag
from smarttestudo.visualizer.report.opening import opening
from smarttestudo.visualizer.report.rule_styles import RuleStyles
from smarttestudo.visualizer.report.run_report import RunReport, TopicSeries
from smarttestudo.visualizer.report.scripts import content_policy, script_elements, style
from smarttestudo.visualizer.report.sections import (
    bandwidth_section,
    notices_section,
    provenance_section,
    rates_section,
    section,
)
from smarttestudo.visualizer.rule_timeline import RuleSpan, by_topic, deciding_spans

MAX_CHARTS = 40


def render_report(report: RunReport) -> str:
    """One HTML document that needs nothing else: no network, no other file.

    Its drawings and tables are there without scripts; with them, a cursor and a zoom run through all charts
    and the map. Its size is bounded, whatever the length of the run and the number of topics.
    """
    spans = deciding_spans(report.decisions, report.duration_s)
    styles = RuleStyles(_all_spans(report))
    rows = lanes(report.decisions, report.duration_s, styles) if report.decisions else ()
    plan = floor_map(report.floor_plan, report.path, spans, styles)
    shown = _shown(report)
    data = chart_data(report, shown, rows, plan.frame if plan else None, plan.line if plan else ())
    main = tag("main", *_parts(report, shown, rows, plan, spans, styles))
    body = tag("body", main, *script_elements(data))
    return "<!DOCTYPE html>\n" + tag("html", _head(report.title), body, lang="en").html + "\n"


def _head(title: str) -> Markup:
    return tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", http_equiv="Content-Security-Policy", content=content_policy()),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="color-scheme", content="light dark"),
        tag("title", title),
        tag("style", Markup(style())),
    )


def _parts(
    report: RunReport,
    shown: Sequence[TopicSeries],
    rows: Sequence[Lane],
    plan: FloorMap | None,
    spans: Sequence[RuleSpan],
    styles: RuleStyles,
) -> Iterator[Markup]:
    yield opening(report, plan, spans, styles)
    if rows or report.rules:
        yield decision_section(report, rows, styles)
    if shown:
        yield rates_section(report, shown, styles)
        yield bandwidth_section(report)
    if report.loss is not None:
        yield loss_section(report.loss, report.names)
    for table in report.shown_tables:
        yield section(table.title, html_table(table))
    if report.notices:
        yield notices_section(report.notices)
    if report.provenance:
        yield provenance_section(report.provenance)


def _shown(report: RunReport) -> list[TopicSeries]:
    """The topics that have a chart: those with decisions, and then those with the most messages' bytes."""
    decided = by_topic(report.decisions)
    ranked = sorted(
        report.series,
        key=lambda series: (
            series.topic not in decided,
            -sum(point.mean for point in (*series.before.kb_per_s, *series.after.kb_per_s)),
        ),
    )
    chosen = {series.topic for series in ranked[:MAX_CHARTS]}
    return [series for series in report.series if series.topic in chosen]


def _all_spans(report: RunReport) -> Iterator[RuleSpan]:
    """What each topic's decisions add to the time that a block decided."""
    for own in by_topic(report.decisions).values():
        yield from deciding_spans(own, report.duration_s)
