# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Checks whose Until can never be true."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity


def _find(book: RuleModel) -> Iterator[Found]:
    for one in book.checks:
        if one.latch is not None and one.latch.off.intersection(book.context.domain(one.signal)).is_empty:
            yield Found(
                path=one.path,
                span=one.check.span,
                message=f"{wording.check_text(one.check)} never ends: no value of {one.signal} ends it",
                hint="correct the number behind Until",
            )


CHECK = RuleCheck(
    code="until-never-ends",
    severity=Severity.WARNING,
    meaning="No value that a property can have ends a check with an Until.",
    why="Once the check was true, its block holds until the rules are exchanged.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /battery_state level < 20 Until > 100 Then
    SetFrequency /odom 2
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /battery_state level < 20 Until > 25 Then
    SetFrequency /odom 2
end
"""
    ),
    find=_find,
)
