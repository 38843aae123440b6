# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that never hold."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.value_ranges import checks_that_are
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.signal import Truth


def _find(book: RuleModel) -> Iterator[Found]:
    return checks_that_are(Truth.FALSE, "never", book)


CHECK = RuleCheck(
    code="check-never-holds",
    severity=Severity.WARNING,
    meaning="A check compares a property with a number that it never reaches.",
    why="The rate that depends on it is never used. A battery level, for example, is in percent, so "
    "that 120 is above every level.",
    bad=Example(
        rules="""\
begin
  SetFrequency /scan 5
  If CheckValue /battery_state level > 120 Then
    SetFrequency /scan 2
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /scan 5
  If CheckValue /battery_state level > 20 Then
    SetFrequency /scan 2
end
"""
    ),
    find=_find,
)
