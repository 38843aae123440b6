# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Decisions of rules over a recording, without making another one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.profile import Profile
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.replays.replay import ReplayRequest, replay


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
