# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""= on a measured number."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.written import CheckSite
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.signal import ArrivalProperty
from smarttestudo.language.syntax import Operator

_OUTCOME = {Operator.EQUAL: "hardly ever", Operator.NOT_EQUAL: "nearly always"}
_ZERO_WHEN_SILENT = (ArrivalProperty.RATE, ArrivalProperty.BANDWIDTH)


def _find(book: RuleModel) -> Iterator[Found]:
    for one in book.checks:
        outcome = _OUTCOME.get(one.check.operator)
        if outcome is not None and _is_continuous(one, book):
            yield Found(
                path=one.path,
                span=one.check.span,
                message=f"{one.check.property} is measured: '{one.check.operator.value} {one.check.text}' "
                f"{outcome} holds",
                hint="compare with a range, a > below the number and a < above it",
            )


def _is_continuous(one: CheckSite, book: RuleModel) -> bool:
    """A property known to be measured, or a number with a fraction, which no state or count has."""
    if one.check.value == 0 and ArrivalProperty.named(one.signal.property) in _ZERO_WHEN_SILENT:
        return False
    return book.context.is_measured(one.signal) or not one.check.value.is_integer()


CHECK = RuleCheck(
    code="equals-measured",
    severity=Severity.WARNING,
    meaning="= or != compares a measured number.",
    why="A measurement has noise and many digits: it is almost never exactly "
    "3. Counts, states and flags (status.status = 2) are fine, and so are rate = 0 and bandwidth = 0.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /odom pose_x = 3 Then
    SetFrequency /odom 4
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If (CheckValue /odom pose_x > 2.9 AND CheckValue /odom pose_x < 3.1) Then
    SetFrequency /odom 4
end
"""
    ),
    find=_find,
)
