# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All checks of rule files, and running them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from smarttestudo.checks import blocks, bounds, conditions, rates, recordings, topics
from smarttestudo.checks.context import CheckContext
from smarttestudo.checks.rule_model import RuleModel, read_rule_model
from smarttestudo.domain.finding import Finding
from smarttestudo.language.parser.rule_file import ParseResult
from smarttestudo.language.recall import Recall
from smarttestudo.language.resolved_rules import Branch, ResolvedBlock

CHECKS = (
    *blocks.CHECKS,
    *rates.CHECKS,
    *bounds.CHECKS,
    *recordings.CHECKS,
    *topics.CHECKS,
    *conditions.CHECKS,
)
"""Of two findings at one place, that of the earlier check comes first."""


_ABOUT_BLOCKS = tuple(check for check in CHECKS if check.is_about_one_block)
_ABOUT_ALL = tuple(check for check in CHECKS if not check.is_about_one_block)
_RANKS = {check.code: rank for rank, check in enumerate(CHECKS)}


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedRules:
    """The findings on files of these ``paths``, with what the next check of them can recall."""

    findings: tuple[Finding, ...]
    paths: tuple[str, ...]
    context: CheckContext
    recall: Recall


def check_rules(results: Sequence[ParseResult], context: CheckContext) -> list[Finding]:
    """All findings on the parsed files of one set, errors of syntax included, by place.

    Bounded in time and memory for any files.
    """
    return list(check_again(results, context, None).findings)


def check_again(
    results: Sequence[ParseResult], context: CheckContext, before: CheckedRules | None
) -> CheckedRules:
    """The same findings; statements that the parser read for ``before`` as well are not thought of again."""
    files = [result.file for result in results]
    paths = tuple(file.path for file in files)
    is_alike = before is not None and before.paths == paths and before.context == context
    recall = Recall(before.recall if before is not None and is_alike else None)
    rules = read_rule_model(files, context, recall)
    is_whole = context.has_all_files and all(result.is_valid for result in results)
    findings = [finding for result in results for finding in result.findings]
    findings.extend(_about_blocks(rules))
    for check in _ABOUT_ALL:
        if is_whole or not check.needs_all_statements:
            findings.extend(check.findings(rules))
    recall.forget_before()
    findings.sort(key=lambda one: (one.path, one.span.line, one.span.column, _RANKS.get(one.code, -1)))
    return CheckedRules(findings=tuple(findings), paths=paths, context=context, recall=recall)


def _about_blocks(rules: RuleModel) -> Iterator[Finding]:
    branches: dict[int, list[Branch]] = {}
    for branch in rules.branches:
        branches.setdefault(branch.block.order, []).append(branch)
    for block in rules.blocks:
        of_block = partial(_about_block, block, branches.get(block.order, ()), rules)
        truth = rules.analysis.truths[block.order]
        yield from rules.recall.value("findings", of_block, block, key=truth)


def _about_block(block: ResolvedBlock, branches: Sequence[Branch], rules: RuleModel) -> Sequence[Finding]:
    alone = rules.of_block(block, branches)
    return [finding for check in _ABOUT_BLOCKS for finding in check.findings(alone)]
