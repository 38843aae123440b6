# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the loop relays by its plan, and what it counts."""

from __future__ import annotations

import pytest

from loop.loop_driver import MS, SECOND, LoopDriver
from smarttestudo.domain.observation import ClockJumped
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.loop.inputs import ChangeInput, MessageInput
from smarttestudo.pacing.sample import WhenSlow

ONE_TOPIC = "begin SetFrequency /scan {} end"
ZONE = """
begin
SetFrequency /scan 2
Rule "zone" If CheckValue /odom pose_x > 5 Then SetFrequency /scan 8 EndIf
end
"""


def stamped(sec: int, nanosec: int) -> bytes:
    return b"\x00\x01\x00\x00" + sec.to_bytes(4, "little") + nanosec.to_bytes(4, "little") + bytes(8)


@pytest.mark.parametrize(("rate", "count"), [("5", 50), ("Full", 200), ("Off", 0), ("0", 0), ("100", 200)])
def test_a_topic_is_relayed_at_the_rate_of_its_plan(rate: str, count: int) -> None:
    driver = LoopDriver(ONE_TOPIC.format(rate))
    for step in range(200):
        driver.send("/scan", step * 50 * MS, payload=b"%d" % step, size_bytes=7)
    assert abs(len(driver.relayed) - count) <= (1 if 0 < count < 200 else 0)
    counted = driver.loop.relays.statistics["/scan"]
    assert (counted.arrived.messages, counted.arrived.size_bytes) == (200, 1400)
    assert (counted.relayed.messages, counted.relayed.size_bytes) == (
        len(driver.relayed),
        7 * len(driver.relayed),
    )
    assert counted.arrived.mean_hz == pytest.approx(20)


def test_a_topic_that_is_only_read_is_not_relayed() -> None:
    driver = LoopDriver(ZONE)
    driver.drive(SECOND, 1.0, 1.0)
    driver.send("/unheard_of", SECOND)
    assert driver.relayed == []
    assert list(driver.loop.relays.statistics) == ["/scan"]
    assert (driver.loop.knowledge.reads("/odom"), driver.loop.knowledge.reads("/scan")) == (True, False)


def test_the_message_that_raises_a_rate_and_those_after_it_are_paced_by_the_new_plan() -> None:
    driver = LoopDriver(
        "begin If CheckValue /odom pose_x > 5 Then SetFrequency /odom Full Else SetFrequency /odom Off end"
    )
    driver.drive(SECOND, 0.0, 0.0)
    driver.wait_until(2 * SECOND)
    driver.drive(3 * SECOND, 0.0, 0.0)
    driver.drive(4 * SECOND, 6.0, 0.0)
    driver.drive(5 * SECOND, 6.0, 0.0)
    assert driver.stamps_of("/odom") == [SECOND, 4 * SECOND, 5 * SECOND]


def test_the_last_word_is_relayed_by_a_wake() -> None:
    driver = LoopDriver(ONE_TOPIC.format("1"))
    for step in range(5):
        driver.send("/scan", step * 100 * MS, payload=b"%d" % step)
    driver.wait_until(10 * SECOND)
    assert [one.payload for one in driver.relayed] == [b"0", b"4"]


def test_a_wake_that_was_missed_is_made_up_for_by_the_next_message() -> None:
    driver = LoopDriver("begin SetFrequency /scan 1 SetFrequency /imu Full end")
    for step in range(5):
        driver.send("/scan", step * 100 * MS)
    driver.keep(driver.loop.handle(MessageInput(9 * SECOND, "/imu", b"", 1)))
    assert [(one.topic, one.stamp_ns) for one in driver.relayed[1:]] == [
        ("/scan", 9 * SECOND),
        ("/imu", 9 * SECOND),
    ]


