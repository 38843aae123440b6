# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One state a robot, from its link, its rules and its topics."""

from __future__ import annotations

from dataclasses import replace

import pytest

from robot.status.statuses import RELAYED, STATUS, WELL
from smarttestudo.domain.health import robot_health, robot_problems
from smarttestudo.domain.link import LinkState, StreamCounts, TopicOnLink
from smarttestudo.domain.robot import DiagnosticLevel
from smarttestudo.domain.signal import Truth
from smarttestudo.domain.status import LossBeforeRelay, RuntimeStatus, Silence, TopicStatus
from smarttestudo.robot.diagnostics import diagnostics

(BLOCK,) = STATUS.blocks[:1]
IN_DOUBT, HELD = replace(BLOCK, state=Truth.UNKNOWN), replace(BLOCK, state=Truth.TRUE)
GONE = replace(RELAYED, silence=Silence.NO_PUBLISHER)
SLOW = replace(RELAYED, silence=Silence.SOURCE_SILENT)
LOSING = replace(RELAYED, loss=LossBeforeRelay(percent=40.0, remedy="raise the depth"))
LATE = replace(RELAYED, on_link=TopicOnLink(counts=StreamCounts(), age_ms=1001.0))
OVERFLOWING = replace(RELAYED, on_link=TopicOnLink(counts=StreamCounts(overflowed=3, is_losing=True)))


def with_topics(**topics: TopicStatus) -> RuntimeStatus:
    return replace(WELL, topics={f"/{name}": topic for name, topic in topics.items()})


def said(status: RuntimeStatus, silent_s: float | None = None) -> list[tuple[str, str]]:
    return [(one.level.name, one.message) for one in robot_problems(status, silent_s)]


@pytest.mark.parametrize(
    ("status", "expected"),
    [
        (WELL, []),
        (with_topics(a=GONE, b=GONE, c=GONE, d=GONE), [("ERROR", "no publisher: /a, /b, /c and 1 more")]),
        (with_topics(a=GONE, b=RELAYED), [("WARN", "no publisher: /a")]),
        (with_topics(a=SLOW), [("ERROR", "source is silent: /a")]),
        # What is Off on purpose is not missed.
        (
            with_topics(a=GONE, b=replace(RELAYED, silence=Silence.OFF)),
            [("ERROR", "no publisher: /a")],
        ),
        (with_topics(a=replace(RELAYED, keeps_rate=False, error_percent=-30.0)), []),
        (with_topics(a=LOSING, b=LOSING), [("WARN", "lost before relay: /a, /b; raise the depth")]),
        (with_topics(a=LATE), [("WARN", "late: /a")]),
        (with_topics(a=OVERFLOWING), [("WARN", "lost on the link: /a")]),
        (replace(WELL, link=LinkState()), [("WARN", "no operator is connected over the link")]),
        (replace(WELL, budget_kb_per_s=0.0), [("WARN", "over budget: 16.0 of 0.0 KB/s are sent")]),
        (
            replace(WELL, blocks=(IN_DOUBT, HELD)),
            [("WARN", "rules in doubt: 1 of 2 conditions, as a value is not known")],
        ),
        (
            replace(with_topics(a=GONE), blocks=(IN_DOUBT,), floors_break_budget=True),
            [
                ("ERROR", "the floors alone are more than the budget"),
                ("ERROR", "no publisher: /a"),
                ("ERROR", "rules in doubt: 1 of 1 condition, as a value is not known"),
            ],
        ),
    ],
)
def test_what_is_worst_stands_first(status: RuntimeStatus, expected: list[tuple[str, str]]) -> None:
    assert said(status) == expected
    (node, *_) = diagnostics(status)
    worst = robot_health(status)
    assert (node.level, node.message) == (worst.level, worst.message)


@pytest.mark.parametrize(
    ("silent_s", "words"),
    [(7.9, "7 s"), (119, "119 s"), (582, "9 min"), (7199, "119 min"), (7200, "2 h"), (400_000, "4 days")],
)
def test_of_a_silent_robot_nothing_else_is_known(silent_s: float, words: str) -> None:
    (silent,) = robot_problems(with_topics(a=GONE), silent_s)
    assert (silent.level, silent.summary) == (DiagnosticLevel.ERROR, f"silent for {words}")
