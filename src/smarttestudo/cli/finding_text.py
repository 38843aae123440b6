# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Findings in a terminal: the line for editors, the place in the text, the hint."""

from __future__ import annotations

import os
import re
import unicodedata
from collections.abc import Mapping, Sequence
from typing import TextIO

from smarttestudo.cli.output import write_styled
from smarttestudo.domain.errors import shortened
from smarttestudo.domain.finding import Finding, Severity, Span
from smarttestudo.domain.texts import visible, without_mark

_INDENT = "    "
_SHOWN_COLUMNS = 100
_COLUMNS_BEFORE = 30
_LINE_END = re.compile(r"\r\n|\r|\n")
_RESET = "\x1b[0m"
_BOLD = "\x1b[1m"
_COLOURS = {Severity.ERROR: "\x1b[31m", Severity.WARNING: "\x1b[33m", Severity.INFO: "\x1b[36m"}
_PLURALS = {Severity.ERROR: "errors", Severity.WARNING: "warnings", Severity.INFO: "infos"}


def print_findings(findings: Sequence[Finding], texts: Mapping[str, str], stream: TextIO) -> None:
    """Write ``findings`` to ``stream``, in colour on a terminal; ``texts`` are the checked files by path."""
    lines = {path: _LINE_END.split(without_mark(text)[1]) for path, text in texts.items()}
    colour = wants_colour(stream)
    for finding in findings:
        shown = finding_lines(finding, lines.get(finding.path, ()), colour=colour)
        write_styled("".join(f"{line}\n" for line in shown), stream)


def finding_lines(finding: Finding, lines: Sequence[str], *, colour: bool = False) -> list[str]:
    """One finding: its line, the text it is about underlined, its hint; ``lines`` are those of its file."""
    tint, bold, reset = (_COLOURS[finding.severity], _BOLD, _RESET) if colour else ("", "", "")
    place = f"{finding.path}:{finding.span.line}:{finding.span.column}"
    kind = f"{finding.severity.value}[{finding.code}]"
    shown = [f"{bold}{_visible(place)}:{reset} {tint}{kind}:{reset} {_visible(shortened(finding.message))}"]
    if finding.span.line <= len(lines):
        text, underline = _excerpt(lines[finding.span.line - 1], finding.span)
        if text:
            shown += [f"{_INDENT}{text}", f"{_INDENT}{tint}{underline}{reset}"]
    if finding.hint:
        shown.append(f"{_INDENT}hint: {_visible(shortened(finding.hint))}")
    return shown


def summary(findings: Sequence[Finding], *, files: int) -> str:
    """How many findings of each severity there are in how many files."""
    counts = [(severity, sum(one.severity is severity for one in findings)) for severity in Severity]
    parts = [
        f"{count} {severity.value if count == 1 else _PLURALS[severity]}"
        for severity, count in counts
        if count
    ]
    return f"{', '.join(parts) or 'no findings'} in {files} {'file' if files == 1 else 'files'}"


def wants_colour(stream: TextIO) -> bool:
    """Whether ``stream`` is a terminal that shows colour, and nobody said no (https://no-color.org)."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def _excerpt(line: str, span: Span) -> tuple[str, str]:
    """The line, cut where it is long, and carets under ``span``."""
    start = min(span.column - 1, len(line))
    end = span.end_column - 1 if span.end_line == span.line else len(line.rstrip())
    end = max(min(end, len(line)), start + 1)
    first = len(line) - len(line.lstrip())
    if len(line) - first > _SHOWN_COLUMNS:
        first = max(first, start - _COLUMNS_BEFORE)
    last = first + _SHOWN_COLUMNS
    before, marked = _visible(line[first:start]), _visible(line[start : min(end, last)])
    after = _visible(line[min(end, last) : last])
    text = f"{before}{marked}{after}".rstrip() + (" …" if last < len(line) else "")
    return text, " " * _columns(before) + "^" * max(_columns(marked), 1)


def _visible(text: str) -> str:
    """``text`` as it is shown on one line, with blanks for tabs."""
    return visible(text.replace("\t", " "))


def _columns(text: str) -> int:
    """The columns that a terminal needs for ``text``."""
    wide = sum(unicodedata.east_asian_width(letter) in "WF" for letter in text)
    marks = sum(unicodedata.combining(letter) != 0 for letter in text)
    return len(text) + wide - marks
