# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The last hour of a robot, as its statuses tell it."""

from __future__ import annotations

import math
from dataclasses import replace

from robot.status.statuses import RELAYED, STATUS
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.remote_robots import RuleText, RuleTexts
from smarttestudo.domain.signal import Truth
from smarttestudo.domain.status import BlockStatus, CheckStatus, RulesInForce, RulesOrigin, RuntimeStatus
from smarttestudo.ruler.robots.history import (
    KEPT_S,
    MAX_EVENTS,
    MAX_EVENTS_TOLD,
    MAX_POINTS_TOLD,
    RobotEvent,
    RobotHistory,
)
from smarttestudo.ruler.robots.watch import SeenRobot, words_of

TEXT = """\
begin
  SetFrequency /imu Full
  Rule "Bay" If (CheckValue /odom pose_x > 1 AND CheckValue /odom pose_y < 2) Then SetFrequency /imu 5 EndIf
end
"""
WORDS = words_of(RuleTexts(files=(RuleText("bay.adirf", TEXT),), full_names={}))
RULES = RulesInForce(paths=("bay.adirf",), sha256=WORDS.sha256, origin=RulesOrigin.FILES)


def status(*, in_bay: bool, x: float = 0.0) -> RuntimeStatus:
    state = Truth.TRUE if in_bay else Truth.FALSE
    places = {
        name: TEXT.splitlines()[2].index(f"CheckValue /odom {name}") + 1 for name in ("pose_x", "pose_y")
    }
    checks = tuple(
        CheckStatus(line=3, column=column, state=state, value=x if name == "pose_x" else 1.5)
        for name, column in places.items()
    )
    imu = replace(
        RELAYED,
        target_hz=5.0 if in_bay else math.inf,
        rule="Bay" if in_bay else None,
        reason=Reason.BLOCK if in_bay else Reason.DEFAULT,
    )
    block = BlockStatus(file=0, line=3, column=3, state=state, checks=checks)
    return replace(STATUS, rules=RULES, topics={"/imu": imu}, blocks=(block,))


def seen(one: RuntimeStatus, heard_s: float) -> SeenRobot:
    return SeenRobot(status=one, heard_s=heard_s, size_bytes=900, words=WORDS)


def words(event: RobotEvent) -> tuple[str, str, str, str, str]:
    return event.kind.value, event.name, event.before, event.after, event.because


def test_changes_of_rates_rules_and_files_are_told_newest_first_with_the_way_it_went() -> None:
    history = RobotHistory()
    history.add(seen(status(in_bay=False), 100.0))
    history.add(seen(status(in_bay=False, x=1.0), 101.0))
    history.add(seen(status(in_bay=True, x=2.0), 102.0))
    fallback = replace(status(in_bay=True, x=3.0), rules=RulesInForce(origin=RulesOrigin.FALLBACK))
    history.add(seen(fallback, 103.5))
    answer = history.answer(110.0)
    assert answer.since_s_ago == 10.0
    assert [(one.s_ago, *words(one)) for one in answer.events] == [
        (6.5, "rules", "rules", f"{WORDS.sha256[:8]} (files)", "no valid rules", ""),
        (8.0, "rule", "Bay", "false", "true", ""),
        (8.0, "rate", "/imu", "Full", "5 Hz", "Bay"),
    ]
    assert answer.pose_topic == "/odom"
    assert answer.path == ((10.0, 0.0, 1.5), (9.0, 1.0, 1.5), (8.0, 2.0, 1.5), (6.5, 3.0, 1.5))


def test_an_hour_is_kept_and_memory_is_bounded_however_much_changes() -> None:
    history = RobotHistory()
    for step in range(2 * MAX_EVENTS):
        history.add(seen(status(in_bay=step % 2 == 0, x=float(step)), step * 1.0))
    now_s = 2.0 * MAX_EVENTS
    answer = history.answer(now_s)
    assert len(answer.events) == MAX_EVENTS_TOLD
    assert answer.left_out > MAX_EVENTS - MAX_EVENTS_TOLD
    assert len(answer.path) <= MAX_POINTS_TOLD
    assert answer.path[-1] == (1.0, now_s - 1, 1.5)
    assert answer.path[0][0] <= KEPT_S
    history.add(seen(status(in_bay=True), now_s + KEPT_S))
    later = history.answer(now_s + KEPT_S)
    assert [one.s_ago for one in later.events] == [0.0, 0.0]
    assert later.left_out == 0


def test_a_robot_whose_rules_read_no_place_has_no_path() -> None:
    history = RobotHistory()
    history.add(seen(replace(status(in_bay=False), blocks=()), 1.0))
    answer = history.answer(2.0)
    assert (answer.path, answer.pose_topic, answer.events) == ((), None, ())


def test_a_runtime_that_ended_counts_as_silent_within_three_seconds() -> None:
    one = seen(replace(status(in_bay=False), status_hz=1.0), 10.0)
    assert one.is_heard(12.0)
    assert not one.is_heard(12.5)
    slow = seen(replace(status(in_bay=False), status_hz=0.2), 10.0)
    assert slow.is_heard(20.0)
