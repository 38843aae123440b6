# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A topic twice in one Then or Else."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.written import WrittenRate
from smarttestudo.domain.finding import Fix, Severity


def _find(book: RuleModel) -> Iterator[Found]:
    for branch in book.branches:
        first: dict[str, WrittenRate] = {}
        for one in branch.written:
            earlier = first.setdefault(one.topic, one)
            if earlier is not one:
                yield _found(one, earlier, "Else" if branch.is_else else "Then")


def _found(one: WrittenRate, earlier: WrittenRate, side: str) -> Found:
    is_repeated = one.rate is not None and one.rate == earlier.rate
    return Found(
        path=one.path,
        span=one.span,
        message=f"{one.topic} is already set at line {earlier.span.line} of this {side}",
        hint="keep one of the two",
        fix=Fix(span=one.span, replacement="", title="remove the repeated statement")
        if is_repeated
        else None,
    )


CHECK = RuleCheck(
    code="topic-twice",
    severity=Severity.ERROR,
    meaning="A Then or Else sets one topic twice.",
    why="One block can give a topic only one rate; a program cannot know which of the two was meant.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /odom pose_x > 5 Then
    SetFrequency /odom 4
    SetFrequency /odom 20
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /odom pose_x > 5 Then
    SetFrequency /odom 4
end
"""
    ),
    find=_find,
)
