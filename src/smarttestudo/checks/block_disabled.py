# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Blocks that are switched off."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.source import Span
from smarttestudo.language.parser.tokens import TokenKind


def _find(book: RuleModel) -> Iterator[Found]:
    for one in book.disabled.blocks:
        whole = one.block.span
        end = whole.column + len(TokenKind.DISABLED.value)
        yield Found(
            path=one.path,
            span=Span(whole.line, whole.column, whole.line, end),
            message=f"{wording.sentence(wording.block_name(one.block))} is switched off",
            hint="it changes no rate, whatever holds; delete 'Disabled' to switch it on",
        )


CHECK = RuleCheck(
    code="block-disabled",
    severity=Severity.INFO,
    meaning="A block is switched off with Disabled.",
    why="It is read and kept, and its names are checked, but no rate, bound or recording comes from it. "
    "Whoever counts on the block should know.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  Disabled Rule "Corridor" If CheckValue /odom pose_x < 6 Then
    SetFrequency /odom 4
  EndIf
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  Rule "Corridor" If CheckValue /odom pose_x < 6 Then
    SetFrequency /odom 4
  EndIf
end
"""
    ),
    find=_find,
)
