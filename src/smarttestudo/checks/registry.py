# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All checks of rule files, and running them."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.checks import blocks, bounds, conditions, rates, recordings, topics
from smarttestudo.checks.context import CheckContext
from smarttestudo.checks.rule_model import read_rule_model
from smarttestudo.domain.finding import Finding
from smarttestudo.language.parser.rule_file import ParseResult

CHECKS = (
    *blocks.CHECKS,
    *rates.CHECKS,
    *bounds.CHECKS,
    *recordings.CHECKS,
    *topics.CHECKS,
    *conditions.CHECKS,
)
"""Of two findings at one place, that of the earlier check comes first."""


def check_rules(results: Sequence[ParseResult], context: CheckContext) -> list[Finding]:
    """All findings on the parsed files of one set, errors of syntax included, by place.

    Bounded in time and memory for any files.
    """
    rules = read_rule_model([result.file for result in results], context)
    is_whole = context.has_all_files and all(result.is_valid for result in results)
    findings = [finding for result in results for finding in result.findings]
    for check in CHECKS:
        if is_whole or not check.needs_all_statements:
            findings.extend(check.findings(rules))
    return sorted(findings, key=lambda one: (one.path, one.span.line, one.span.column))
