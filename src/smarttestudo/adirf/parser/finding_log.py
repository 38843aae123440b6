# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Collects the parser's findings: one for each broken statement, a bounded number of them."""

from __future__ import annotations

from smarttestudo.domain.finding import Finding, Fix, Severity
from smarttestudo.domain.source import Span

MAX_FINDINGS = 1000


class FindingLog:
    """The errors of one file; a second one in the same statement is mostly an echo of the first."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._findings: list[Finding] = []
        self._is_reported = False
        self._left_out = 0

    def begin_statement(self) -> None:
        """What is reported next is about another statement."""
        self._is_reported = False

    def report(self, code: str, message: str, *, span: Span, hint: str = "", fix: Fix | None = None) -> None:
        """Keep an error, unless its statement has one."""
        if self._is_reported:
            return
        self._is_reported = True
        if len(self._findings) == MAX_FINDINGS:
            self._left_out += 1
            return
        self._findings.append(
            Finding(
                code=code,
                severity=Severity.ERROR,
                message=message,
                path=self._path,
                span=span,
                hint=hint,
                fix=fix,
            )
        )

    def findings(self) -> tuple[Finding, ...]:
        """Everything reported, in the order of the file."""
        found = sorted(self._findings, key=lambda finding: (finding.span.line, finding.span.column))
        if self._left_out:
            last = found[-1]
            message = f"{self._left_out} more errors are not shown"
            found.append(
                Finding(
                    code="too-many-errors",
                    severity=Severity.ERROR,
                    message=message,
                    path=self._path,
                    span=last.span,
                    hint="is this a rule file?",
                )
            )
        return tuple(found)
