# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Checks whose Until is true where they are."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity
from smarttestudo.language.region import Region


def _find(book: RuleModel) -> Iterator[Found]:
    for one in book.checks:
        if one.latch is None:
            continue
        written = Region.where(one.check.operator, one.check.value)
        both = written.intersection(one.latch.off).intersection(book.context.domain(one.signal))
        if not both.is_empty:
            yield Found(
                path=one.path,
                span=one.check.span,
                message=f"{wording.check_text(one.check)} begins and ends at one value, for instance "
                f"{wording.number(both.sample())}: there it does not hold",
                hint="let Until name a value on the other side, as in < 20 Until > 25",
            )


CHECK = RuleCheck(
    code="until-overlaps",
    severity=Severity.WARNING,
    meaning="A check and its Until are true for the same value.",
    why="An Until counts more than the check before it, so that the check does not hold where both are true. "
    "Mostly a comparison is the wrong way round.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /battery_state level < 20 Until > 15 Then
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
