# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The report as one HTML document."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from smarttestudo.report.accuracy_curve_section import accuracy_curve_section
from smarttestudo.report.decision_chart import Lane, lanes
from smarttestudo.report.decision_section import decision_section
from smarttestudo.report.floor_map import FloorMap, floor_map
from smarttestudo.report.headline import opening
from smarttestudo.report.link_section import link_section
from smarttestudo.report.markup import Markup, html_table, tag
from smarttestudo.report.rule_timeline import RuleSpan, RuleStyles, deciding_spans, styles_of
from smarttestudo.report.run_report import RunReport
from smarttestudo.report.scripts import content_policy, run_script, script_elements, style
from smarttestudo.report.sections import (
    accuracy_section,
    bandwidth_section,
    loss_section,
    notices_section,
    provenance_section,
    rates_section,
    section,
)
from smarttestudo.report.time_chart import TimeChart, rate_charts


@dataclass(frozen=True, slots=True, kw_only=True)
class _Drawn:
    """The values that several parts of the report show."""

    charts: Sequence[TimeChart]
    spans: Sequence[RuleSpan]
    styles: RuleStyles
    rows: Sequence[Lane]
    plan: FloorMap | None


def render_report(report: RunReport) -> str:
    """One HTML document that needs nothing else: no network, no other file.

    Each drawing is there once, for the screen, for paper and without scripts; scripts add a cursor and a zoom
    through all of them. Its size is bounded, whatever the length of the run and the number of topics.
    """
    drawn = _draw(report)
    scripts = script_elements(report.duration_s, drawn.plan.places if drawn.plan else ())
    return html_document(report.title, tag("main", *_parts(report, drawn)), *scripts, script=run_script())


def html_document(title: str, *content: Markup, script: str) -> str:
    """``content`` as a document that runs ``script`` alone, which is part of it, and loads nothing."""
    body = tag("body", *content)
    return "<!DOCTYPE html>\n" + tag("html", _head(title, script), body, lang="en").html + "\n"


def _draw(report: RunReport) -> _Drawn:
    spans = deciding_spans(report.decisions, report.duration_s)
    styles = styles_of(report.decisions, report.duration_s)
    return _Drawn(
        charts=rate_charts(report),
        spans=spans,
        styles=styles,
        rows=lanes(report.decisions, report.duration_s, styles) if report.decisions else (),
        plan=floor_map(report.floor_plan, report.path, spans, styles, incident=report.incident),
    )


def _head(title: str, script: str) -> Markup:
    return tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", http_equiv="Content-Security-Policy", content=content_policy(script)),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="color-scheme", content="light dark"),
        tag("title", title),
        tag("style", Markup(style())),
    )


def _parts(report: RunReport, drawn: _Drawn) -> Iterator[Markup]:
    yield opening(report, drawn.plan, drawn.spans, drawn.styles)
    if drawn.rows or report.rules:
        yield decision_section(report, drawn.rows, drawn.styles)
    if drawn.charts:
        yield rates_section(report, drawn.charts, drawn.styles)
        yield bandwidth_section(report)
    if report.link is not None:
        total = report.total.after if report.is_pair else report.total.before
        yield link_section(report.link, total.kb_per_s, report.duration_s)
    if report.loss is not None:
        yield loss_section(report.loss, report.names)
    if report.accuracy is not None:
        yield accuracy_section(report.accuracy)
    if report.accuracy_curve is not None:
        yield accuracy_curve_section(report.accuracy_curve)
    for table in report.shown_tables:
        yield section(table.title, html_table(table))
    if report.notices:
        yield notices_section(report.notices)
    if report.provenance:
        yield provenance_section(report.provenance)
