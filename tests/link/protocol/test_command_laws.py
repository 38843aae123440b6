# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What holds for all that an operator sends, on every link and by any two clocks."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from functools import cache, partial

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.protocol.simulated_commands import JOY, TYPE, Clock, Driving, Way
from link.protocol.simulated_link import MS, Link, S
from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.link import MAX_AGE_NS, MAX_COMMAND_BYTES, CommandTopic
from smarttestudo.link.protocol.commands import MAX_BURST, MAX_HZ, ClockBound, CommandReceiver, CommandSender
from smarttestudo.link.protocol.messages import (
    COMMAND_REPORTS,
    COMMANDS,
    AcceptedStream,
    CommandMessage,
    CommandReport,
    SentNames,
)
from smarttestudo.link.protocol.wire import Kind, frame

MAX_AGE_S = MAX_AGE_NS / S
HOUR_NS = 3_600 * S
clocks = st.builds(Clock, from_ns=st.integers(0, HOUR_NS), drift_ppm=st.integers(-200, 200))


@cache
@st.composite
def ways(draw: st.DrawFn) -> Way:
    """A direction with up to four changes of its rate, outages among them; at the end it is good."""
    rate = st.sampled_from([0.0, 600.0, 3_000.0, 50_000.0, 1e6])
    times = sorted(draw(st.lists(st.floats(0.5, 9.0), max_size=4)))
    steps = [(0.0, draw(rate)), *((at_s, draw(rate)) for at_s in times), (10.0, 1e6)]
    link = Link(steps, draw(st.floats(0.0001, 0.7)))
    return Way(link, draw(st.floats(0, 0.4)), random.Random(draw(st.integers(0, 9))))


@cache
@st.composite
def good_ways(draw: st.DrawFn) -> Way:
    """A direction over which nothing takes longer than 140 ms."""
    return Way(Link(((0.0, 250_000.0),), draw(st.floats(0.0001, 0.1))), draw(st.floats(0, 0.03)))


pauses = st.lists(st.tuples(st.floats(3, 9), st.floats(0.1, 3)), max_size=2).map(
    lambda all_: [(from_s, from_s + length_s) for from_s, length_s in all_]
)


@given(ways(), ways(), st.tuples(clocks, clocks), pauses, st.sampled_from([1.0, 7.0, 20.0, 45.0]))
def test_nothing_older_than_half_a_second_is_delivered_and_nothing_out_of_order(
    up: Way, down: Way, both: tuple[Clock, Clock], stands: list[tuple[float, float]], rate_hz: float
) -> None:
    driving = Driving(up=up, down=down, robot_clock=both[0], operator_clock=both[1], pauses=stands)
    driving.publish_at(rate_hz, 0.2, 12, publisher=0)
    driving.publish_at(3, 0.2, 12, publisher=1)
    driving.run(20)
    assert max(driving.ages_s(), default=0) <= MAX_AGE_S
    for publisher in (0, 1):
        numbers = driving.numbers(publisher)
        assert numbers == sorted(set(numbers))


@given(good_ways(), good_ways(), clocks, clocks, st.sampled_from([1.0, 10.0, 20.0, 45.0]))
def test_over_a_good_link_everything_is_delivered(
    up: Way, down: Way, robot: Clock, operator: Clock, rate_hz: float
) -> None:
    driving = Driving(up=up, down=down, robot_clock=robot, operator_clock=operator)
    driving.publish_at(rate_hz, 4, 10)
    driving.run(12)
    assert driving.numbers() == [number for _, _, number in driving.published]


@given(good_ways(), good_ways(), clocks, clocks)
def test_a_single_message_is_delivered_long_after_the_last(
    up: Way, down: Way, robot: Clock, operator: Clock
) -> None:
    driving = Driving(up=up, down=down, robot_clock=robot, operator_clock=operator)
    driving.publish(5)
    driving.publish(95)
    driving.run(100)
    assert driving.numbers() == [0, 1]


@given(st.integers(5, 24).map(lambda eighths: eighths / 8), clocks, clocks)
def test_after_an_outage_nothing_of_before_is_delivered_and_what_is_new_is(
    outage_s: float, robot: Clock, operator: Clock
) -> None:
    def way() -> Way:
        return Way(Link(((0.0, 250_000.0), (6.0, 0.0), (6 + outage_s, 250_000.0)), 0.02))

    driving = Driving(up=way(), down=way(), robot_clock=robot, operator_clock=operator)
    driving.publish_at(20, 3, 15)
    driving.run(16)
    after = [number for at_ns, _, number in driving.delivered if at_ns > 6.03 * S]
    at_s = {number: at_ns / S for at_ns, _, number in driving.published}
    assert at_s[after[0]] >= 6 + outage_s - MAX_AGE_S
    assert after[-1] == driving.published[-1][2]


