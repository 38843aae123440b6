# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The scripts and styles of the report, and the policy that admits these and nothing else."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable
from importlib.resources import files

from smarttestudo.domain.json_text import json_text
from smarttestudo.report.decision_chart import row_sheet
from smarttestudo.report.markup import Markup, tag
from smarttestudo.report.styles import colour_sheet

DATA_ID = "chart-data"
_FOLDER = files("smarttestudo.report")
# In the order in which they build upon each other.
_OF_A_RUN = (
    "time.js",
    "chart.js",
    "lanes.js",
    "map.js",
    "time_bar.js",
    "tables.js",
    "start.js",
)
_OF_MANY = ("tables.js", "many.js")


def style() -> str:
    """The style sheets as one."""
    return "\n".join([colour_sheet(), row_sheet(), _read("report.css")])


def run_script() -> str:
    """The scripts of the report of a run as one."""
    return _script(_OF_A_RUN)


def many_script() -> str:
    """The scripts of the report over many recordings as one."""
    return _script(_OF_MANY)


def _script(names: Iterable[str]) -> str:
    own = "\n".join(_without_head(_read(f"script/{name}")) for name in names)
    return f'(() => {{\n"use strict";\n{own}\n}})();\n'


def script_elements(duration_s: float, path: Iterable[tuple[float, float, float]]) -> tuple[Markup, Markup]:
    """Data that no drawing tells, and its scripts: the duration, and when the robot was where on the map."""
    places = [[round(t_s, 2), round(x, 1), round(y, 1)] for t_s, x, y in path]
    data = json_text({"duration": max(duration_s, 1e-3), "path": places}, compact=True)
    return tag("script", Markup(data), type="application/json", id=DATA_ID), tag(
        "script", Markup(run_script())
    )


def content_policy(script: str) -> str:
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
