# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that always hold."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.value_ranges import checks_that_are
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.signal import Truth


def _find(book: RuleModel) -> Iterator[Found]:
    return checks_that_are(Truth.TRUE, "always", book)


CHECK = RuleCheck(
    code="check-always-holds",
    severity=Severity.WARNING,
    meaning="A check compares a property with a number so that every value passes.",
    why="The check decides nothing. Often the unit differs from the expected one: a battery level, "
    "for example, "
    "is counted in percent.",
    bad=Example(
        rules="""\
begin
  SetFrequency /scan 5
  If CheckValue /battery_state level >= 0 Then
    SetFrequency /scan 2
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /scan 5
  If CheckValue /battery_state level >= 50 Then
    SetFrequency /scan 2
end
"""
    ),
    find=_find,
)