@pytest.mark.parametrize("trip_s", [0.6, 1.2, 4.0])
def test_over_a_round_trip_of_more_than_half_a_second_nothing_passes_and_the_age_is_told(
    trip_s: float,
) -> None:
    def way() -> Way:
        return Way(Link(((0.0, 250_000.0),), trip_s / 2))

    driving = Driving(up=way(), down=way())
    driving.publish_at(20, 3, 20)
    driving.run(25)
    assert driving.numbers() == []
    told = driving.sender.topics[JOY]
    assert told.too_old > 0
    assert told.age_ms is not None
    assert told.age_ms == pytest.approx(trip_s * 1_000, rel=0.1, abs=30)
    assert driving.sender.round_trip_ms is not None
    assert driving.sender.round_trip_ms >= trip_s * 1_000


def test_a_slow_link_carries_the_newest_and_no_queue() -> None:
    driving = Driving(up=Way(Link(((0.0, 1_000.0),), 0.02)), down=Way(Link(((0.0, 5_000.0),), 0.02)))
    driving.publish_at(50, 3, 30)
    driving.run(32)
    # A message of 85 bytes takes 85 ms; without a window there would be a queue of a minute.
    assert len(driving.numbers()) >= 5 * 27
    assert driving.numbers()[-1] == driving.published[-1][2]
    assert driving.sender.counts[JOY].replaced > 0


@given(
    st.lists(st.tuples(st.integers(0, 100 * S), st.integers(0, 2 * S)), min_size=1),
    st.integers(-HOUR_NS, HOUR_NS),
    st.integers(-500, 500),
    st.integers(0, S),
    st.integers(0, 50 * S),
)
def test_a_stamp_is_never_later_than_what_it_stamps(
    ticks: list[tuple[int, int]], from_ns: int, drift_ppm: int, since_ns: int, later_ns: int
) -> None:
    robot = Clock(from_ns=from_ns, drift_ppm=drift_ppm)
    bound, arrivals = ClockBound(), sorted((at_ns + trip_ns, at_ns) for at_ns, trip_ns in ticks)
    for arrival_ns, at_ns in arrivals:
        bound.add(robot.at(at_ns), arrival_ns)
    now_ns = arrivals[-1][0] + later_ns
    stamp_ns = bound.stamp_ns(now_ns - since_ns, now_ns)
    assert stamp_ns is not None
    assert stamp_ns <= robot.at(now_ns - since_ns)


def command(
    number: int = 1, *, sender: int = 1, topic: int = 0, revision: int = 1, stamp_ns: int = 0
) -> bytes:
    message = CommandMessage(
        sender=sender, number=number, topic=topic, revision=revision, stamp_ns=stamp_ns, payload=b"go"
    )
    return COMMANDS.to_bytes(message)


def accepting() -> CommandReceiver:
    receiver = CommandReceiver((JOY,))
    receiver.follow(JOY, TYPE)
    return receiver


def test_what_is_of_another_type_of_the_future_repeated_or_unknown_is_refused_and_counted() -> None:
    receiver = accepting()
    assert receiver.receive(command(5, stamp_ns=S), S) == (JOY, b"go")
    refused = [
        command(5, stamp_ns=S),
        command(4, stamp_ns=S),
        command(6, stamp_ns=S, revision=0),
        command(7, stamp_ns=S + 1),
    ]
    assert [receiver.receive(data, S) for data in refused] == [None] * 4
    assert receiver.receive(command(8, stamp_ns=S - MAX_AGE_NS - 1), S) is None
    assert receiver.receive(command(9, stamp_ns=S, topic=1), S) is None
    [topic] = receiver.topics
    assert (topic.received, topic.delivered, topic.too_old, topic.refused) == (6, 1, 1, 4)
    assert receiver.malformed == 1
    receiver.follow(JOY, None, "two types")
    assert receiver.receive(command(10, stamp_ns=S, revision=2), S) is None


