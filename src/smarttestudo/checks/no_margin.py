# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Blocks that meet at a border without a margin."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.analysis import SharedBorder
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.profile import Profile
from smarttestudo.language.boxes import Border


def _find(book: RuleModel) -> Iterator[Found]:
    settle_s = (book.context.profile or Profile()).settle_s
    borders: dict[Border, SharedBorder] = {}
    for shared in book.analysis.shared_borders:
        borders.setdefault(shared.border, shared)
    return (_found(shared, settle_s) for shared in borders.values())


def _found(shared: SharedBorder, settle_s: float) -> Found:
    topic = shared.topics[0]
    here = shared.second.settings[topic]
    path = shared.second.block.path
    border = f"{shared.border.signal} = {wording.number(shared.border.value)}"
    return Found(
        path=path,
        span=here.span,
        message=f"{wording.branch_name(shared.second)} and "
        f"{wording.branch_with_place(shared.first, seen_from=path)} meet at {border} without a margin: "
        f"there, noise moves {topic} between {shared.first.rate(topic)} and {here.rate}",
        hint=f"a lower rate waits {settle_s:g} s before it counts; raise settle_s in the profile if the "
        "robot stays on this border",
    )


CHECK = RuleCheck(
    code="no-margin",
    severity=Severity.INFO,
    meaning="Two blocks with different rates end and begin at the same number.",
    why="A robot that stands on the border is alternately in one block and in the other, because a "
    "measurement has noise. The loop raises a rate at once and lowers it only after settle_s, so it "
    "does not flicker while the noise is faster than that. Where the robot stays on the border for "
    "long, a longer settle_s helps, or a strip between the blocks that is left to the default. Each "
    "border is shown once.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  Rule "West" If CheckValue /odom pose_x < 5 Then
    SetFrequency /odom 4
  EndIf
  Rule "East" If CheckValue /odom pose_x > 5 Then
    SetFrequency /odom 20
  EndIf
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  Rule "West" If CheckValue /odom pose_x < 4.5 Then
    SetFrequency /odom 4
  EndIf
  Rule "East" If CheckValue /odom pose_x > 5.5 Then
    SetFrequency /odom 20
  EndIf
end
"""
    ),
    find=_find,
)
