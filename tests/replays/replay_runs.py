# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Replays of small bags, with what went in, what came out and what was decided."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bags.bag_factory import BagContent, BagMessage, write_bag
from bags.bag_reading import read_bag
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.names import DECISIONS_TOPIC
from smarttestudo.domain.profile import Profile
from smarttestudo.replays.outcome import ReplayOutcome
from smarttestudo.replays.replay import ReplayRequest, replay
from smarttestudo.rules.rule_sets import load_rules


@dataclass(frozen=True)
class ReplayRun:
    """``messages`` are those relayed, ``recorded`` the decisions in the new recording."""

    outcome: ReplayOutcome
    messages: list[BagMessage]
    decisions: list[Decision]
    recorded: list[BagMessage]
    progress: list[float]
    output: Path

    def on(self, topic: str) -> list[BagMessage]:
        return [message for message in self.messages if message.topic == topic]


def replay_bag(
    bag: Path, rules: str, folder: Path, *, profile: Profile | None = None, **options: Any
) -> ReplayRun:
    rule_file = folder / "rules.adirf"
    rule_file.write_text(f"begin\n{rules}\nend\n")
    profile = profile or Profile()
    rules_loaded = load_rules([rule_file], profile=profile)
    assert rules_loaded.errors == ()
    decisions: list[Decision] = []
    shares: list[float] = []
    output = folder / "monitored"
    with open_recording(bag) as recording:
        outcome = replay(
            ReplayRequest(
                recording=recording,
                rule_set=rules_loaded.rule_set,
                profile=profile,
                output=output,
                decided=decisions.extend,
                report=shares.append,
                **options,
            )
        )
    messages = read_bag(output).messages
    relayed, recorded = of_robot(messages), [one for one in messages if one.topic == DECISIONS_TOPIC]
    return ReplayRun(outcome, relayed, decisions, recorded, shares, output)


def of_robot(messages: Iterable[BagMessage]) -> list[BagMessage]:
    """``messages`` without the decisions of a replay."""
    return [one for one in messages if one.topic != DECISIONS_TOPIC]


def replay_content(
    content: BagContent,
    rules: str,
    folder: Path,
    *,
    custom_data: dict[str, str] | None = None,
    **options: Any,
) -> ReplayRun:
    return replay_bag(write_bag(folder / "bag", content, custom_data=custom_data), rules, folder, **options)
