# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How often a status comes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import pytest

from robot.memory_link import MemoryLink
from robot.status.virtual_robot import SECOND, VirtualRobot
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.status import RulesInForce, RulesOrigin
from smarttestudo.robot.run_options import STATUS_RATE
from smarttestudo.robot.status_topics import StatusTimer


def pulse_heard_by(listeners: int) -> tuple[StatusTimer, VirtualRobot]:
    robot = VirtualRobot(listeners=listeners)
    return StatusTimer(robot), robot


def test_it_comes_once_a_second_and_as_often_as_asked_while_somebody_listens() -> None:
    pulse, robot = pulse_heard_by(1)
    assert pulse.next_s(0) == 1
    pulse.asked_hz = 20
    assert pulse.next_s(0) == 1 / 20
    robot.listeners = 0
    assert (pulse.status_hz, pulse.next_s(0)) == (1, 1)
    robot.listeners = 1
    assert pulse.status_hz == 20


def test_it_comes_as_often_as_asked_while_somebody_watches_over_a_link() -> None:
    link = MemoryLink()
    pulse = StatusTimer(VirtualRobot(listeners=0), link)
    pulse.asked_hz = 20
    for link.is_watched, status_hz in ((False, 1), (True, 20), (False, 1)):
        assert pulse.status_hz == status_hz


def test_telling_takes_a_fifth_of_a_core_at_most_but_comes_once_a_second() -> None:
    pulse, _ = pulse_heard_by(1)
    pulse.asked_hz = 20
    assert pulse.next_s(SECOND // 100) == 1 / 20
    assert pulse.next_s(SECOND // 50) == pytest.approx(0.1)
    assert pulse.next_s(SECOND) == 1


def test_diagnostics_come_once_a_second_however_often_a_status_does() -> None:
    pulse, _ = pulse_heard_by(1)
    due = [tick for tick in range(61) if pulse.is_diagnosis_due(tick * SECOND // 20)]
    assert due == [0, 18, 36, 54]
    slow, _ = pulse_heard_by(0)
    assert all(slow.is_diagnosis_due(round(tick * 0.99 * SECOND)) for tick in range(5))


RULES = RulesInForce(paths=("a.adirf",), sha256="0" * 64)


def told_at(pulse: StatusTimer, seconds: Iterable[float], rules: RulesInForce = RULES) -> list[float]:
    return [second for second in seconds if pulse.is_due(round(second * SECOND), rules)]


def test_while_nobody_needs_one_a_status_comes_every_ten_seconds() -> None:
    robot = VirtualRobot(listeners=0)
    pulse = StatusTimer(robot, MemoryLink())
    assert told_at(pulse, range(100, 131)) == [100, 110, 120, 130]
    slightly_early = StatusTimer(robot)
    assert told_at(slightly_early, [tick * 0.999 for tick in range(21)]) == [0, 10 * 0.999, 20 * 0.999]


def test_whoever_comes_has_the_next_one_at_once() -> None:
    link, robot = MemoryLink(), VirtualRobot(listeners=0)
    pulse = StatusTimer(robot, link)
    assert told_at(pulse, range(3)) == [0]
    robot.listeners = 1
    assert told_at(pulse, range(3, 6)) == [3, 4, 5]
    robot.listeners = 0
    assert told_at(pulse, range(6, 16)) == [15]
    link.is_watched = True
    assert told_at(pulse, range(16, 19)) == [16, 17, 18]


def test_other_rules_in_force_are_told_at_once() -> None:
    pulse = StatusTimer(VirtualRobot(listeners=0))
    assert told_at(pulse, range(3)) == [0]
    pushed = replace(RULES, origin=RulesOrigin.PUSHED)
    assert told_at(pulse, range(3, 14), pushed) == [3, 13]


def test_a_part_that_needs_all_has_one_each_second() -> None:
    pulse = StatusTimer(VirtualRobot(listeners=0), needs_all=True)
    assert told_at(pulse, range(4)) == [0, 1, 2, 3]


@pytest.mark.parametrize("value", [1, 1.0, 5, 20.0])
def test_any_rate_up_to_twenty_can_be_asked_for(value: float) -> None:
    assert STATUS_RATE.value(value) == value


@pytest.mark.parametrize("value", [0, 0.5, 20.1, -1, float("nan"), float("inf"), True, None, "5", ("5",)])
def test_nothing_else_can(value: object) -> None:
    with pytest.raises(UsageError, match="from 1 to 20"):
        STATUS_RATE.value(value)  # type: ignore[arg-type]
