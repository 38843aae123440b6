# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Pages of several Rulers ask one robot for more statuses, and leave it as it was."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.ruler.robots.watch import StatusRateRequest


class Robot:
    """A robot whose ``status_hz`` several Rulers set, each after hearing it."""

    def __init__(self, rulers: int) -> None:
        self.status_hz = 1.0
        self.now_s = 0.0
        self.demands = [StatusRateRequest() for _ in range(rulers)]

    def want(self, ruler: int, wanted_hz: float | None) -> None:
        self.demands[ruler].wanted_hz = wanted_hz
        self.hear(ruler)

    def hear(self, ruler: int) -> None:
        self.now_s += 0.1
        change_hz = self.demands[ruler].change_hz(self.status_hz, self.now_s)
        if change_hz is not None:
            self.status_hz = change_hz


def test_a_watched_robot_speaks_more_often_and_then_as_before() -> None:
    robot = Robot(1)
    for wanted_hz in (5.0, 20.0, 5.0):
        robot.want(0, wanted_hz)
        assert robot.status_hz == wanted_hz
    robot.want(0, None)
    assert robot.status_hz == 1.0
    assert robot.demands[0].is_settled


def test_a_robot_that_speaks_often_enough_already_is_left_alone() -> None:
    robot = Robot(1)
    robot.status_hz = 10.0
    robot.want(0, 5.0)
    assert robot.status_hz == 10.0
    robot.want(0, None)
    assert robot.status_hz == 10.0


def test_it_is_left_as_it_was_even_before_it_says_that_it_changed() -> None:
    demand = StatusRateRequest()
    demand.wanted_hz = 5.0
    assert demand.change_hz(1.0, 0.0) == 5.0
    demand.wanted_hz = None
    assert demand.change_hz(1.0, 0.5) == 1.0


def test_what_somebody_else_set_meanwhile_is_not_put_back() -> None:
    robot = Robot(1)
    robot.want(0, 5.0)
    robot.now_s = 10.0
    robot.status_hz = 15.0
    robot.hear(0)
    robot.want(0, None)
    assert robot.status_hz == 15.0


def test_a_robot_that_began_anew_is_asked_again_but_not_with_every_status() -> None:
    robot = Robot(1)
    robot.want(0, 5.0)
    asked = 0
    for _ in range(100):
        robot.status_hz = 1.0
        robot.hear(0)
        asked += robot.status_hz == 5.0
    assert asked == 3


acts = st.lists(st.tuples(st.integers(0, 1), st.sampled_from([None, 2.0, 5.0, 20.0])), max_size=12)


@given(acts)
def test_while_anybody_watches_they_get_what_they_want_soon(acts: list[tuple[int, float | None]]) -> None:
    robot = Robot(2)
    for ruler, wanted_hz in acts:
        robot.want(ruler, wanted_hz)
        for _ in range(100):
            for demand in range(2):
                robot.hear(demand)
        wanted = [one.wanted_hz for one in robot.demands if one.wanted_hz is not None]
        assert robot.status_hz >= max(wanted, default=1.0)


@given(st.lists(st.sampled_from([None, 2.0, 5.0, 20.0]), max_size=12), st.sampled_from([1.0, 3.0, 20.0]))
def test_one_ruler_alone_leaves_the_robot_as_it_was(acts: list[float | None], before_hz: float) -> None:
    robot = Robot(1)
    robot.status_hz = before_hz
    for wanted_hz in [*acts, None]:
        robot.want(0, wanted_hz)
        robot.hear(0)
    assert robot.status_hz == before_hz
