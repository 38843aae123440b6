# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Keywords without a blank behind them."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.adirf.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.adirf.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Fix, Severity
from smarttestudo.domain.source import Span


def _find(book: RuleModel) -> Iterator[Found]:
    for path, (first, *others) in book.glued.items():
        start = Span(first.line, first.column, first.line, first.column)
        more = f" (and {len(others)} more like it)" if others else ""
        yield Found(
            path=path,
            span=first,
            message=f"no blank stands between this word and the keyword before it{more}",
            hint="it means the same with one; testudo fmt puts all of them in",
            fix=Fix(span=start, replacement=" ", title="put a blank here"),
        )


CHECK = RuleCheck(
    code="missing-blank",
    severity=Severity.INFO,
    meaning="A keyword is written without a blank behind it.",
    why="The rules work all the same, as they do with the grammar of the thesis; people and other tools may "
    "read the two words as one. Behind the name of a topic a blank is needed, since the name would go on.",
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
