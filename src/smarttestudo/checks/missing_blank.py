# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Keywords without a blank behind them."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Fix, Severity
from smarttestudo.domain.source import Span


def _find(book: RuleModel) -> Iterator[Found]:
    for path, (first, *others) in book.glued.items():
        start = Span(first.line, first.column, first.line, first.column)
        more = f" (and {len(others)} more like it)" if others else ""
        yield Found(
            path=path,
            span=first,
            message=f"there is no blank between the previous keyword and this word{more}",
            hint="the meaning is the same; testudo fmt inserts all missing blanks",
            fix=Fix(span=start, replacement=" ", title="insert a blank here"),
        )


CHECK = RuleCheck(
    code="missing-blank",
    severity=Severity.INFO,
    meaning="A keyword is written without a blank after it.",
    why="The rules work regardless, as they do with the grammar of the thesis; people and other tools may "
    "read the two words as one. After the name of a topic a blank is required, or the name would continue.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  SetFrequency/scan 3
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  SetFrequency /scan 3
end
"""
    ),
    find=_find,
)