def test_at_the_end_of_a_recording_what_is_held_follows_at_its_time_and_the_plan_stays() -> None:
    driver = LoopDriver(
        "begin SetFrequency /scan 1 If CheckValue /scan age > 0.1 Then SetFrequency /scan Full EndIf end"
    )
    for step in range(5):
        driver.send("/scan", step * 50 * MS, payload=b"%d" % step)
    late = list(driver.loop.finish(200 * MS))
    assert [(one.payload, one.stamp_ns >= SECOND) for one in late] == [(b"4", True)]
    assert driver.loop.take_decisions() == []
    assert driver.loop.next_wake_ns is None or driver.loop.next_wake_ns > 200 * MS


def test_the_target_is_weighted_by_time_and_full_counts_as_the_source() -> None:
    driver = LoopDriver(ZONE.replace("/scan 8", "/scan Full"), Profile(settle_s=0.0))
    driver.drive(3 * SECOND, 0.0, 0.0)
    driver.wait_until(4 * SECOND)
    assert list(driver.loop.finish(4 * SECOND)) == []
    assert driver.loop.relays.statistics["/scan"].target.mean_hz(20.0) == (3 * 20 + 1 * 2) / 4


def test_repeats_are_sent_where_asked_for_and_counted() -> None:
    driver = LoopDriver(ONE_TOPIC.format("10"), when_slow=WhenSlow.REPEAT)
    for step in range(10):
        driver.send("/scan", step * 200 * MS)
    counted = driver.loop.relays.statistics["/scan"]
    assert counted.repeated == sum(one.repeated for one in driver.relayed) >= 8
    assert counted.relayed.messages == len(driver.relayed) == 19


def test_a_latched_topic_passes_whole_once_it_is_known_to_be_latched() -> None:
    driver = LoopDriver(ONE_TOPIC.format("0.01"))
    driver.source("/scan", transient_local=True)
    for step in range(5):
        driver.send("/scan", step * 2 * SECOND)
    assert len(driver.relayed) == 5


def test_partners_pass_the_stamps_that_their_leader_passes_and_aim_at_its_rate() -> None:
    profile = Profile(topics={"/info": TopicProfile(paced_with="/image")})
    driver = LoopDriver("begin SetFrequency /info 1 SetFrequency /image 5 end", profile)
    for step in range(100):
        payload = stamped(step, 0)
        driver.send("/info", step * 50 * MS, payload)
        driver.send("/image", step * 50 * MS + MS, payload)
    images = [one.payload for one in driver.relayed if one.topic == "/image"]
    assert [one.payload for one in driver.relayed if one.topic == "/info"] == images
    assert 24 <= len(images) <= 26
    list(driver.loop.finish(5 * SECOND))
    assert driver.loop.relays.statistics["/info"].target.mean_hz(20.0) == 5
    assert driver.loop.relays.discarded["/info"] <= 1


def test_a_clock_that_jumps_back_leaves_no_relay_waiting_for_the_old_time() -> None:
    driver = LoopDriver(ONE_TOPIC.format("1"))
    for step in range(5):
        driver.send("/scan", 100 * SECOND + step * 100 * MS, payload=b"old")
    driver.relayed.clear()
    driver.now_ns = SECOND
    driver.keep(driver.loop.handle(MessageInput(SECOND, "/scan", b"new", 1)))
    driver.wait_until(4 * SECOND)
    assert [(one.payload, one.stamp_ns) for one in driver.relayed] == [(b"new", SECOND)]
    assert driver.loop.relays.statistics["/scan"].arrived.mean_hz == pytest.approx(12.5)


def test_a_jump_ahead_that_is_left_out_is_not_in_the_means() -> None:
    driver = LoopDriver(ONE_TOPIC.format("1"))
    for step in range(5):
        driver.send("/scan", step * 100 * MS)
    driver.now_ns = 3600 * SECOND + 400 * MS
    jumped = ClockJumped(ahead_ns=3600 * SECOND)
    driver.keep(driver.loop.handle(ChangeInput(stamp_ns=driver.now_ns, change=jumped)))
    for step in range(5, 31):
        driver.send("/scan", 3600 * SECOND + step * 100 * MS)
    list(driver.loop.finish(driver.now_ns))
    statistics = driver.loop.relays.statistics["/scan"]
    assert statistics.arrived.mean_hz == pytest.approx(10)
    assert statistics.target.mean_hz(10.0) == 1
