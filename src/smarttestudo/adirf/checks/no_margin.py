# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Blocks that meet at a border without a margin."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.adirf.boxes import Border
from smarttestudo.adirf.checks import wording
from smarttestudo.adirf.checks.analysis import Meeting
from smarttestudo.adirf.checks.rule_book import RuleBook
from smarttestudo.adirf.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.profile import Profile


def _find(book: RuleBook) -> Iterator[Found]:
    settle_s = (book.context.profile or Profile()).settle_s
    borders: dict[Border, Meeting] = {}
    for meeting in book.analysis.meetings:
        borders.setdefault(meeting.border, meeting)
    return (_found(meeting, settle_s) for meeting in borders.values())


def _found(meeting: Meeting, settle_s: float) -> Found:
    topic = meeting.topics[0]
    here = meeting.second.settings[topic]
    path = meeting.second.block.path
    border = f"{meeting.border.signal} = {wording.number(meeting.border.value)}"
    return Found(
        path=path,
        span=here.span,
        message=f"{wording.branch_name(meeting.second)} and "
        f"{wording.branch_with_place(meeting.first, seen_from=path)} meet at {border} without a margin: "
        f"there, noise moves {topic} between {meeting.first.rate(topic)} and {here.rate}",
        hint=f"a lower rate waits {settle_s:g} s before it counts; raise settle_s in the profile if the "
        "robot lingers on this border",
    )


CHECK = RuleCheck(
    code="no-margin",
    severity=Severity.INFO,
    meaning="Two blocks with different rates end and begin at the same number.",
    why="A robot that stands on the border is now in the one block and now in the other, because a "
    "measurement has noise. The loop raises a rate at once and lowers it only after settle_s, so that "
    "it does not flicker while the noise is faster than that. Where the robot lingers on the border, a "
    "longer settle_s helps, or a strip between the blocks that is left to the default. Each "
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
