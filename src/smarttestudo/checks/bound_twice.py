# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Two bounds of one property at one place."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.written import WrittenBound
from smarttestudo.domain.finding import Fix, Severity
from smarttestudo.domain.rate import Tier


def _find(book: RuleModel) -> Iterator[Found]:
    first: dict[object, WrittenBound] = {}
    for one in book.bounds:
        earlier = first.setdefault((one.signal, one.branch), one)
        if earlier is not one:
            yield Found(
                path=one.path,
                span=one.statement.span,
                message=f"{one.signal} is already bound at line {earlier.statement.span.line}; the tighter "
                f"bound{_tightest(earlier, one)} counts",
                hint="keep one of the two",
                fix=_fix(earlier, one),
            )


def _fix(earlier: WrittenBound, later: WrittenBound) -> Fix | None:
    """Remove the looser one, as far as numbers say which that is."""
    first, second = earlier.statement.bound, later.statement.bound
    if isinstance(first, Tier) or isinstance(second, Tier):
        return None
    looser = later if second >= first else earlier
    return Fix(
        span=looser.statement.span, replacement="", title=f"remove the looser bound {looser.statement.text}"
    )


def _tightest(*bounds: WrittenBound) -> str:
    """Which of them it is, as far as numbers say that."""
    numbers = [(one.statement.bound, one.statement.text) for one in bounds]
    known = [(bound, text) for bound, text in numbers if not isinstance(bound, Tier)]
    return f", {min(known, key=lambda each: each[0])[1]}," if len(known) == len(numbers) else ""


CHECK = RuleCheck(
    code="bound-twice",
    severity=Severity.WARNING,
    meaning="A property is bound twice outside blocks, or twice in one Then or Else.",
    why="The tighter bound counts, and the other one is never used: who changes that one later "
    "changes nothing.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom Full
  KeepWithin /odom position 0.05
  KeepWithin /odom position 0.1
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom Full
  KeepWithin /odom position 0.05
end
"""
    ),
    find=_find,
)
