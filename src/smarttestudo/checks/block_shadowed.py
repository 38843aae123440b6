# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Blocks that can never decide anything."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.analysis import Shadow, wins_over
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity


def _find(book: RuleModel) -> Iterator[Found]:
    return (_found(shadow) for shadow in book.analysis.shadows)


def _found(shadow: Shadow) -> Found:
    branch = shadow.branch
    path = branch.block.path
    rivals = [wording.branch_with_place(rival, seen_from=path) for rival in shadow.rivals]
    verb = "wins" if len(rivals) == 1 else "win"
    return Found(
        path=path,
        span=branch.written[0].span.to(branch.written[-1].span),
        message=f"{wording.branch_name(branch)} never decides a rate: wherever it holds, "
        f"{wording.listed(rivals)} {verb} by {wording.listed(_reasons(shadow))}",
        hint="give it a higher Priority, or remove it",
        related=wording.places_in(path, shadow.rivals),
    )


def _reasons(shadow: Shadow) -> list[str]:
    """What makes the rivals win: a higher priority, else a higher rate, else the place in the file."""
    loser = shadow.branch
    reasons: set[str] = set()
    for rival in shadow.rivals:
        topics = [topic for topic in loser.settings if topic in rival.settings]
        if rival.block.priority > loser.block.priority:
            reasons.add("priority")
        elif any(
            rival.rate(topic) != loser.rate(topic) for topic in topics if wins_over(rival, loser, topic)
        ):
            reasons.add("rate")
        else:
            reasons.add("order")
    return [reason for reason in ("priority", "rate", "order") if reason in reasons]


CHECK = RuleCheck(
    code="block-shadowed",
    severity=Severity.WARNING,
    meaning="A block can never decide any of its topics.",
    why="Wherever it holds, blocks of higher priority, or of the same priority and a higher rate, set all "
    "its topics too (among equals, the first block in the file is the one that decides). It has no "
    "effect, mostly because a number or a Priority is wrong.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  Rule "Anywhere east" Priority 1 If CheckValue /odom pose_x > 0 Then
    SetFrequency /odom 4
  EndIf
  Rule "Far east" If CheckValue /odom pose_x > 20 Then
    SetFrequency /odom 20
  EndIf
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  Rule "Anywhere east" Priority 1 If CheckValue /odom pose_x > 0 Then
    SetFrequency /odom 4
  EndIf
  Rule "Far east" Priority 2 If CheckValue /odom pose_x > 20 Then
    SetFrequency /odom 20
  EndIf
end
"""
    ),
    find=_find,
)
