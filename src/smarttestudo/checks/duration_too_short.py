# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Durations shorter than the time between two messages."""

from __future__ import annotations

import math
from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.written import times_in
from smarttestudo.domain.finding import Fix, Severity
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.signal import ArrivalProperty
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.language.syntax import Timed, checks_in


def _find(book: RuleModel) -> Iterator[Found]:
    for block, timed in times_in(book.blocks):
        fastest = _fastest_source(timed, book)
        if fastest is None or timed.duration.ns == 0:
            continue
        topic, source_hz = fastest
        if timed.duration.ns * source_hz < NS_PER_S:
            yield Found(
                path=block.path,
                span=timed.duration.span,
                message=f"'{wording.time_text(timed)}' is shorter than the {1 / source_hz:.3g} s between two "
                f"messages of {topic}: one message decides it",
                fix=Fix(
                    span=timed.duration.span,
                    replacement=f"{_at_least_ms(source_hz)} ms",
                    title=f"write {_at_least_ms(source_hz)} ms",
                ),
                hint=f"give at least {1 / source_hz:.3g} s, or delete the '{timed.word.value}'",
            )


def _at_least_ms(source_hz: float) -> int:
    """The least whole ms in which a message comes."""
    return math.ceil(NS_PER_S / NS_PER_MS / source_hz)


def _fastest_source(timed: Timed, book: RuleModel) -> tuple[str, float] | None:
    """The topic that changes the condition most often, and its Hz; ``None`` where that is not known."""
    found: tuple[str, float] | None = None
    for check in checks_in(timed):
        topic = book.context.resolve(check.topic.text)
        source_hz = book.context.topic(topic).source_hz
        if not source_hz or ArrivalProperty.named(check.property) is not None:
            return None
        if found is None or source_hz > found[1]:
            found = topic, source_hz
    return found


_PROFILE = Profile(topics={"/odom": TopicProfile(source_hz=10.0)})

CHECK = RuleCheck(
    code="duration-too-short",
    severity=Severity.WARNING,
    meaning="A duration is shorter than the time between two messages of what its condition reads.",
    why="A condition can change with a message only, so that one message already makes it hold For the whole "
    "duration, or ends what it was Within. The profile's source_hz says how often messages come.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /odom speed > 1 For 50 ms Then
    SetFrequency /odom 20
end
""",
        profile=_PROFILE,
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /odom speed > 1 For 500 ms Then
    SetFrequency /odom 20
end
""",
        profile=_PROFILE,
    ),
    find=_find,
)
