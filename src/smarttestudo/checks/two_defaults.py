# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Two defaults for one topic."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Fix, Severity


def _find(book: RuleModel) -> Iterator[Found]:
    for one in book.written_defaults:
        last = book.defaults[one.topic]
        if one is not last:
            where = wording.place(last.path, last.span, seen_from=one.path)
            yield Found(
                path=one.path,
                span=one.span,
                message=f"this default of {one.topic} is overridden by that of {where}",
                hint="the last default counts; remove this one",
                fix=Fix(span=one.span, replacement="", title="remove the overridden default"),
            )


CHECK = RuleCheck(
    code="two-defaults",
    severity=Severity.WARNING,
    meaning="A topic has two defaults, in one file or in two of a set.",
    why="Only the last one counts; editing the other one changes nothing.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  SetFrequency /scan 5
  SetFrequency /odom 4
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 4
  SetFrequency /scan 5
end
"""
    ),
    find=_find,
)
