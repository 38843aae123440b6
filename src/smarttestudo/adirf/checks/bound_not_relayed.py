# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bounds of topics that are not relayed."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.adirf.checks.new_default import new_default
from smarttestudo.adirf.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.adirf.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity


def _find(book: RuleModel) -> Iterator[Found]:
    for one in book.bounds:
        if one.topic not in book.relayed:
            yield Found(
                path=one.path,
                span=one.statement.topic.span,
                message=f"{one.topic} is not relayed: no SetFrequency or KeepAtLeast names it",
                hint=f"add SetFrequency {one.statement.topic.text} Full",
                fix=new_default(book.files.get(one.path), one.statement.topic.text),
            )


CHECK = RuleCheck(
    code="bound-not-relayed",
    severity=Severity.WARNING,
    meaning="A KeepWithin names a topic that no SetFrequency or KeepAtLeast names.",
    why="Only topics of a SetFrequency or KeepAtLeast are relayed. A bound alone relays nothing, so the "
    "operator has no picture of this topic at all.",
    bad=Example(
        rules="""\
begin
  SetFrequency /scan 5
  KeepWithin /odom position 0.05
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /scan 5
  SetFrequency /odom Full
  KeepWithin /odom position 0.05
end
"""
    ),
    find=_find,
    needs_all_statements=True,
)
