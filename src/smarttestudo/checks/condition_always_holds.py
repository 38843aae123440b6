# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Conditions that always hold."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.signal import Truth
from smarttestudo.language.syntax import records_in


def _find(book: RuleModel) -> Iterator[Found]:
    for block in book.blocks:
        records = bool(records_in(block.block.then))
        if book.analysis.truths[block.order] is Truth.TRUE and (records or not block.is_one_check):
            effect = "its Else never applies" if block.block.otherwise else "the block never ends"
            if records:
                effect = "its Record begins once and never again"
            yield Found(
                path=block.path,
                span=block.block.condition.span,
                message=f"this condition holds for all values, so that {effect}",
                hint="write AND where all checks must hold, or make its rates the defaults",
            )


CHECK = RuleCheck(
    code="condition-always-holds",
    severity=Severity.WARNING,
    meaning="A condition holds whatever the values are.",
    why="The block decides nothing that a default could not, and its Else has no effect.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If (CheckValue /odom pose_x > -13 OR CheckValue /odom pose_x < 6) Then
    SetFrequency /odom 4
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If (CheckValue /odom pose_x > -13 AND CheckValue /odom pose_x < 6) Then
    SetFrequency /odom 4
end
"""
    ),
    find=_find,
)
