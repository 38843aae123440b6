# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A pile-up costs old messages of low priority first, says so, and never grows."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest

from smarttestudo.robot.ros.rcl.subscription import MAX_PUBLISHERS, MessageNumbers
from smarttestudo.robot.ros.rcl.wake_ups import MOST_AT_ONCE, RclWakeUps
from smarttestudo.robot.ros.real_timers import RealTimers


class Backlog:
    """A source with messages that wait."""

    def __init__(self, wake_ups: RclWakeUps, messages: int, priority: float = 1.0) -> None:
        self.priority = priority
        self.waiting = messages
        self.served = 0
        self.event_fd = os.eventfd(1, os.EFD_NONBLOCK)
        wake_ups.add(self.event_fd, self)

    def serve(self, most: int) -> bool:
        count = min(most, self.waiting)
        self.waiting -= count
        self.served += count
        return self.waiting > 0


@pytest.fixture
def wake_ups() -> Iterator[RclWakeUps]:
    opened = RclWakeUps()
    yield opened
    opened.close()


def test_everybody_has_a_turn_before_anybody_has_a_second(wake_ups: RclWakeUps) -> None:
    busy, quiet = Backlog(wake_ups, 1000), Backlog(wake_ups, 1)
    wake_ups.wait(0)
    assert (busy.served, quiet.served) == (MOST_AT_ONCE, 1)


def test_while_a_topic_of_high_priority_is_behind_others_get_one_message_a_turn(wake_ups: RclWakeUps) -> None:
    low, high = Backlog(wake_ups, 1000, 1.0), Backlog(wake_ups, 3 * MOST_AT_ONCE, 5.0)
    wake_ups.wait(0)
    wake_ups.wait(0)
    assert (high.served, low.served) == (2 * MOST_AT_ONCE, 2)
    wake_ups.wait(0)
    assert (high.served, low.served) == (3 * MOST_AT_ONCE, 2 + MOST_AT_ONCE)


def test_who_is_behind_is_served_again_without_being_announced_again(wake_ups: RclWakeUps) -> None:
    backlog = Backlog(wake_ups, 10 * MOST_AT_ONCE)
    for _ in range(10):
        wake_ups.wait(60)
    assert backlog.waiting == 0


def test_who_is_closed_by_another_is_not_served_any_more(wake_ups: RclWakeUps) -> None:
    victim = Backlog(wake_ups, 5, 1.0)
    closer = Backlog(wake_ups, 1, 2.0)
    serve = closer.serve

    def serve_and_close(most: int) -> bool:
        wake_ups.remove(victim.event_fd)
        wake_ups.forget(victim)
        return serve(most)

    closer.serve = serve_and_close  # type: ignore[method-assign]
    wake_ups.wait(0)
    assert victim.served == 0


def test_gaps_between_the_numbers_of_one_publisher_are_losses() -> None:
    numbers = MessageNumbers()
    new = [
        numbers.is_new(b"a", 7),
        numbers.is_new(b"b", 1),
        numbers.is_new(b"a", 10),
        numbers.is_new(b"b", 2),
    ]
    assert all(new)
    assert (numbers.sent, numbers.lost) == (6, 2)


def test_what_comes_twice_or_late_is_not_new() -> None:
    numbers = MessageNumbers()
    assert [numbers.is_new(b"a", number) for number in (3, 3, 2, 4)] == [True, False, False, True]
    assert (numbers.sent, numbers.lost) == (2, 0)


def test_what_is_skipped_while_resting_is_not_lost_until_the_first_message_after() -> None:
    numbers = MessageNumbers()
    numbers.is_new(b"a", 1)
    numbers.pause()
    numbers.is_new(b"a", 100)
    numbers.is_new(b"a", 200)
    numbers.resume()
    numbers.is_new(b"a", 250)
    assert (numbers.sent, numbers.lost) == (250, 0)
    numbers.is_new(b"a", 252)
    assert (numbers.sent, numbers.lost) == (252, 1)


def test_publishers_without_end_do_not_grow_the_memory() -> None:
    numbers = MessageNumbers()
    for publisher in range(3 * MAX_PUBLISHERS):
        assert numbers.is_new(publisher.to_bytes(16, "big"), 1)
    assert (numbers.sent, numbers.lost) == (3 * MAX_PUBLISHERS, 0)


def test_timers_do_not_catch_up_on_what_they_missed() -> None:
    timers, acted = RealTimers(), []
    timers.add(1.0, lambda: acted.append("a"), 0.0)
    timers.add(0.5, lambda: acted.append("b"), 0.0)
    timers.act(0.4)
    assert acted == []
    timers.act(0.5)
    assert acted == ["b"]
    timers.act(10.0)
    assert acted == ["b", "a", "b"]
    assert timers.due_s == 10.5
