# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The values of a robot's checks and when its rules held, as its statuses tell it, in bounded memory."""

from __future__ import annotations

from dataclasses import replace

import pytest

from robot.status.statuses import STATUS
from smarttestudo.domain.remote_robots import RuleText, RuleTexts
from smarttestudo.domain.signal import Truth
from smarttestudo.domain.status import BlockStatus, CheckStatus, RulesInForce, RulesOrigin
from smarttestudo.language.syntax import Operator
from smarttestudo.ruler.robots.checks import (
    BIN_S,
    MAX_CHECKS,
    MAX_TURNS_KEPT,
    RobotChecks,
    RobotChecksAnswer,
    RobotChecksRequest,
)
from smarttestudo.ruler.robots.history import KEPT_S
from smarttestudo.ruler.robots.watch import RuleWords, SeenRobot, words_of

TEXT = """\
begin
  SetFrequency /imu Full
  Rule "Far" If (CheckValue /odom pose_x > 3) Then SetFrequency /imu 5 EndIf
end
"""
WORDS = words_of(RuleTexts(files=(RuleText("far.adirf", TEXT),), full_names={}))
COLUMN = TEXT.splitlines()[2].index("CheckValue") + 1


def seen(
    x: float | None, heard_s: float, *, words: RuleWords = WORDS, status_hz: float = 1.0, sha256: str = ""
) -> SeenRobot:
    """A robot that stands at x; the rule is what its evaluator said."""
    state = Truth.UNKNOWN if x is None else Truth.TRUE if x > 3 else Truth.FALSE
    check = CheckStatus(line=3, column=COLUMN, state=state, value=x)
    status = replace(
        STATUS,
        rules=RulesInForce(paths=("far.adirf",), sha256=sha256 or WORDS.sha256, origin=RulesOrigin.FILES),
        blocks=(BlockStatus(file=0, line=3, column=3, state=state, checks=(check,)),),
        status_hz=status_hz,
    )
    return SeenRobot(status=status, heard_s=heard_s, size_bytes=900, words=words)


def told(
    checks: RobotChecks, now_s: float, window_s: float = 600, check: int | None = 0
) -> RobotChecksAnswer:
    return checks.answer(RobotChecksRequest(node="n", window_s=window_s, check=check), now_s)


def test_the_states_are_the_robots_and_the_values_its_least_and_greatest() -> None:
    checks = RobotChecks()
    for second, x in enumerate([0.0, 1.0, 5.0, 4.0, 2.0, 6.0]):
        checks.add(seen(x, 1000.0 + second))
    answer = told(checks, 1005.0, window_s=10)
    [rule] = answer.rules
    turns = (
        (0.0, Truth.UNKNOWN),
        (5.0, Truth.FALSE),
        (7.0, Truth.TRUE),
        (9.0, Truth.FALSE),
        (10.0, Truth.TRUE),
    )
    assert (rule.rule, rule.turns) == ("Far", turns)
    [check] = answer.checks
    assert (check.rule, check.topic, check.property, check.op, check.limit) == (
        "Far",
        "/odom",
        "pose_x",
        Operator.GREATER,
        3,
    )
    assert answer.values is not None
    assert answer.values.turns == turns
    assert answer.values.least == (None, 0.0, 2.0)
    assert answer.values.greatest == (None, 5.0, 6.0)
    assert (answer.values.first_bin_s, answer.values.bin_s, answer.heard_from_s) == (0.0, BIN_S, 5.0)


def test_while_nothing_is_heard_all_is_unknown_and_has_no_value() -> None:
    checks = RobotChecks()
    checks.add(seen(5.0, 1000.0))
    silent = told(checks, 1020.0, window_s=20)
    assert silent.rules[0].turns == ((0.0, Truth.TRUE), (2.4, Truth.UNKNOWN))
    checks.add(seen(5.0, 1030.0))
    answer = told(checks, 1030.0, window_s=30)
    assert answer.rules[0].turns == ((0.0, Truth.TRUE), (2.4, Truth.UNKNOWN), (30.0, Truth.TRUE))
    assert answer.values is not None
    assert answer.values.least == (5.0, None, None, None, None, None, 5.0)


