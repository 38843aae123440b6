# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rule files to findings."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.adirf.checks.context import CheckContext
from smarttestudo.adirf.checks.registry import CHECKS
from smarttestudo.adirf.checks.rule_book import read_rule_book
from smarttestudo.adirf.parser.result import ParseResult
from smarttestudo.domain.finding import Finding


def check_rules(results: Sequence[ParseResult], context: CheckContext) -> list[Finding]:
    """Everything to say about the parsed files of one set, errors of syntax included, by place.

    Bounded in time and memory for any files.
    """
    book = read_rule_book([result.file for result in results], context)
    is_whole = context.has_all_files and all(result.is_valid for result in results)
    findings = [finding for result in results for finding in result.findings]
    for check in CHECKS:
        if is_whole or not check.needs_all_statements:
            findings.extend(check.findings(book))
    return sorted(findings, key=lambda one: (one.path, one.span.line, one.span.column))
