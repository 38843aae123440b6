# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A check of the checker, and what it finds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Finding, Fix, ProfileFix, Severity, Span


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """A finding without what all findings of its check share."""

    path: str
    span: Span
    message: str
    hint: str = ""
    fix: Fix | None = None
    related: tuple[Span, ...] = ()
    profile_fix: ProfileFix | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleCheck:
    """One thing that the checker looks for; the case file of its theme explains it.

    A check that ``needs_all_statements`` is left out while a file cannot be read or has errors of syntax,
    because what it misses may stand there.
    """

    code: str
    severity: Severity
    find: Callable[[RuleModel], Iterable[Found]]
    needs_all_statements: bool = False

    def findings(self, rules: RuleModel) -> Iterator[Finding]:
        """The findings of this check in ``rules``."""
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
