# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Many relays behind one queue of wakes behave as if each pacer were driven alone."""

from __future__ import annotations

import random
from dataclasses import dataclass, field

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores

from loop.loop_driver import MS, SECOND, LoopDriver
from pacing.test_stream_reader import Written
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.robot import Payload
from smarttestudo.pacing.sample import Pass, Sample, StreamKind, WhenSlow
from smarttestudo.pacing.topic_pacer import TopicPacer

RATES_HZ = {"/a": 3.0, "/b": 10.0, "/c": float("inf"), "/d": 0.4}
RULES = "begin SetFrequency /a 3 SetFrequency /b 10 SetFrequency /c Full SetFrequency /d 0.4 end"


@dataclass(kw_only=True)
class LonePacer:
    """One pacer, woken at exactly the times it asks for."""

    pacer: TopicPacer
    passed: list[tuple[int, Payload, bool]] = field(default_factory=list)

    def keep(self, now_ns: int, passes: list[Pass]) -> None:
        self.passed += [(now_ns, one.sample.payload, one.repeated) for one in passes]

    def wait_until(self, at_ns: int) -> None:
        while (wake_ns := self.pacer.wake_ns) is not None and wake_ns <= at_ns:
            self.keep(wake_ns, list(self.pacer.wake(wake_ns)))


events = st.lists(
    st.tuples(
        st.sampled_from([0, 1, 20 * MS, 90 * MS, 300 * MS, 2 * SECOND]),
        st.sampled_from(list(RATES_HZ)),
        st.sampled_from(["message", "message", "message", "latched", "volatile"]),
    ),
    max_size=40,
)


@settings(max_examples=150)
@pytest.mark.parametrize("when_slow", list(WhenSlow))
@given(events)
def test_what_is_relayed_is_what_each_pacer_passes_alone(
    when_slow: WhenSlow, scenario: list[tuple[int, str, str]]
) -> None:
    driver = LoopDriver(RULES, when_slow=when_slow)
    alone = {topic: LonePacer(pacer=TopicPacer(when_slow=when_slow)) for topic in RATES_HZ}
    for topic, rate_hz in RATES_HZ.items():
        alone[topic].pacer.set_rate(rate_hz, 0)
    now_ns = 0
    for number, (gap_ns, topic, event) in enumerate(scenario):
        now_ns += gap_ns
        driver.wait_until(now_ns)
        for one in alone.values():
            one.wait_until(now_ns)
        lone = alone[topic]
        if event == "message":
            payload = b"%d" % number
            driver.send(topic, now_ns, payload)
            lone.keep(now_ns, list(lone.pacer.offer(Sample(payload=payload, size_bytes=100), now_ns)))
        else:
            driver.source(topic, transient_local=event == "latched")
            kind = StreamKind.of(type_name="", transient_local=event == "latched")
            lone.keep(now_ns, list(lone.pacer.set_kind(kind, now_ns)))
    driver.keep(driver.loop.finish(now_ns))
    for topic, lone in alone.items():
        lone.pacer.finish()
        lone.wait_until(now_ns + 100 * SECOND)
        relayed = [(one.stamp_ns, one.payload, one.repeated) for one in driver.relayed if one.topic == topic]
        assert relayed == lone.passed


@pytest.mark.parametrize("when_slow", list(WhenSlow))
def test_what_was_held_of_another_type_never_goes_out(when_slow: WhenSlow) -> None:
    driver = LoopDriver("begin SetFrequency /a 1 end", when_slow=when_slow, types={"/a": "old_msgs/msg/Old"})
    for number in range(13):
        driver.send("/a", number * 200 * MS, b"old")
    driver.source("/a", type_name="new_msgs/msg/New")
    before = len(driver.relayed)
    driver.wait_until(10 * SECOND)
    driver.send("/a", 10 * SECOND, b"new")
    assert {one.payload for one in driver.relayed[before:]} == {b"new"}


def test_what_waited_for_its_leader_under_another_type_never_goes_out() -> None:
    profile = Profile(topics={"/info": TopicProfile(paced_with="/image")})
    stamped = b"\x00\x01\x00\x00" + b"\x01\x00\x00\x00\x02\x00\x00\x00"
    driver = LoopDriver(
        "begin SetFrequency /image 1 SetFrequency /info 1 end", profile, types={"/info": "old_msgs/msg/Old"}
    )
    driver.send("/info", 100 * MS, stamped)
    driver.source("/info", type_name="new_msgs/msg/New")
    driver.send("/image", 200 * MS, stamped)
    assert [one.topic for one in driver.relayed] == ["/image"]


@pytest.mark.parametrize("version", [Stores.ROS2_FOXY, Stores.ROS2_JAZZY])
@pytest.mark.parametrize("kind", ["marker", "markers"])
@pytest.mark.parametrize("transient_local", [False, True])
def test_each_deletion_passes(version: Stores, kind: str, transient_local: bool) -> None:
    driver, chance, deletions = LoopDriver("begin SetFrequency /m 0.2 end"), random.Random(1), []
    for number in range(300):
        written = Written(version, chance, ["a"], [2, 3] if number % 50 == 20 else [0, 1])
        type_name, payload, _ = written(kind)
        if not number:
            driver.source("/m", type_name=type_name, transient_local=transient_local)
        at_ns = SECOND + number * SECOND // 10
        driver.send("/m", at_ns, payload)
        deletions += [at_ns] * (written.deletion > 0)
    relayed = driver.stamps_of("/m")
    assert len(deletions) == 6
    assert set(deletions) <= set(relayed)
