# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a check of the checker is made of."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Finding, Fix, ProfileFix, Severity
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.source import Span


@dataclass(frozen=True, slots=True, kw_only=True)
class Example:
    """A rule file to show, with the profile and the topics of a recording that it is checked with."""

    rules: str
    profile: Profile | None = None
    bag_topics: Mapping[str, str] | None = None


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
    """One thing that the checker looks for.

    ``meaning`` is one sentence, ``why`` what happens on a robot that runs such a file. ``bad`` gives this
    finding and no other, ``good`` none at all. A check that ``needs_all_statements`` is left out while a file
    cannot be read or has errors of syntax, because what it misses may stand there.
    """

    code: str
    severity: Severity
    meaning: str
    why: str
    bad: Example
    good: Example
    find: Callable[[RuleModel], Iterable[Found]]
    needs_all_statements: bool = False

    def findings(self, book: RuleModel) -> Iterator[Finding]:
        """What this check has to say about ``book``."""
        for found in self.find(book):
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
