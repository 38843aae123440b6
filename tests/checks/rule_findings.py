# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The findings of rules given as text."""

from __future__ import annotations

from smarttestudo.checks import CheckContext, check_rules
from smarttestudo.domain.finding import Finding, Span
from smarttestudo.language.parser import parse

ONE_BLOCK = "begin SetFrequency /odom 10 If {} Then SetFrequency /odom 4 EndIf end"


def findings_of(*texts: str, context: CheckContext | None = None) -> list[Finding]:
    results = [parse(text, f"file{number}.adirf") for number, text in enumerate(texts, start=1)]
    return check_rules(results, context or CheckContext())


def codes_of(*texts: str, context: CheckContext | None = None) -> list[str]:
    return [finding.code for finding in findings_of(*texts, context=context)]


def applied(text: str, finding: Finding) -> str:
    """``text`` with the finding's fix."""
    fix = finding.fix
    assert fix is not None
    lines = text.splitlines(keepends=True)
    starts = [sum(map(len, lines[:number])) for number in range(len(lines) + 1)]
    first = starts[fix.span.line - 1] + fix.span.column - 1
    last = starts[fix.span.end_line - 1] + fix.span.end_column - 1
    return text[:first] + fix.replacement + text[last:]


def covered(text: str, span: Span) -> str:
    assert span.line == span.end_line
    return text.splitlines()[span.line - 1][span.column - 1 : span.end_column - 1]
