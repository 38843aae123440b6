# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robots, as the page is told of them.

A robot here is a running ``testudo run``: its ``node`` is ``/smarttestudo``, or ``ada:/smarttestudo`` where
it has a link and a name on it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from msgspec import Struct

from smarttestudo.domain.decision import bound_texts
from smarttestudo.domain.health import Health, robot_health, topic_health
from smarttestudo.domain.link import LinkState
from smarttestudo.domain.rate import RATE_STEP_HZ
from smarttestudo.domain.record import Measured
from smarttestudo.domain.robot import DiagnosticLevel
from smarttestudo.domain.status import RulesInForce, RuntimeStatus, TopicStatus
from smarttestudo.domain.units import BYTES_PER_KB
from smarttestudo.optimizer.profiling import proposed_tiers_hz, rounded
from smarttestudo.robot.diagnostics import accepted_text, recording_text
from smarttestudo.ruler.files.recordings import defaults_text
from smarttestudo.ruler.robots.watch import RobotCheck, SeenRobot, written_checks
from smarttestudo.ruler.topics.profiles import (
    ProfileRow,
    ProfileTable,
    SixLevels,
    six_levels,
    write_table,
)

HealthLevel = Literal["ok", "warn", "error", "stale"]
_LEVELS: Mapping[DiagnosticLevel, HealthLevel] = {
    DiagnosticLevel.OK: "ok",
    DiagnosticLevel.WARN: "warn",
    DiagnosticLevel.ERROR: "error",
    DiagnosticLevel.STALE: "stale",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class HealthWords:
    """How bad something is, what in a few words, and all that is known of it.

    It says what ``testudo top`` and /diagnostics do.
    """

    level: HealthLevel
    summary: str
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotSummary:
    """One robot of a list; ``label`` is what people call it, ``health`` null where all is well.

    ``is_heard`` is false once it has been silent for longer than it should be; ``heard_s_ago`` is the time
    since its last status. ``topics`` are counted, ``recorded`` the incidents on its disk since it started.
    """

    node: str
    label: str
    is_heard: bool
    heard_s_ago: Measured
    health: HealthWords | None
    rules: RulesInForce
    topics: int
    budget_kb_per_s: float | None
    out_kb_per_s: Measured
    link: LinkState | None
    recorded: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Live:
    """The status of a robot, and what it does not say itself.

    ``health`` is that of the topics of which there is something to say. ``accepted`` are words for each topic
    that is accepted of operators, ``recording`` those for what is recorded, both in the status's order.
    ``status_kb_per_s`` is what its statuses themselves take of the link at most. ``bounds`` say of topics
    which bound of each property holds, what decided it, and whether that is in doubt. ``labels`` are what
    decisions call the blocks, and ``checks`` the words of the checks, in the order of the status; empty and
    null until the robot's rules were read. ``full_names`` are those of topics that its rules call otherwise.
    """

    kind: Literal["live"] = "live"
    node: str
    status: RuntimeStatus
    status_kb_per_s: Measured
    health: Mapping[str, HealthWords]
    accepted: tuple[str, ...]
    recording: str | None
    bounds: Mapping[str, tuple[str, ...]]
    labels: tuple[str, ...]
    checks: tuple[RobotCheck | None, ...]
    full_names: Mapping[str, str]


def robot_summaries(robots: Iterable[SeenRobot], now_s: float) -> tuple[RobotSummary, ...]:
    """A line for each robot: the worst first, the longest silent before all, then by name."""
    known = [(one, robot_health(one.status, one.silent_s(now_s))) for one in robots]
    known.sort(key=lambda of: (-of[1].level, -(of[0].silent_s(now_s) or 0.0), of[0].status.robot_id))
    return tuple(_robot(one, health, now_s) for one, health in known)


def live_model(seen: SeenRobot) -> Live:
    """All that a page shows of a robot."""
    status, words = seen.status, seen.words
    bounds = {name: bound_texts(topic.within, topic.bound_reasons) for name, topic in status.topics.items()}
    health = {name: topic_health(topic) for name, topic in status.topics.items()}
    return Live(
        node=status.robot_id,
        status=status,
        status_kb_per_s=seen.size_bytes * status.status_hz / BYTES_PER_KB,
        health={
            name: _words(health[name])
            for name, topic in status.topics.items()
            if topic.silence is not None or health[name].level is not DiagnosticLevel.OK
        },
        accepted=tuple(accepted_text(topic) for topic in status.accepted),
        recording=None if status.incidents is None else recording_text(status.incidents),
        bounds={name: texts for name, texts in bounds.items() if texts},
        labels=tuple(words.labels.get((block.file, block.line, block.column), "") for block in status.blocks),
        checks=tuple(check for _, check in written_checks(seen)),
        full_names=words.full_names,
    )


def _words(health: Health) -> HealthWords:
    return HealthWords(level=_LEVELS[health.level], summary=health.summary, message=health.message)


def _robot(seen: SeenRobot, health: Health, now_s: float) -> RobotSummary:
    status = seen.status
    return RobotSummary(
        node=status.robot_id,
        label=robot_label(status),
        is_heard=seen.is_heard(now_s),
        heard_s_ago=max(now_s - seen.heard_s, 0.0),
        health=None if health.level is DiagnosticLevel.OK else _words(health),
        rules=status.rules,
        topics=len(status.topics),
        budget_kb_per_s=status.budget_kb_per_s,
        out_kb_per_s=status.out_kb_per_s,
        link=status.link,
        recorded=0 if status.incidents is None else status.incidents.recorded,
    )


def robot_label(status: RuntimeStatus) -> str:
    """Name that people call the robot by."""
    return status.robot or status.node


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
