# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Decisions that recordings hold, and those of rules over one, without making another one."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.decision import AnyDecision, Decision
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.profile import Profile
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.replays.moment import recorded_decisions
from smarttestudo.replays.replay import ReplayRequest, replay


def kept_decisions(*bags: Path | None) -> list[AnyDecision]:
    """The decisions in the first of ``bags`` that has those of one robot."""
    for bag in filter(None, bags):
        with suppress(RecordingError), open_recording(bag) as recording:
            if decisions := recorded_decisions(recording):
                return [decision for _, decision in decisions]
    return []


def decisions_over(
    bag: Path, rule_set: RuleSet, profile: Profile, report: Callable[[float], None]
) -> list[Decision]:
    """The decisions of a replay of ``bag``; ``report`` gets the share done. Raises ``RecordingError``."""
    decisions: list[Decision] = []
    with open_recording(bag) as recording:
        replay(
            ReplayRequest(
                recording=recording,
                rule_set=rule_set,
                output=None,
                profile=profile,
                decided=decisions.extend,
                report=report,
            )
        )
    return decisions
