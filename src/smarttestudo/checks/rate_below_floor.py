# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates below a floor."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Fix, Severity


def _find(book: RuleModel) -> Iterator[Found]:
    for one in book.settings:
        floor = book.floors.get(one.topic)
        if floor is None or floor.rate is None or one.rate is None or not one.rate.yields_to_floor:
            continue
        if one.rate.hz < floor.rate.hz:
            where = wording.place(floor.path, floor.span, seen_from=one.path)
            yield Found(
                path=one.path,
                span=one.statement.rate.span,
                message=f"{one.rate} is below the floor of {one.topic}: KeepAtLeast ({where}) raises it to "
                f"{floor.rate}",
                hint="write the floor's rate here, or lower the floor",
                fix=Fix(
                    span=one.statement.rate.span,
                    replacement=floor.statement.rate.text,
                    title="write the rate that it has anyway",
                ),
            )


CHECK = RuleCheck(
    code="rate-below-floor",
    severity=Severity.WARNING,
    meaning="A rate lies below the topic's KeepAtLeast.",
    why="No rate goes below a floor, so the topic gets the floor's rate and the written one never occurs.",
    bad=Example(
        rules="""\
begin
  KeepAtLeast /odom 5
  SetFrequency /odom 10
  If CheckValue /battery_state level < 20 Then
    SetFrequency /odom 2
end
"""
    ),
    good=Example(
        rules="""\
begin
  KeepAtLeast /odom 2
  SetFrequency /odom 10
  If CheckValue /battery_state level < 20 Then
    SetFrequency /odom 2
end
"""
    ),
    find=_find,
)
