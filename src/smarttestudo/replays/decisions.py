# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Decisions of rules over a recording, without making another one."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import Channel
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
                output=Path(),
                profile=profile,
                decided=decisions.extend,
                report=report,
                writer=_Nowhere(),
            )
        )
    return decisions


class _Nowhere:
    """A writer that keeps nothing."""

    def add(self, _channel: Channel) -> None:
        """Nothing is written."""

    def write(self, _channel: Channel, _stamp_ns: int, _payload: bytes) -> None:
        """Nothing is written."""
