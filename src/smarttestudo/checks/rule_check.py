# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A check of the checker."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.text_lines import Found, NumberedFinding
from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.finding import Severity


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleCheck:
    """One thing that the checker looks for; the case file of its theme explains it.

    A check that ``needs_all_statements`` is left out while a file cannot be read or has errors of syntax,
    because what it misses may stand there. One that ``is_about_one_block`` says the same of a block whatever
    stands beside it.
    """

    code: str
    severity: Severity
    find: Callable[[RuleModel], Iterable[Found]]
    needs_all_statements: bool = False
    is_about_one_block: bool = False

    def finding(self, found: Found) -> NumberedFinding:
        """The finding that this check makes of what it found."""
        return NumberedFinding(code=self.code, severity=self.severity, found=found)
