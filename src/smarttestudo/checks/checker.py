# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All lint rules, and checking rule files by them."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.checks import blocks, bounds, conditions, rates, topics, words
from smarttestudo.checks.context import CheckContext
from smarttestudo.checks.lint_rule import LintRule
from smarttestudo.checks.rule_model import read_rule_model
from smarttestudo.domain.finding import Finding
from smarttestudo.language.parser.rule_file import ParseResult

_THEMES = (blocks, rates, bounds, topics, conditions, words)
LINT_RULES = tuple(
    member for theme in _THEMES for member in vars(theme).values() if isinstance(member, LintRule)
)
"""In the order of their modules; of two findings at one place, that of the earlier rule comes first."""


def check_rules(results: Sequence[ParseResult], context: CheckContext) -> list[Finding]:
    """All findings on the parsed files of one set, errors of syntax included, by place.

    Bounded in time and memory for any files.
    """
    rules = read_rule_model([result.file for result in results], context)
    is_whole = context.has_all_files and all(result.is_valid for result in results)
    findings = [finding for result in results for finding in result.findings]
    for lint_rule in LINT_RULES:
        if is_whole or not lint_rule.needs_all_statements:
            findings.extend(lint_rule.findings(rules))
    return sorted(findings, key=lambda finding: (finding.path, finding.span.line, finding.span.column))
