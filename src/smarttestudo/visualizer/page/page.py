# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page as a whole."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.resources import files

from smarttestudo.visualizer.comparison_tables import bandwidth_table, frequency_table
from smarttestudo.visualizer.page.decision_list import decision_list
from smarttestudo.visualizer.page.floor_map import floor_map
from smarttestudo.visualizer.page.html_table import html_table
from smarttestudo.visualizer.page.markup import Markup, tag
from smarttestudo.visualizer.page.opening import opening
from smarttestudo.visualizer.page.page_input import PageInput
from smarttestudo.visualizer.page.rule_styles import RuleStyles
from smarttestudo.visualizer.page.sections import (
    provenance_section,
    rates_section,
    rules_section,
    section,
)
from smarttestudo.visualizer.rule_timeline import RuleSpan, by_topic, deciding_spans

_POLICY = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"


def render_page(page: PageInput) -> str:
    """One HTML document that needs nothing else: no network, no script, no other file.

    Its size is bounded by the number of topics, whatever the length of the run.
    """
    body = tag("body", tag("main", *_parts(page)))
    return "<!DOCTYPE html>\n" + tag("html", _head(page.title), body, lang="en").html + "\n"


def _head(title: str) -> Markup:
    style = files("smarttestudo.visualizer.page").joinpath("page.css").read_text(encoding="utf-8")
    return tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", http_equiv="Content-Security-Policy", content=_POLICY),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="color-scheme", content="light dark"),
        tag("title", title),
        tag("style", Markup(style)),
    )


def _parts(page: PageInput) -> Iterator[Markup]:
    spans = deciding_spans(page.decisions, page.duration_s)
    styles = RuleStyles(_all_spans(page))
    yield opening(page, floor_map(page.floor_plan, page.path, spans, styles), spans, styles)
    if page.series:
        yield rates_section(page, styles)
    for table in (frequency_table(page.comparison, page.names), bandwidth_table(page.comparison, page.names)):
        yield section(table.title, html_table(table))
    if page.decisions:
        yield section("Decisions", decision_list(page.decisions, styles))
    if page.rules:
        yield rules_section(page.rules)
    if page.provenance:
        yield provenance_section(page.provenance)


def _all_spans(page: PageInput) -> Iterator[RuleSpan]:
    """What each topic's decisions add to the time that a block decided."""
    for own in by_topic(page.decisions).values():
        yield from deciding_spans(own, page.duration_s)
