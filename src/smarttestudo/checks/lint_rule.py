# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A lint rule, and what it finds."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Finding, Fix, ProfileFix, Severity, Span


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """A finding without what all findings of its lint rule share."""

    path: str
    span: Span
    message: str
    hint: str = ""
    fix: Fix | None = None
    related: tuple[Span, ...] = ()
    profile_fix: ProfileFix | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LintRule:
    """One thing that the checker looks for; ``meaning`` is a sentence, ``why`` what comes of it on a robot.

    A rule that ``needs_all_statements`` is left out while a file cannot be read or has errors of syntax,
    because what it misses may stand there.
    """

    code: str
    severity: Severity
    meaning: str
    why: str
    find: Callable[[RuleModel], Iterable[Found]]
    needs_all_statements: bool = False

    def findings(self, rules: RuleModel) -> Iterator[Finding]:
        """The findings of this lint rule in ``rules``."""
        for found in self.find(rules):
            yield Finding(
                code=self.code,
                severity=self.severity,
                message=found.message,
                path=found.path,
                span=found.span,
                hint=found.hint,
                fix=found.fix,
                related=found.related,
                profile_fix=found.profile_fix,
            )


def lint_rule(
    code: str, severity: Severity, *, needs_all_statements: bool = False
) -> Callable[[Callable[[RuleModel], Iterable[Found]]], LintRule]:
    """Make a function a lint rule; the first line of its docstring is the meaning, the rest is the why."""

    def declared(find: Callable[[RuleModel], Iterable[Found]]) -> LintRule:
        meaning, _, why = (inspect.getdoc(find) or "").partition("\n\n")
        return LintRule(
            code=code,
            severity=severity,
            meaning=meaning,
            why=" ".join(why.split()),
            find=find,
            needs_all_statements=needs_all_statements,
        )

    return declared
