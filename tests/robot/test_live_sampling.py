# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Resting saves wake-ups, and nobody can tell from what is relayed."""

from __future__ import annotations

import random
from collections.abc import Sequence

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from loop.loop_driver import SECOND, LoopDriver
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.robot import Payload, Receive
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.robot.sampling import LiveSampling, SampledTopic

POLL_NS = SECOND // 5


class PausedSubscription:
    """An subscription in virtual time, of a path that numbers messages; ``wake_ups`` are what it costs."""

    def __init__(self, receive: Receive) -> None:
        self.sent = 0
        self.dropped = 0
        self.wake_ups = 0
        self._receive = receive
        self._came = 0
        self._rests = self._is_armed = False
        self._newest: Payload | None = None
        self._kept: Payload | None = None

    def arrive(self, payload: bytes) -> None:
        self._came += 1
        if self._rests and not self._is_armed:
            self._newest = payload
            return
        self._is_armed = False
        self._kept = None
        self.wake_ups += 1
        self.sent = self._came
        self._receive(payload, None)

    def pause(self) -> None:
        self._rests = True

    def arm(self) -> None:
        self._kept, self._newest = self._newest or self._kept, None
        self._is_armed = True
        self.sent = self._came

    def take_pending(self) -> bool:
        kept, self._kept = self._kept, None
        if kept is not None:
            self._receive(kept, None)
        return kept is not None

    def resume(self) -> None:
        self.take_pending()
        self._rests = False

    def close(self) -> None:
        self.pause()


class Robot:
    """One source and the runtime beside it, in virtual time."""

    def __init__(self, rate: str, *, samples: bool = True, may_pause: bool = True) -> None:
        self.driver = LoopDriver(f"begin SetFrequency /imu {rate} end", types={"/imu": "sensor_msgs/msg/Imu"})
        self.loop = self.driver.loop
        self.sampling = LiveSampling(self.loop, may_pause=may_pause)
        self.subscription = PausedSubscription(self._receive)
        self._topic = SampledTopic("/imu", self.subscription, 0)
        self._samples = samples
        self._poll_ns = POLL_NS

    def run(self, arrivals_ns: Sequence[int], until_ns: int) -> None:
        for number, at_ns in enumerate(arrivals_ns):
            self.wait_until(at_ns)
            self.subscription.arrive(b"%d" % number)
        self.wait_until(until_ns)

    def look_without(self) -> None:
        """Something needs every message from now on."""
        self._samples = False
        self.sampling.end(self._topic, self.driver.now_ns)

    def wait_until(self, at_ns: int) -> None:
        driver = self.driver
        while (wake_ns := min(self._poll_ns, self.sampling.wake_ns or at_ns)) < at_ns:
            driver.wait_until(max(wake_ns, driver.now_ns))
            self.sampling.on_wake(driver.now_ns)
            if driver.now_ns >= self._poll_ns:
                self._poll_ns += POLL_NS
                if self._samples:
                    self.sampling.choose(self._topic, driver.now_ns)
        driver.wait_until(at_ns)

    def _receive(self, payload: Payload, _: object) -> None:
        self.sampling.received(self._topic, len(payload))
        self.driver.send("/imu", self.driver.now_ns, payload[:], len(payload))

    @property
    def relayed(self) -> list[Payload]:
        return [one.payload for one in self.driver.relayed]


def arrivals(source_hz: float, seconds: float, seed: int = 0) -> list[int]:
    """A source with some jitter, never twice at one time."""
    rng = random.Random(seed)
    period_ns = SECOND / source_hz
    return [round((number + rng.uniform(0.2, 0.8)) * period_ns) for number in range(int(source_hz * seconds))]


