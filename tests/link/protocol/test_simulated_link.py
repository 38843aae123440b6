# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator gets over links of all kinds, in virtual time."""

from __future__ import annotations

from itertools import pairwise

import pytest

from link.protocol.simulated_link import Ends, Link, S, Source, quantile
from smarttestudo.domain.link import LinkNeeds, StreamCounts, StreamInfo
from smarttestudo.domain.profile import UNLIMITED_KB_PER_S
from smarttestudo.domain.robot import Qos
from smarttestudo.link.protocol.chunks import NOTHING_RECEIVED
from smarttestudo.link.protocol.messages import Report
from smarttestudo.link.protocol.outbox import MAX_QUEUED_BYTES
from smarttestudo.link.protocol.sender import LinkSender
from smarttestudo.robot.vitals import LinkVitals

# 5 Mbit/s are offered.
SOURCES = (
    Source(topic="/odom", size_bytes=720, rate_hz=25),
    Source(topic="/imu", size_bytes=320, rate_hz=50),
    Source(topic="/scan", size_bytes=3_000, rate_hz=5),
    Source(topic="/image", size_bytes=60_000, rate_hz=10),
)
SMALL = ("/odom", "/imu", "/scan")
NEEDS = {
    "/odom": LinkNeeds(priority=5),
    "/imu": LinkNeeds(priority=4),
    "/scan": LinkNeeds(priority=4),
    "/image": LinkNeeds(priority=1),
}


def ends(*steps: tuple[float, float], sources: tuple[Source, ...] = SOURCES, delay_s: float = 0.01) -> Ends:
    both = Ends(Link(steps, delay_s), sources)
    both.sender.follow(NEEDS)
    return both


@pytest.mark.parametrize("delay_s", [0.0005, 0.002, 0.01, 0.03])
def test_small_topics_stay_fresh_and_the_link_is_used_where_twice_too_much_is_offered(delay_s: float) -> None:
    both = ends((0, 250_000), delay_s=delay_s)
    both.run(60)
    for topic in SMALL:
        assert quantile(both.ages_s(topic, 2), 0.95) <= 0.15, topic
    assert quantile(both.ages_s("/image", 2), 0.95) <= 0.6
    assert both.link.carried_bytes >= 0.9 * 250_000 * 60


def test_a_link_that_falls_to_a_tenth_keeps_what_matters_fresh_and_comes_back() -> None:
    both = ends((0, 1_000_000), (10, 100_000), (30, 1_000_000))
    both.run(45)
    for topic in SMALL:
        assert max(both.ages_s(topic, 10, 12)) <= 0.6, topic
        assert quantile(both.ages_s(topic, 10, 30), 0.95) <= 0.25, topic
    images = len(both.ages_s("/image", 31, 34))
    assert images >= 0.9 * 3 * 10
    fits_by = [
        at_ns for at_ns, budget in both.budgets if at_ns > 10 * S and budget is not None and budget <= 100
    ]
    assert fits_by[0] <= 11 * S
    back_by = [
        at_ns for at_ns, budget in both.budgets if at_ns > 30 * S and budget is not None and budget >= 900
    ]
    assert back_by[0] <= 33 * S


def test_after_ten_seconds_without_a_link_the_newest_comes_first_and_what_is_latched_is_there() -> None:
    latched = Source(topic="/map", size_bytes=20_000, rate_hz=0.01, transient_local=True)
    both = ends((0, 250_000), (10, 0), (20, 250_000), sources=(*SOURCES, latched))
    both.run(30)
    for topic, period_s in (("/odom", 0.04), ("/imu", 0.02), ("/scan", 0.2)):
        first = both.ages_s(topic, 20)[0]
        assert first <= period_s + 0.15, topic
        assert max(both.ages_s(topic, 20)) <= 0.3, topic
    assert len(both.arrived["/map"]) == 1
    assert both.sender.state(30 * S).outages == 1


@pytest.mark.parametrize("delay_s", [0.0005, 0.01])
def test_an_idle_link_is_not_taken_for_a_thin_one(delay_s: float) -> None:
    heartbeat = Source(topic="/heartbeat", size_bytes=100, rate_hz=1)
    burst = Source(topic="/burst", size_bytes=40_000, rate_hz=5, from_s=35)
    both = ends((0, 250_000), sources=(heartbeat, burst), delay_s=delay_s)
    both.run(40)
    assert [message.payload for _, message in both.arrived["/heartbeat"]] == both.payloads["/heartbeat"][:40]
    assert len(both.ages_s("/burst", 35, 37.001)) >= 9


LOOPBACK = 1e9
"""Bytes/s."""


