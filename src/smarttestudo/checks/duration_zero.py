# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""For or Within no time."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.written import times_in
from smarttestudo.domain.finding import Severity


def _find(book: RuleModel) -> Iterator[Found]:
    for block, timed in times_in(book.blocks):
        if timed.duration.ns == 0:
            yield Found(
                path=block.path,
                span=timed.duration.span,
                message=f"'{wording.time_text(timed)}' changes nothing: the condition counts at once",
                hint=f"give a longer time, or delete the '{timed.word.value}'",
            )


CHECK = RuleCheck(
    code="duration-zero",
    severity=Severity.WARNING,
    meaning="A condition must hold for no time at all.",
    why="A condition For 0 s or Within 0 s is the condition itself: noise turns the block on and off.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /odom speed > 1 For 0 s Then
    SetFrequency /odom 20
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /odom speed > 1 For 2 s Then
    SetFrequency /odom 20
end
"""
    ),
    find=_find,
)
