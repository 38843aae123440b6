# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Datagrams over any radio: what must arrive does, once and in order; all else arrives or is counted."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from link.protocol.lossy_ends import PROFILES, LossyEnds, Profile, Radio, lossy_ends
from link.protocol.simulated_link import MS, S, Source, quantile
from smarttestudo.domain.link import LinkNeeds
from smarttestudo.link.protocol.chunks import Chunk, ReceivedSessions

END_S = 9.0
SENT_S = 3.0
SOURCES = (
    Source(topic="/odom", size_bytes=720, rate_hz=25, from_s=0.3, to_s=SENT_S),
    Source(topic="/slow", size_bytes=300, rate_hz=1.5, from_s=0.3, to_s=SENT_S),
    Source(topic="/image", size_bytes=9_000, rate_hz=6, from_s=0.3, to_s=SENT_S),
    Source(topic="/events", size_bytes=2_500, rate_hz=8, from_s=0.3, to_s=SENT_S),
    Source(topic="/map", size_bytes=5_000, rate_hz=1.0, from_s=0.3, to_s=SENT_S, transient_local=True),
)
NEEDS = {"/odom": LinkNeeds(priority=2), "/events": LinkNeeds(is_full=True)}
IN_ORDER = ("/events", "/map")

profiles = st.builds(
    Profile,
    delay_ms=st.integers(1, 150),
    jitter_ms=st.integers(0, 60),
    lost_percent=st.integers(0, 15),
    mbit_per_s=st.sampled_from((0.5, 2, 10)),
    queue_bytes=st.sampled_from((12_000, 64_000)),
    copied_percent=st.sampled_from((0, 5)),
    reorders=st.booleans(),
)
outages = st.lists(st.tuples(st.integers(0, 30), st.integers(1, 25)), max_size=2).map(
    lambda spans: [(at * 100 * MS, (at + length) * 100 * MS) for at, length in spans]
)


def numbers(ends: LossyEnds, topic: str) -> list[int]:
    return [int.from_bytes(message.payload[:8], "little") for _, message in ends.arrived[topic]]


def run(ends: LossyEnds, cuts: Sequence[tuple[int, int]] = ()) -> LossyEnds:
    ends.up.outages = ends.down.outages = cuts
    ends.sender.follow(NEEDS)
    ends.run(END_S)
    return ends


@settings(max_examples=25, deadline=None)
@given(profiles, st.integers(0, 10_000))
def test_each_message_arrives_or_is_counted(profile: Profile, seed: int) -> None:
    ends = run(lossy_ends(profile, SOURCES, seed))
    assert ends.sender.state(int(END_S) * S).by_datagrams
    for source in SOURCES:
        counts, arrived = ends.sender.counts(0)[source.topic], numbers(ends, source.topic)
        assert arrived == sorted(set(arrived))
        lost = counts.lost_replaced + counts.lost_late
        gone = lost + counts.replaced + counts.overflowed
        # What is under way as a session ends, after a long silence of the radio, is missed instead.
        if ends.sender.scheduler.session == 1:
            assert len(arrived) + gone == len(ends.payloads[source.topic])
        if source.topic in IN_ORDER:
            assert arrived == list(range(len(ends.payloads[source.topic])))
    assert ends.receiver.counts.malformed == 0


@settings(max_examples=25, deadline=None)
@given(profiles, st.integers(0, 10_000), outages)
def test_an_outage_loses_nothing_that_must_arrive(
    profile: Profile, seed: int, cuts: Sequence[tuple[int, int]]
) -> None:
    ends = run(lossy_ends(profile, SOURCES, seed), cuts)
    missed = ends.sender.take_missed(int(END_S) * S)
    for source in SOURCES:
        arrived = numbers(ends, source.topic)
        assert arrived == sorted(set(arrived))
        of_topic = [one.payload for one in missed if one.origin.topic == source.topic]
        gone = {int.from_bytes(payload[:8], "little") for payload in of_topic}
        assert len(gone) == len(of_topic)
        assert gone & {*arrived} == set()
        if source.topic in IN_ORDER:
            assert arrived == list(range(len(ends.payloads[source.topic])))


