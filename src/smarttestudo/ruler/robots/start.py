# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules and topic parameters that start from what a robot relays now."""

from __future__ import annotations

from pathlib import Path

from msgspec import Struct

from smarttestudo.domain.rate import RATE_STEP_HZ
from smarttestudo.domain.status import RuntimeStatus, TopicStatus
from smarttestudo.optimizer.profiling import proposed_tiers_hz, rounded
from smarttestudo.ruler.files.recordings import defaults_text
from smarttestudo.ruler.topics.profile_table import (
    ProfileRow,
    ProfileTable,
    SixLevels,
    six_levels,
    write_table,
)


class RobotStartAnswer(Struct, frozen=True, kw_only=True):
    """The topics that a robot relays, a rule file that relays every message of them, and their profile."""

    topics: tuple[str, ...]
    rules_text: str
    profile_text: str


def robot_start(status: RuntimeStatus) -> RobotStartAnswer:
    """Start from the types, rates and sizes in ``status``; what it does not know is left out."""
    topics = sorted(status.topics)
    rows = tuple(_row(topic, status.topics[topic]) for topic in topics)
    table = ProfileTable(rows=rows, budget_kb_per_s=status.budget_kb_per_s)
    return RobotStartAnswer(
        topics=tuple(topics),
        rules_text=defaults_text(topics, "relayed"),
        profile_text=write_table(table, "", Path("profile.toml")),
    )


def _row(topic: str, status: TopicStatus) -> ProfileRow:
    source_hz = None if not status.source_hz else rounded(status.source_hz)
    is_sized = source_hz is not None and status.in_kb_per_s > 0
    return ProfileRow(
        topic=topic,
        type=status.type_name,
        source_hz=source_hz,
        message_kb=rounded(status.in_kb_per_s / source_hz) if is_sized and source_hz else None,
        tiers_hz=None if source_hz is None else _levels(source_hz),
    )


def _levels(source_hz: float) -> SixLevels | None:
    levels = proposed_tiers_hz(source_hz)
    return six_levels(levels) if min(levels) >= RATE_STEP_HZ else None
