# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How often a status comes."""

from __future__ import annotations

import pytest

from robot.memory_link import MemoryLink
from robot.status.virtual_robot import SECOND, VirtualRobot
from smarttestudo.domain.errors import UsageError
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


@pytest.mark.parametrize("value", [1, 1.0, 5, 20.0])
def test_any_rate_up_to_twenty_can_be_asked_for(value: float) -> None:
    assert STATUS_RATE.value(value) == value


@pytest.mark.parametrize("value", [0, 0.5, 20.1, -1, float("nan"), float("inf"), True, None, "5", ("5",)])
def test_nothing_else_can(value: object) -> None:
    with pytest.raises(UsageError, match="from 1 to 20"):
        STATUS_RATE.value(value)  # type: ignore[arg-type]
