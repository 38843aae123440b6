# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Conditions that can never hold."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.written import BlockSite
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.signal import Truth
from smarttestudo.language.normal_form import Every, Within
from smarttestudo.language.syntax import records_in


def _find(book: RuleModel) -> Iterator[Found]:
    for block in book.blocks:
        records = bool(records_in(block.block.otherwise))
        if book.analysis.truths[block.order] is Truth.FALSE and (records or not block.is_one_check):
            impossible = _impossible_signals(block, book)
            reason = f": no value of {impossible} passes all its checks" if impossible else ""
            effect = ", so that the Record of its Else begins once and never again" if records else ""
            yield Found(
                path=block.path,
                span=block.block.condition.span,
                message=f"this condition can never hold{effect}{reason}",
                hint="reverse a comparison, or write OR where one of the checks is enough",
            )


def _impossible_signals(block: BlockSite, book: RuleModel) -> str:
    parts = block.form.parts if isinstance(block.form, Every) else (block.form,)
    names = [
        str(part.signal)
        for part in parts
        if isinstance(part, Within) and part.region.intersection(book.context.domain(part.signal)).is_empty
    ]
    return wording.listed(names) if names else ""


CHECK = RuleCheck(
    code="condition-never-holds",
    severity=Severity.WARNING,
    meaning="A condition contradicts itself.",
    why="The block's Then has no effect; its Else, if there is one, always applies.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If (CheckValue /odom pose_x > 6 AND CheckValue /odom pose_x < -13) Then
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