def test_a_flood_costs_what_is_allowed_in_a_second() -> None:
    receiver = accepting()
    taken = [
        receiver.receive(command(number, stamp_ns=number * MS // 10), number * MS // 10)
        for number in range(1, 20_000)
    ]
    assert MAX_HZ * 2 - 1 <= sum(one is not None for one in taken) <= MAX_HZ * 2 + MAX_BURST
    senders = [receiver.receive(command(sender=number, stamp_ns=9 * S), 9 * S) for number in range(1_000)]
    assert sum(one is not None for one in senders) <= MAX_BURST
    assert len(receiver.next_report(9 * S)) < 1_000


@given(st.binary(max_size=120) | st.binary(max_size=80).map(partial(frame, Kind.COMMAND)))
def test_random_bytes_are_refused_at_both_ends_or_cost_nothing(data: bytes) -> None:
    receiver, sender = accepting(), CommandSender((JOY,), lambda: 3)
    assert receiver.receive(data, 0) is None
    sender.handle_report(data, 0)
    assert receiver.topics[0].delivered == 0


@given(st.integers(0, 2**64 - 1), st.integers(0, 2**64 - 1))
def test_an_acknowledgement_of_what_was_never_sent_stops_nothing(sender_number: int, number: int) -> None:
    numbers = iter([sender_number, sender_number ^ 1])
    driving = Driving(up=Way(Link(((0.0, 1e6),), 0.01)), down=Way(Link(((0.0, 1e6),), 0.01)))
    driving.sender = CommandSender((JOY,), lambda: next(numbers))
    driving.publish_at(20, 3, 6)
    forged = COMMAND_REPORTS.to_bytes(CommandReport(sent_ns=0, acknowledged={sender_number: number}))
    driving.at(4 * S, lambda now_ns: driving.sender.handle_report(forged, now_ns))
    driving.run(8)
    assert len(driving.numbers()) >= len(driving.published) - 1


def test_a_message_that_is_too_large_is_refused_and_counted_and_the_largest_arrives() -> None:
    driving = Driving(up=Way(Link(((0.0, 1e6),), 0.01)), down=Way(Link(((0.0, 1e6),), 0.01)))
    driving.publish(4, size_bytes=MAX_COMMAND_BYTES)
    driving.publish(5, size_bytes=MAX_COMMAND_BYTES + 1)
    driving.run(7)
    assert driving.numbers() == [0]
    assert driving.sender.counts[JOY].too_large == 1


@given(st.lists(st.from_regex(r"/[a-z]{1,9}", fullmatch=True), max_size=16), st.integers(0, 2**64 - 1))
def test_names_are_what_travelled(topics: list[str], sender: int) -> None:
    names = SentNames(sender=sender, topics=tuple(topics))
    assert COMMANDS.from_bytes(COMMANDS.to_bytes(names)) == names


def test_what_tells_of_too_many_topics_or_of_none_is_refused() -> None:
    good = AcceptedStream(topic=CommandTopic(topic="/a", type_name="x/msg/Y", age_ms=2.5), revision=3)
    told = CommandReport(sent_ns=-5, acknowledged={2**64 - 1: 2**64 - 1}, streams=(good,))
    assert COMMAND_REPORTS.from_bytes(COMMAND_REPORTS.to_bytes(told)) == told
    for report in (
        replace(told, streams=(replace(good, topic=CommandTopic(topic="/a b")),)),
        replace(told, streams=(replace(good, topic=CommandTopic(topic="/a", type_name="x")),)),
        replace(told, streams=(replace(good, topic=CommandTopic(topic="/a", age_ms=math.nan)),)),
        replace(told, streams=(replace(good, topic=CommandTopic(topic="/a", refused=-1)),)),
        replace(told, streams=(replace(good, revision=2**16),)),
        replace(told, streams=(good,) * 17),
        replace(told, acknowledged=dict.fromkeys(range(5), 1)),
    ):
        with pytest.raises(LinkError, match="malformed"):
            COMMAND_REPORTS.from_bytes(COMMAND_REPORTS.to_bytes(report))
    with pytest.raises(LinkError, match="malformed"):
        COMMAND_REPORTS.from_bytes(COMMAND_REPORTS.to_bytes(told) + b"[" * 20_000)
    with pytest.raises(LinkError):
        COMMANDS.from_bytes(COMMANDS.to_bytes(SentNames(sender=1, topics=("/a",) * 17)))
