# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Alarms ring when they were last set to, however often they were put off."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.timing import AlarmClock

settings_of_alarms = st.tuples(st.sampled_from("abc"), st.one_of(st.none(), st.integers(0, 30)))
turns = st.lists(st.tuples(st.lists(settings_of_alarms, max_size=4), st.integers(0, 6)), max_size=12)


@given(turns)
def test_each_alarm_rings_once_in_the_first_turn_at_or_after_its_time(
    scenario: list[tuple[list[tuple[str, int | None]], int]],
) -> None:
    clock = AlarmClock()
    wanted: dict[str, int] = {}
    now = 0
    for changes, gap in scenario:
        for topic, at in changes:
            clock.set(topic, at)
            wanted.pop(topic, None)
            if at is not None:
                wanted[topic] = at
        if wanted:
            assert clock.next_ns is not None
            assert clock.next_ns <= min(wanted.values())
        now += gap
        due = {topic for topic, at in wanted.items() if at <= now}
        assert sorted(clock.take_due(now)) == sorted(due)
        for topic in due:
            del wanted[topic]
    clock.take_due(100)
    assert clock.next_ns is None


def test_putting_an_alarm_off_again_and_again_keeps_one_entry() -> None:
    clock = AlarmClock()
    for at in range(10, 1000):
        clock.set("a", at)
    assert clock.take_due(998) == []
    assert clock.next_ns == 999
    assert clock.take_due(999) == ["a"]
    assert clock.next_ns is None