@settings(max_examples=25, deadline=None)
@given(st.sampled_from([200.0, 1000.0]), st.sampled_from([1, 7, 20]), st.integers(0, 99))
def test_the_same_messages_are_relayed_as_if_every_one_had_been_looked_at(
    source_hz: float, target_hz: int, seed: int
) -> None:
    times_ns = arrivals(source_hz, 5, seed)
    robots = [Robot(str(target_hz), samples=samples) for samples in (True, False)]
    for robot in robots:
        robot.run(times_ns, 5 * SECOND)
    assert robots[0].relayed == robots[1].relayed
    assert robots[0].subscription.wake_ups < len(times_ns) / 2


def test_the_last_word_before_a_silence_arrives() -> None:
    robot = Robot("10")
    times_ns = arrivals(1000, 5.03)
    robot.run(times_ns, 7 * SECOND)
    assert robot.relayed[-1] == b"%d" % (len(times_ns) - 1)


def test_what_was_skipped_counts_as_sent_by_the_source() -> None:
    robot = Robot("10")
    robot.run(arrivals(1000, 10), 10 * SECOND)
    assert robot.loop.relays.statistics["/imu"].arrived.mean_hz == pytest.approx(1000, rel=0.02)


@pytest.mark.parametrize("rate", ["1", "10", "Off"])
@pytest.mark.parametrize("rests_s", [3.91, 4.0, 5.55])
def test_what_was_skipped_right_before_every_message_is_looked_at_again_counts_too(
    rate: str, rests_s: float
) -> None:
    robot, times_ns, end_ns = Robot(rate), arrivals(1000, 10), round(rests_s * SECOND)
    robot.run([at_ns for at_ns in times_ns if at_ns < end_ns], end_ns)
    wake_ups = robot.subscription.wake_ups
    robot.look_without()
    robot.run([at_ns for at_ns in times_ns if at_ns >= end_ns], 10 * SECOND)
    assert robot.loop.relays.statistics["/imu"].arrived.messages == len(times_ns)
    assert robot.subscription.wake_ups - wake_ups > 4000


def test_a_topic_that_is_off_costs_next_to_nothing_and_its_source_is_still_known() -> None:
    robot = Robot("Off")
    robot.run(arrivals(1000, 10), 10 * SECOND)
    assert robot.relayed == []
    assert robot.subscription.wake_ups < 1500
    assert robot.loop.relays.statistics["/imu"].arrived.mean_hz == pytest.approx(1000, rel=0.02)


def test_while_all_that_comes_is_recorded_every_message_is_looked_at() -> None:
    robot = Robot("10", may_pause=False)
    robot.run(arrivals(1000, 5), 5 * SECOND)
    assert robot.subscription.wake_ups == 5000


@pytest.mark.parametrize(
    "rules",
    [
        "SetFrequency /imu 5 If (CheckValue /imu rate > 3) Then SetFrequency /odom 2",
        "SetFrequency /imu 5 If (CheckValue /imu yaw > 3) Then SetFrequency /odom 2",
        "SetFrequency /odom 5",
    ],
)
def test_a_topic_that_a_check_reads_or_that_is_not_relayed_may_not_skip(rules: str) -> None:
    assert not LoopDriver(f"begin {rules} end").loop.may_skip("/imu")


def test_whoever_else_needs_every_message_gets_it() -> None:
    rules = "begin SetFrequency /imu 5 SetFrequency /info 5 end"
    assert LoopDriver(rules).loop.may_skip("/imu")
    latched = LoopDriver(rules)
    latched.source("/imu", transient_local=True)
    assert not latched.loop.may_skip("/imu")
    transforms = LoopDriver(rules, types={"/imu": "tf2_msgs/msg/TFMessage"})
    assert not transforms.loop.may_skip("/imu")
    assert not LoopDriver(rules, when_slow=WhenSlow.REPEAT).loop.may_skip("/imu")
    assert not LoopDriver(rules, budget_kb_per_s=100).loop.may_skip("/imu")
    paced = LoopDriver(rules, Profile(topics={"/info": TopicProfile(paced_with="/imu")})).loop
    assert not paced.may_skip("/imu")
    assert not paced.may_skip("/info")
    budgeted = LoopDriver(rules)
    budgeted.budget(100)
    assert not budgeted.loop.may_skip("/imu")