@pytest.mark.parametrize(
    "sources",
    [
        (Source(topic="/image", size_bytes=20_000, rate_hz=500, to_s=3.5),),
        (Source(topic="/image", size_bytes=100_000, rate_hz=100, to_s=3.5),),
        (Source(topic="/imu", size_bytes=300, rate_hz=2_000, to_s=3.5),),
        tuple(Source(topic=f"/image_{n}", size_bytes=20_000, rate_hz=30, to_s=3.5) for n in range(8)),
    ],
    ids=lambda sources: f"{len(sources)} of {sources[0].size_bytes} bytes at {sources[0].rate_hz:g} Hz",
)
def test_where_the_link_carries_far_more_no_message_is_replaced_once_that_is_known(
    sources: tuple[Source, ...],
) -> None:
    both = ends((0, LOOPBACK), sources=sources, delay_s=0.0002)
    both.run(4)
    for source in sources:
        payloads = both.payloads[source.topic]
        late = payloads[int(1.5 * source.rate_hz) :]
        assert [message.payload for _, message in both.arrived[source.topic]][-len(late) :] == late
        # Reports are said 50 ms apart there, and are not waited for.
        assert max(both.ages_s(source.topic, 1.5)) <= 0.01


def test_a_fast_link_that_stands_still_for_a_moment_costs_no_message_and_for_longer_only_old_ones() -> None:
    source = Source(topic="/image", size_bytes=20_000, rate_hz=500, to_s=5.0)
    both = ends((0, LOOPBACK), (3, 0), (3.08, LOOPBACK), (4, 0), (4.5, LOOPBACK), sources=(source,))
    both.run(5.5)
    counts = both.sender.counts(5 * S)["/image"]
    offered = [message.offered_ns for _, message in both.arrived["/image"] if message.offered_ns > 2 * S]
    gaps_s = [
        ((before + S // 500) / S, after / S)
        for before, after in pairwise(offered)
        if after - before > 0.003 * S
    ]
    # What waited until the link went on is the newest, after what was under way.
    assert min(begin_s for begin_s, _ in gaps_s) > 4.0
    assert max(end_s for _, end_s in gaps_s) < 4.8
    assert max(both.ages_s("/image", 4.6)) <= 0.15
    assert counts.sent + counts.replaced == len(both.payloads["/image"])


def test_a_burst_after_a_pause_is_sent_at_what_the_link_showed_it_carries() -> None:
    source = Source(topic="/image", size_bytes=200_000, rate_hz=5)
    both = ends((0, 5_000_000), sources=(source,), delay_s=0.001)
    both.run(10)
    # The link takes 40 ms for each.
    assert max(both.ages_s("/image", 5)) <= 0.08


@pytest.mark.full
def test_topics_with_floors_keep_them_under_tenfold_overload() -> None:
    sources = (
        Source(topic="/battery", size_bytes=200, rate_hz=1),
        Source(topic="/camera", size_bytes=100_000, rate_hz=25),
    )
    both = Ends(Link(((0, 250_000),)), sources)
    both.sender.follow({"/battery": LinkNeeds(priority=1, floor_hz=1.0), "/camera": LinkNeeds(priority=9)})
    both.run(600)
    got = both.arrived["/battery"]
    assert [message.payload for _, message in got] == both.payloads["/battery"][: len(got)]
    assert len(got) >= 599
    gaps_s = [(after[0] - before[0]) / S for before, after in pairwise(got)]
    assert max(gaps_s) <= 2.0


def test_a_full_topic_is_never_thinned_while_its_queue_holds() -> None:
    both = ends(
        (0, 250_000),
        (5, 0),
        (8, 250_000),
        sources=(Source(topic="/joint_states", size_bytes=400, rate_hz=50),),
    )
    both.sender.follow({"/joint_states": LinkNeeds(is_full=True)})
    both.run(20)
    got = [message.payload for _, message in both.arrived["/joint_states"]]
    assert got == both.payloads["/joint_states"][: len(got)]
    assert len(got) >= 990


def test_what_overflows_a_queue_is_counted() -> None:
    both = ends((0, 10_000), sources=(Source(topic="/camera", size_bytes=60_000, rate_hz=10),))
    both.sender.follow({"/camera": LinkNeeds(is_full=True)})
    both.run(20)
    counts = both.sender.counts(20 * S)["/camera"]
    assert counts.overflowed > 0
    assert counts.queued_bytes <= 1_000_000
    # One may be on its way.
    assert counts.sent + counts.overflowed + counts.queued_bytes // 60_000 + 1 >= len(
        both.payloads["/camera"]
    )


def filled_queue(sender: LinkSender[None]) -> int:
    """The stream of a topic that is sent whole, with three messages more than its queue takes, at 0."""
    sender.follow({"/camera": LinkNeeds(is_full=True)})
    info = StreamInfo(
        topic="/camera", type_name="a/msg/A", qos=Qos(reliable=True, transient_local=False, depth=1)
    )
    stream = sender.open(info, 0)
    assert stream is not None
    for _ in range(MAX_QUEUED_BYTES // 100_000 + 3):
        sender.put(stream, bytes(100_000), 0)
    return stream


def test_what_overflows_while_nobody_was_ever_there_is_not_lost_on_the_link() -> None:
    sender = LinkSender[None]()
    stream = filled_queue(sender)
    assert sender.counts(0)["/camera"] == StreamCounts(queued_bytes=MAX_QUEUED_BYTES)
    sender.handle_report(Report(receiver=1, received=NOTHING_RECEIVED), 0)
    assert sender.counts(0)["/camera"] == StreamCounts(queued_bytes=MAX_QUEUED_BYTES)
    sender.disconnect()
    sender.put(stream, bytes(100_000), 5 * S)
    assert sender.counts(5 * S)["/camera"] == StreamCounts(
        overflowed=1, queued_bytes=MAX_QUEUED_BYTES, is_losing=True
    )


def test_a_topic_that_has_lost_nothing_for_a_minute_is_not_losing_any_more() -> None:
    sender = LinkSender[None]()
    sender.handle_report(Report(receiver=1, received=NOTHING_RECEIVED), 0)
    stream = filled_queue(sender)
    sender.put(stream, bytes(100_000), 7 * S)
    told = [sender.counts(now_ns)["/camera"] for now_ns in (7 * S, 67 * S - 1, 67 * S)]
    assert [(counts.overflowed, counts.is_losing) for counts in told] == [(4, True), (4, True), (4, False)]


def test_a_link_that_topics_do_not_fill_is_in_the_end_no_limit() -> None:
    # It was measured in its first second.
    both = ends((0, 50_000), (1, 1_000_000), sources=(Source(topic="/image", size_bytes=20_000, rate_hz=5),))
    both.run(60)
    assert UNLIMITED_KB_PER_S in {budget for _, budget in both.budgets}
    assert max(budget for _, budget in both.budgets if budget is not None) == UNLIMITED_KB_PER_S
    assert both.sender.state(60 * S).capacity_kb_per_s is None


def test_what_a_link_carries_is_told_while_topics_fill_it() -> None:
    both = ends((0, 50_000), sources=(Source(topic="/image", size_bytes=20_000, rate_hz=5),))
    both.run(30)
    assert both.sender.state(30 * S).capacity_kb_per_s == pytest.approx(50, rel=0.1)


def test_ages_are_told_right_whatever_the_clocks_say() -> None:
    both = ends((0, 250_000))
    hour_ns = 3_600 * S
    take = both.receiver.receive
    both.receiver.receive = lambda data, now_ns: take(data, now_ns + hour_ns)  # type: ignore[method-assign]
    both.run(20)
    for at_ns, message in both.arrived["/odom"][50:]:
        assert message.age_ns is not None
        assert abs(message.age_ns - (at_ns - message.offered_ns)) <= 0.03 * S


@pytest.mark.parametrize("bytes_per_s", [1_000, 2_000, 5_000])
def test_a_link_of_some_kilobits_is_slow_and_not_taken_for_an_outage(bytes_per_s: int) -> None:
    both = ends((0, bytes_per_s), sources=(Source(topic="/odom", size_bytes=720, rate_hz=25),))
    both.run(120)
    # Half of what the link could carry, headers included.
    assert len(both.ages_s("/odom", 30)) >= 0.5 * 90 * bytes_per_s / 760


def test_what_rules_read_of_a_link_is_true_of_it_through_an_outage() -> None:
    """Of 250 KB/s, 500 are asked for; from 10 to 20 s nothing passes."""
    both = ends((0, 250_000), (10, 0), (20, 250_000), sources=SOURCES)
    vitals = LinkVitals()
    course: list[dict[str, float | None]] = []

    def read(now_ns: int) -> None:
        course.append(
            vitals.read(both.sender.state(now_ns), now_ns, ("capacity", "used", "connected", "age"))
        )
        both.at(now_ns + S, read)

    both.at(0, read)
    both.run(26)
    before, out, after = course[3:10], course[15:20], course[23:26]
    for one in (*before, *after):
        assert one["connected"] == 1
        assert (one["age"] or 0) < 0.2
        assert 200 < (one["capacity"] or 0) < 300
        assert 75 < (one["used"] or 0) <= 100
    for second, one in enumerate(out, start=15):
        assert (one["connected"], one["capacity"], one["used"]) == (0, None, None)
        assert one["age"] == pytest.approx(second - 10, abs=0.2)
