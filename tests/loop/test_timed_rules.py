# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules with time in the loop: decisions at the exact time, also through a reload."""

from __future__ import annotations

from loop.loop_driver import MS, SECOND, LoopDriver
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.signal import Truth

STAYS = """
begin
SetFrequency /scan 2
Rule "stays" If CheckValue /odom pose_x > 5 For 1500 ms Then SetFrequency /scan 8 EndIf
end
"""
AT_ONCE = Profile(settle_s=0.0)


def walked_in() -> LoopDriver:
    """Outside for four seconds, inside from then on."""
    driver = LoopDriver(STAYS, AT_ONCE)
    for second in range(4):
        driver.drive(second * SECOND, 0.0, 0.0)
    driver.drive(4 * SECOND, 6.0, 0.0)
    driver.decisions.clear()
    return driver


def test_for_decides_at_its_nanosecond_between_two_messages() -> None:
    driver = walked_in()
    driver.drive(5 * SECOND, 7.0, 0.0)
    driver.wait_until(5500 * MS - 1)
    assert driver.log() == []
    driver.wait_until(5500 * MS)
    assert driver.log() == [(5.5, "/scan", 8, "block", "stays")]


def test_a_condition_that_is_written_the_same_keeps_its_history_through_a_reload() -> None:
    driver = walked_in()
    driver.wait_until(5 * SECOND)
    driver.reload(STAYS.replace("/scan 8", "/scan 9").replace("5 For", "5.0  For"), AT_ONCE)
    driver.wait_until(6 * SECOND)
    assert [(decision.t_s, decision.planned.rate.hz) for decision in driver.decisions] == [(5.5, 9.0)]


def test_another_duration_counts_from_when_the_condition_began_to_hold() -> None:
    driver = walked_in()
    driver.wait_until(5 * SECOND)
    driver.reload(STAYS.replace("1500 ms", "1400 ms"), AT_ONCE)
    assert driver.rates() == {"/scan": 2}
    driver.wait_until(6 * SECOND)
    assert driver.log() == [(5.4, "/scan", 8, "block", "stays")]


def test_another_condition_is_unknown_until_it_was_watched_for_so_long() -> None:
    driver = walked_in()
    driver.wait_until(5 * SECOND)
    driver.reload(STAYS.replace("> 5", "> 4"), AT_ONCE)
    assert driver.rates() == {"/scan": 8}
    (block,) = driver.loop.block_states(5 * SECOND)
    assert block.state is Truth.UNKNOWN


TIMES = """
begin
SetFrequency /scan 2
If (CheckValue /odom pose_x > 5 For 3 s OR (Not CheckValue /odom pose_x > 5 Within 500 ms) For 1 s)
Then SetFrequency /scan 8
end
"""


def test_a_status_says_for_how_long_what_is_timed_has_held() -> None:
    driver = LoopDriver(TIMES, AT_ONCE)

    def times() -> list[tuple[Truth, float | None]]:
        (block,) = driver.loop.block_states(driver.now_ns)
        return [(time.state, time.held_s) for time in block.times]

    assert times() == [(Truth.UNKNOWN, None)] * 3
    driver.drive(0, 0.0, 0.0)
    assert times() == [(Truth.FALSE, 0.0), (Truth.UNKNOWN, 0.0), (Truth.UNKNOWN, None)]
    driver.drive(1 * SECOND, 6.0, 0.0)
    driver.drive(2 * SECOND, 6.0, 0.0)
    driver.wait_until(2500 * MS)
    assert times() == [(Truth.FALSE, 1.5), (Truth.TRUE, 0.0), (Truth.FALSE, 0.0)]
    driver.drive(3 * SECOND, 0.0, 0.0)
    driver.wait_until(3250 * MS)
    assert times() == [(Truth.FALSE, 0.0), (Truth.TRUE, 0.25), (Truth.FALSE, 0.0)]
    driver.drive(4 * SECOND, 0.0, 0.0)
    driver.wait_until(5 * SECOND)
    assert times() == [(Truth.FALSE, 0.0), (Truth.FALSE, 2.0), (Truth.TRUE, 1.5)]


def test_a_status_says_for_how_long_a_condition_has_been_as_it_is() -> None:
    driver = walked_in()
    driver.drive(5 * SECOND, 7.0, 0.0)
    driver.wait_until(6 * SECOND)
    (block,) = driver.loop.block_states(6 * SECOND)
    assert (block.state, block.held_s) == (Truth.TRUE, 0.5)
