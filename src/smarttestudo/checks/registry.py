# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All checks of rule files, and running them."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from itertools import chain
from operator import attrgetter

from smarttestudo.checks import blocks, bounds, conditions, rates, recordings, topics
from smarttestudo.checks.context import CheckContext
from smarttestudo.checks.rule_model import RuleModel, read_rule_model
from smarttestudo.checks.text_lines import NumberedFinding, TextLines
from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.finding import Finding
from smarttestudo.domain.signal import Truth
from smarttestudo.language.parser.rule_file import ParseResult
from smarttestudo.language.recall import Recall
from smarttestudo.language.resolved_rules import ResolvedBlock

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
    """The findings on files of these ``paths``, with what the next check of them can recall.

    ``numbered`` has them with the places of trees, ``lines`` are those of the text.
    """

    numbered: Sequence[NumberedFinding]
    lines: TextLines
    paths: tuple[str, ...]
    context: CheckContext
    recall: Recall

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The findings, by place."""
        return tuple(map(self.lines.told, self.numbered))


def check_rules(results: Sequence[ParseResult], context: CheckContext) -> list[Finding]:
    """All findings on the parsed files of one set, errors of syntax included, by place.

    Bounded in time and memory for any files.
    """
    return list(check_again(results, context, None).findings)


def check_again(
    results: Sequence[ParseResult], context: CheckContext, before: CheckedRules | None
) -> CheckedRules:
    """The same findings; statements that the parser read for ``before`` as well are not thought of again."""
    files = [result.numbered for result in results]
    paths = tuple(file.path for file in files)
    is_alike = before is not None and before.paths == paths and before.context == context
    recall = Recall(before.recall if before is not None and is_alike else None)
    rules = read_rule_model(files, context, recall)
    is_whole = context.has_all_files and all(result.is_valid for result in results)
    findings = list(_about_blocks(rules))
    for check in _ABOUT_ALL:
        if is_whole or not check.needs_all_statements:
            findings += recall.each(("findings", check.code), check.finding, tuple(check.find(rules)))
    findings += [NumberedFinding.of(one, result.lines) for result in results for one in result.findings]
    places = recall.each("places", _place, findings)
    by_place = [findings[at] for at in sorted(range(len(findings)), key=places.__getitem__)]
    recall.forget_before()
    lines = TextLines(by_path={result.numbered.path: result.lines for result in results})
    return CheckedRules(numbered=by_place, lines=lines, paths=paths, context=context, recall=recall)


def _place(finding: NumberedFinding) -> tuple[str, int, int, int]:
    found = finding.found
    return found.path, found.span.line, found.span.column, _RANKS.get(finding.code, -1)


def _about_blocks(rules: RuleModel) -> Iterator[NumberedFinding]:
    def about_block(block: ResolvedBlock, _: Truth) -> Sequence[NumberedFinding]:
        orders = attrgetter("block.order")
        first, last = (side(rules.branches, block.order, key=orders) for side in (bisect_left, bisect_right))
        alone = rules.of_block(block, rules.branches[first:last])
        return [check.finding(found) for check in _ABOUT_BLOCKS for found in check.find(alone)]

    found = rules.recall.each("findings", about_block, rules.blocks, list(rules.analysis.truths.values()))
    return chain.from_iterable(found)