def test_between_statuses_that_come_when_they_should_the_value_holds() -> None:
    checks = RobotChecks()
    for step in range(3):
        checks.add(seen(float(step), 1000.0 + 20.0 * step, status_hz=0.05))
    answer = told(checks, 1040.0, window_s=40)
    assert answer.values is not None
    assert answer.values.greatest == (0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0)


def test_memory_is_bounded_and_an_hour_is_told_whatever_turns() -> None:
    checks = RobotChecks()
    for step in range(2 * MAX_TURNS_KEPT):
        checks.add(seen(10.0 * (step % 2), 0.5 * step, status_hz=2.0))
    now_s = float(MAX_TURNS_KEPT)
    answer = told(checks, now_s, window_s=KEPT_S)
    [rule] = answer.rules
    assert len(rule.turns) <= MAX_TURNS_KEPT + 2
    assert rule.turns[0] == (0.0, Truth.UNKNOWN)
    assert answer.heard_from_s > KEPT_S / 2
    assert answer.values is not None
    assert len(answer.values.least) <= KEPT_S / BIN_S
    assert {*answer.values.least[:-1]} == {0.0}
    assert {*answer.values.greatest[:-1]} == {10.0}
    many = replace(
        seen(1.0, now_s + 1).status.blocks[0],
        checks=tuple(CheckStatus(line=4, column=at, state=Truth.TRUE, value=1.0) for at in range(500)),
    )
    status = seen(1.0, now_s + 1).status
    checks.add(replace(seen(1.0, now_s + 1), status=replace(status, blocks=(many,))))
    assert len(told(checks, now_s + 1).checks) <= MAX_CHECKS


def test_what_turned_before_the_window_is_what_it_begins_with() -> None:
    checks = RobotChecks()
    for second in range(100):
        checks.add(seen(5.0 if second > 20 else 0.0, 1000.0 + second))
    assert told(checks, 1099.0, window_s=10).rules[0].turns == ((0.0, Truth.TRUE),)


@pytest.mark.parametrize("number", [-1, 1, 10**9])
def test_a_check_that_there_is_not_has_no_values(number: int) -> None:
    checks = RobotChecks()
    checks.add(seen(5.0, 1000.0))
    assert told(checks, 1000.0, check=number).values is None


def test_other_rules_begin_anew_and_are_numbered_until_their_words_are_read() -> None:
    checks = RobotChecks()
    checks.add(seen(5.0, 1000.0))
    checks.add(seen(5.0, 1001.0, words=RuleWords(), sha256="0f" * 32))
    answer = told(checks, 1001.0, window_s=10)
    assert answer.rules[0].rule == "line 3"
    assert answer.rules[0].turns == ((0.0, Truth.UNKNOWN), (10.0, Truth.TRUE))
    assert (answer.checks, answer.values) == ((), None)


def test_a_robot_that_never_spoke_has_nothing() -> None:
    answer = told(RobotChecks(), 5.0)
    assert (answer.rules, answer.checks, answer.values) == ((), (), None)


MODE = TEXT.replace("/odom pose_x > 3", '/mode data = "docking"')


def test_words_that_a_check_read_are_told_with_when_they_came() -> None:
    words = words_of(RuleTexts(files=(RuleText("far.adirf", MODE),), full_names={}))
    checks = RobotChecks()
    for second, mode in enumerate(["driving", "driving", "docking", None]):
        one = seen(None, float(second), words=words, sha256=words.sha256)
        (block,) = one.status.blocks
        (check,) = block.checks
        block = replace(block, checks=(replace(check, value=mode),))
        checks.add(replace(one, status=replace(one.status, blocks=(block,))))
    values = told(checks, 4.0, window_s=10).values
    assert values is not None
    assert values.words == ((6.0, "driving"), (8.0, "docking"), (9.0, None))
    later = told(checks, 12.5, window_s=10).values
    assert later is not None
    assert later.words == ((0.0, "docking"), (0.5, None))
    assert told(checks, 4.0).checks[0].limit == '"docking"'
