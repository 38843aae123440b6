# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Blocks that can hold together at one priority and set different rates."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.analysis import Clash
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity


def _find(book: RuleModel) -> Iterator[Found]:
    return (_found(clash) for clash in book.analysis.clashes)


def _found(clash: Clash) -> Found:
    topic = clash.topics[0]
    here = clash.second.settings[topic]
    path = clash.second.block.path
    others = f" (and {wording.listed(clash.topics[1:])})" if len(clash.topics) > 1 else ""
    state = wording.state(clash.state)
    return Found(
        path=path,
        span=here.span,
        message=f"{wording.branch_name(clash.second)} sets {topic} to {here.rate}{others}, "
        f"{wording.branch_with_place(clash.first, seen_from=path)} to {clash.first.rate(topic)}, "
        f"and both hold {f'for example at {state}' if state else 'in some state'}",
        related=wording.places_in(path, [clash.first]),
        hint="the higher rate wins; give one block a higher Priority, or keep their conditions apart",
    )


CHECK = RuleCheck(
    code="blocks-clash",
    severity=Severity.WARNING,
    meaning="Two blocks of one priority can hold together and set a topic to different rates.",
    why="The higher rate wins, whatever the order in the file. If the lower one was meant, the link carries "
    "more than planned. At most three clashes are shown for one block.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  Rule "Corridor" If CheckValue /odom pose_x < 6 Then
    SetFrequency /odom 4
  EndIf
  Rule "Low battery" If CheckValue /battery_state level < 20 Then
    SetFrequency /odom 2
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
  Rule "Low battery" Priority 1 If CheckValue /battery_state level < 20 Then
    SetFrequency /odom 2
  EndIf
end
"""
    ),
    find=_find,
)
