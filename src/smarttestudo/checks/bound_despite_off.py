# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bounds of topics that are Off."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Fix, Severity


def _find(book: RuleModel) -> Iterator[Found]:
    bounds = {one.topic: one for one in reversed(book.bounds)}
    for setting in book.settings:
        bound = bounds.get(setting.topic)
        if bound is not None and setting.rate is not None and setting.rate.is_off:
            where = wording.place(bound.path, bound.statement.span, seen_from=setting.path)
            yield Found(
                path=setting.path,
                span=setting.statement.rate.span,
                message=f"{setting.rate} stops {setting.topic} although KeepWithin ({where}) bounds its "
                f"{bound.statement.property}",
                hint="write a low rate, or Full to leave the rate to the bound",
                fix=Fix(
                    span=setting.statement.rate.span, replacement="Full", title="leave the rate to the bound"
                ),
            )


CHECK = RuleCheck(
    code="bound-despite-off",
    severity=Severity.WARNING,
    meaning="Off is written for a topic that has a KeepWithin.",
    why="The rate of a topic is the ceiling of what its bound may send. With Off nothing passes, and the "
    "operator's picture gets as wrong as it gets; every such message counts as a broken bound.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  KeepWithin /odom position 0.05
  If CheckValue /battery_state level < 20 Then
    SetFrequency /odom Off
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  KeepWithin /odom position 0.05
  If CheckValue /battery_state level < 20 Then
    SetFrequency /odom 1
end
"""
    ),
    find=_find,
)
