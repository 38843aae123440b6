# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Off where a floor exists."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Fix, Severity


def _find(book: RuleModel) -> Iterator[Found]:
    for one in book.settings:
        floor = book.floors.get(one.topic)
        if floor is not None and one.rate is not None and not one.rate.yields_to_floor:
            where = wording.place(floor.path, floor.span, seen_from=one.path)
            yield Found(
                path=one.path,
                span=one.statement.rate.span,
                message=f"Off stops {one.topic} although KeepAtLeast ({where}) keeps it at {floor.rate}",
                hint="write 0 for the floor's rate, or remove the KeepAtLeast",
                fix=Fix(
                    span=one.statement.rate.span,
                    replacement=floor.statement.rate.text,
                    title="write the floor's rate",
                ),
            )


CHECK = RuleCheck(
    code="off-despite-floor",
    severity=Severity.WARNING,
    meaning="Off is written for a topic that has a KeepAtLeast.",
    why="Off is the only rate that goes below a floor: who relies on the KeepAtLeast then receives nothing.",
    bad=Example(
        rules="""\
begin
  KeepAtLeast /odom 1
  SetFrequency /odom 10
  If CheckValue /battery_state level < 20 Then
    SetFrequency /odom Off
end
"""
    ),
    good=Example(
        rules="""\
begin
  KeepAtLeast /odom 1
  SetFrequency /odom 10
  If CheckValue /battery_state level < 20 Then
    SetFrequency /odom 1
end
"""
    ),
    find=_find,
)
