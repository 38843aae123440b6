# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Two bounds of one property at one place."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.adirf.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.adirf.checks.rule_model import RuleModel
from smarttestudo.adirf.checks.written import WrittenBound
from smarttestudo.domain.finding import Severity


def _find(book: RuleModel) -> Iterator[Found]:
    first: dict[object, WrittenBound] = {}
    for one in book.bounds:
        earlier = first.setdefault((one.signal, one.branch), one)
        if earlier is not one:
            tightest = min(earlier, one, key=lambda each: each.statement.bound)
            yield Found(
                path=one.path,
                span=one.statement.span,
                message=f"{one.signal} is already bound at line {earlier.statement.span.line}; the tighter "
                f"bound, {tightest.statement.text}, counts",
                hint="keep one of the two",
            )


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
