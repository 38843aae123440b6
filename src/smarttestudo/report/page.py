# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A page: its parts, its scripts and styles, and the policy that admits these and nothing else."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

from smarttestudo.domain.json_text import json_text
from smarttestudo.report.markup import Child, Markup, html_table, name_parts, tag
from smarttestudo.report.run_report import Fact
from smarttestudo.report.styles import colour_sheet, row_sheet
from smarttestudo.report.table import Table

DATA_ID = "chart-data"
_FOLDER = files("smarttestudo.report")
RUN_SCRIPTS = ("tables.js", "run.js")
MANY_SCRIPTS = ("tables.js", "many.js")


def style() -> str:
    """The style sheets as one."""
    return "\n".join([colour_sheet(), row_sheet(), _read("report.css")])


def _script(names: Iterable[str]) -> str:
    own = "\n".join(_without_head(_read(f"script/{name}")) for name in names)
    return f'(() => {{\n"use strict";\n{own}\n}})();\n'


def run_data(duration_s: float, path: Iterable[tuple[float, float, float]]) -> Markup:
    """Data that no drawing of a run tells: the duration, and when the robot was where on the map."""
    places = [[round(t_s, 2), round(x, 1), round(y, 1)] for t_s, x, y in path]
    data = json_text({"duration": max(duration_s, 1e-3), "path": places}, compact=True)
    return tag("script", Markup(data), type="application/json", id=DATA_ID)


def _content_policy(script: str) -> str:
    """A content security policy under which nothing is loaded and only ``script`` and the styles count."""
    allowed = f"script-src '{_digest(script)}'; style-src '{_digest(style())}'"
    return f"default-src 'none'; {allowed}; base-uri 'none'; form-action 'none'"


def _digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _read(name: str) -> str:
    return _FOLDER.joinpath(name).read_text(encoding="utf-8")


def _without_head(text: str) -> str:
    """A script without the lines about its licence, which is the project's."""
    return "\n".join(line for line in text.splitlines() if not line.startswith("// SPDX-"))


def html_document(title: str, *content: Markup, scripts: Sequence[str]) -> str:
    """``content`` as a document that runs ``scripts`` alone, which are part of it, and loads nothing."""
    script = _script(scripts)
    body = tag("body", *content, tag("script", Markup(script)))
    return "<!DOCTYPE html>\n" + tag("html", _head(title, script), body, lang="en").html + "\n"


def _head(title: str, script: str) -> Markup:
    return tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", http_equiv="Content-Security-Policy", content=_content_policy(script)),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="color-scheme", content="light dark"),
        tag("title", title),
        tag("style", Markup(style())),
    )


def section(heading: str, *content: Markup, explanation: str = "") -> Markup:
    """A part of the report under its heading."""
    lines = [tag("p", explanation, class_="explanation")] if explanation else []
    return tag("section", tag("h2", heading), *lines, *content)


def folded(heading: str, *content: Child) -> Markup:
    """Details under their heading, which a reader opens and paper shows."""
    return tag("details", tag("summary", heading), *content, class_="folded")


def folded_tables(tables: Iterable[Table[Any]]) -> Iterator[Markup]:
    """Tables, under their titles."""
    return (folded(table.title, html_table(table)) for table in tables)


def figure(drawing: Markup, *caption: Markup, kind: str = "") -> Markup:
    """A drawing under its caption; scripts make it interactive, as ``kind`` says."""
    heading = [tag("figcaption", *caption)] if caption else []
    scripted = {"data_chart": kind} if kind else {}
    return tag("figure", *heading, drawing, class_="chart", **scripted)


def topic_name(topic: str) -> Markup:
    """The name of a topic in a caption."""
    return tag("span", *name_parts(topic), class_="words name")


def provenance_section(facts: Sequence[Fact], notices: Sequence[str] = ()) -> Markup:
    """Where all this comes from, and what was lost or odd."""
    odd = [tag("ul", *(tag("li", notice, class_="words") for notice in notices))] if notices else []
    entries = (tag("div", tag("dt", fact.label), tag("dd", fact.value, class_="words")) for fact in facts)
    return section("Where this comes from", *odd, tag("dl", *entries, class_="facts"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Bar:
    """A number of at least 0, what it is called, how it reads with its unit, and its style."""

    name: str
    value: float
    text: str
    css_class: str


def bars(entries: Sequence[Bar]) -> Markup:
    """A list that names each number and shows it."""
    most = max((entry.value for entry in entries), default=0.0)
    return tag("dl", *(_entry(entry, most) for entry in entries), class_="bars")


def _entry(entry: Bar, most: float) -> Markup:
    share = 100 * entry.value / most if most > 0 else 0.0
    bar = tag("rect", class_=entry.css_class, x=0.0, y=0.0, width=share, height=10.0)
    drawing = tag("svg", bar, viewBox="0 0 100 10", preserveAspectRatio="none", aria_hidden="true")
    return tag("div", tag("dt", entry.name), tag("dd", drawing, tag("span", entry.text)))


def kept_together(sentence: str) -> str:
    """``sentence`` with lines that break after commas only."""
    return ", ".join(part.replace(" ", "\N{NO-BREAK SPACE}") for part in sentence.split(", "))
