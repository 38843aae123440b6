# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All findings on rule files."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.checks import CheckContext, check_rules
from smarttestudo.domain.finding import Finding, Severity
from smarttestudo.language.parser import ParseResult


def all_findings(results: Sequence[ParseResult], context: CheckContext) -> list[Finding]:
    """Findings of the checker on files that were read, and where they have no errors, on the budget."""
    findings = check_rules(results, context)
    has_error = any(finding.severity is Severity.ERROR for finding in findings)
    if results and context.profile is not None and context.has_all_files and not has_error:
        from smarttestudo.rules.budget_findings import budget_findings  # noqa: PLC0415  needs the optimizer

        files = [result.file for result in results]
        findings += budget_findings(files, context.profile, context.resolve, context.domain, context.types)
    return findings