@settings(max_examples=15, deadline=None)
@given(profiles, st.integers(0, 10_000), st.lists(st.integers(5, 45), min_size=1, max_size=4))
def test_sessions_that_change_how_they_go_lose_nothing(
    profile: Profile, seed: int, switches: list[int]
) -> None:
    ends = lossy_ends(profile, SOURCES, seed)
    for place, tenth in enumerate(sorted(switches)):
        receiver = frozenset({7} if place % 2 else ())
        ends.at(tenth * 100 * MS, partial(_allow, ends, receiver))
    run(ends)
    for source in SOURCES:
        arrived = numbers(ends, source.topic)
        assert arrived == sorted(set(arrived))
        if source.topic in IN_ORDER:
            assert arrived == list(range(len(ends.payloads[source.topic])))


@pytest.mark.parametrize("name", PROFILES)
def test_small_topics_stay_fresh_beside_images_that_fill_the_radio(name: str) -> None:
    profile = PROFILES[name]
    image_bytes = int((1.2 * profile.mbit_per_s * 125_000 - 36_000) / 10)
    sources = (
        Source(topic="/odom", size_bytes=720, rate_hz=25, from_s=0.3),
        Source(topic="/imu", size_bytes=320, rate_hz=50, from_s=0.3),
        Source(topic="/image", size_bytes=image_bytes, rate_hz=10, from_s=0.3),
    )
    ends = lossy_ends(profile, sources)
    ends.sender.follow({"/odom": LinkNeeds(priority=2), "/imu": LinkNeeds(priority=2)})
    ends.run(16)
    most_s = (profile.delay_ms + profile.jitter_ms + 60) / 1_000
    for source in sources[:2]:
        ages_s = ends.ages_s(source.topic, 6, 16)
        assert quantile(ages_s, 0.95) <= most_s
        assert len(ages_s) >= 0.9 * (1 - profile.lost_percent / 100) * source.rate_hz * 10
    assert len(ends.ages_s("/image", 6, 16)) >= 40


def test_a_policer_that_drops_what_is_too_fast_is_given_less() -> None:
    # It has no queue that a round trip could show.
    profile = Profile(delay_ms=20, jitter_ms=0, lost_percent=0, mbit_per_s=2, queue_bytes=3_000)
    sources = (Source(topic="/image", size_bytes=30_000, rate_hz=20),)
    ends = lossy_ends(profile, sources)
    ends.run(10)
    dropped = ends.up.overflowed
    ends.run(20)
    assert ends.up.overflowed - dropped < 0.3 * (ends.up.sent / 2)


parts = st.lists(st.integers(0, 30), min_size=1, max_size=120)


@given(parts, st.integers(1, 1_168))
def test_what_is_acknowledged_has_arrived(order: list[int], size_bytes: int) -> None:
    sessions, seen = ReceivedSessions(), set[int]()
    for place in order:
        span = sessions.on_datagram(_chunk(place * size_bytes), size_bytes)
        assert (span is not None) == (place not in seen)
        seen.add(place)
        acknowledged = {one for one in range(31) if sessions.newest.has((one + 1) * size_bytes)}
        assert acknowledged == seen


def _allow(ends: LossyEnds, receivers: frozenset[int], _now_ns: int) -> None:
    ends.sender.allow_datagrams(receivers)


def _chunk(offset_bytes: int) -> Chunk:
    return Chunk(1, offset_bytes, 1, 0, 0, 1, 0, 0, False, False, b"x")


def test_radios_of_the_same_seed_are_alike() -> None:
    one, other = Radio(PROFILES["4g"], 3), Radio(PROFILES["4g"], 3)
    arrivals = [radio.arrivals_ns(500, number * MS) for radio in (one, other) for number in range(500)]
    assert arrivals[:500] == arrivals[500:]
