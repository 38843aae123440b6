# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""AND and OR mixed without parentheses."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.written import conditions_in
from smarttestudo.domain.finding import Fix, Severity
from smarttestudo.language.comments import COMMENT_START
from smarttestudo.language.formatter.conditions import write_condition
from smarttestudo.language.formatter.text import LineWriter
from smarttestudo.language.syntax import And, Or


def _find(book: RuleModel) -> Iterator[Found]:
    for block in book.blocks:
        for part in conditions_in(block.block.condition):
            if isinstance(part, Or):
                bare = [operand for operand in part.operands if isinstance(operand, And)]
                if bare:
                    yield Found(
                        path=block.path,
                        span=bare[0].span,
                        message="AND binds tighter than OR: this AND is one side of the OR",
                        hint="put parentheses around the part that belongs together",
                        fix=_fix(bare[0]),
                    )


def _fix(condition: And) -> Fix | None:
    """Parentheses around the AND, which change nothing; comments inside are left to a person."""
    writer = LineWriter()
    write_condition(writer, 0, "", condition)
    text = writer.text().strip()
    if COMMENT_START in text:
        return None
    return Fix(span=condition.span, replacement=text, title="put parentheses around the AND")


CHECK = RuleCheck(
    code="and-or-mixed",
    severity=Severity.WARNING,
    meaning="AND and OR are mixed without parentheses.",
    why="AND binds tighter than OR. Reading the condition from left to right gives another meaning.",
    bad=Example(
        rules="""\
begin
  SetFrequency /scan 5
  If (CheckValue /scan distance < 0.5 OR CheckValue /odom speed > 1 AND CheckValue /odom pose_x > 6) Then
    SetFrequency /scan 10
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /scan 5
  If (CheckValue /scan distance < 0.5 OR (CheckValue /odom speed > 1 AND CheckValue /odom pose_x > 6)) Then
    SetFrequency /scan 10
end
"""
    ),
    find=_find,
)
