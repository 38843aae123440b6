# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All lint rules, and checking rule files by them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from smarttestudo.checks import actions, blocks, bounds, conditions, patterns, rates, topics, words
from smarttestudo.checks.context import CheckContext
from smarttestudo.checks.lint_rule import LintRule
from smarttestudo.checks.rule_model import RuleModel, read_rule_model
from smarttestudo.domain.finding import Finding, Span
from smarttestudo.language.parser.rule_file import ParseResult

_THEMES = (blocks, rates, bounds, patterns, topics, conditions, words, actions)
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
            findings.extend(_once_a_pattern(lint_rule.findings(rules), rules))
    return sorted(findings, key=lambda finding: (finding.path, finding.span.line, finding.span.column))


def _once_a_pattern(findings: Iterable[Finding], rules: RuleModel) -> Iterator[Finding]:
    """Of findings on topics of one pattern the first, and no fix: it would change all the others, too."""
    whole: dict[tuple[str, int], list[Span]] = {}
    for pattern in rules.patterns:
        span = pattern.statement.span
        for line in range(span.line, span.end_line + 1):
            whole.setdefault((pattern.path, line), []).append(span)
    met: set[tuple[str, Span]] = set()
    for finding in findings:
        here = finding.span
        spans = whole.get((finding.path, here.line), ())
        if not any(_is_within(here, span) for span in spans):
            yield finding
        elif (finding.path, here) not in met:
            met.add((finding.path, here))
            yield replace(finding, fix=None)


def _is_within(span: Span, whole: Span) -> bool:
    start, end = (span.line, span.column), (span.end_line, span.end_column)
    return (whole.line, whole.column) <= start and end <= (whole.end_line, whole.end_column)
