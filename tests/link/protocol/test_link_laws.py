# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What holds on every link, for all that is sent over it, and for all that may come from outside."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from link.protocol.simulated_link import Ends, Link, S, Source
from link.protocol.whole_chunks import WholeChunks
from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.link import LinkNeeds, Prediction, ReceivedMessage, StreamCounts, StreamInfo
from smarttestudo.domain.robot import Qos
from smarttestudo.link.protocol.chunks import (
    CONTROL_STREAM,
    HEADER_BYTES,
    NOTHING_RECEIVED,
    Acknowledgement,
    Chunk,
)
from smarttestudo.link.protocol.messages import CONTROL, REPORTS, Announcement, LinkTimes, Report
from smarttestudo.link.protocol.receiver import LinkReceiver
from smarttestudo.link.protocol.sender import MAX_ENDING, LinkSender
from smarttestudo.link.protocol.wire import WIRE_VERSION, Kind

rates = st.sampled_from([0.0, 5_000.0, 60_000.0, 400_000.0, 3_000_000.0])


@cache
@st.composite
def links(draw: st.DrawFn) -> Link:
    """Up to four changes of the rate in ten seconds; at the end there is a link."""
    times = sorted(draw(st.lists(st.floats(0.5, 9.0), max_size=4)))
    steps = [(0.0, draw(rates)), *((at_s, draw(rates)) for at_s in times), (10.0, 400_000.0)]
    return Link(steps, draw(st.floats(0.001, 0.2)))


@cache
@st.composite
def sources(draw: st.DrawFn) -> tuple[Source, ...]:
    return tuple(
        Source(
            topic=f"/topic_{number}",
            size_bytes=draw(st.integers(8, 50_000)),
            rate_hz=draw(st.floats(0.5, 40)),
            to_s=14.0,
            transient_local=draw(st.booleans()),
        )
        for number in range(draw(st.integers(1, 4)))
    )


@given(links(), sources(), st.lists(st.booleans(), min_size=4, max_size=4))
def test_all_that_arrives_was_sent_and_in_order_and_the_newest_arrives(
    link: Link, sent: tuple[Source, ...], full: list[bool]
) -> None:
    ends = Ends(link, sent)
    needs = {source.topic: LinkNeeds(is_full=is_full) for source, is_full in zip(sent, full, strict=False)}
    ends.sender.follow(needs)
    # A slow link may have many seconds of chunks under way when it gets better.
    ends.run(60)
    for source in sent:
        payloads = ends.payloads[source.topic]
        got = [payloads.index(message.payload) for _, message in ends.arrived[source.topic]]
        assert got == sorted(set(got))
        assert got
        assert got[-1] == len(payloads) - 1
        is_kept = source.transient_local or needs[source.topic].is_full
        counts = ends.sender.counts(0)[source.topic]
        if is_kept and not counts.overflowed and not source.transient_local:
            assert got == list(range(len(payloads)))
    assert ends.receiver.counts.malformed == 0
    assert ends.receiver.counts.broken == 0


LINK_BYTES_PER_S = 100_000.0


@settings(max_examples=40)
@given(
    large=st.lists(st.tuples(st.integers(20_000, 2_000_000), st.floats(0.2, 30)), min_size=1, max_size=3),
    small=st.lists(st.tuples(st.integers(8, 200), st.floats(0.5, 20)), min_size=1, max_size=6),
)
def test_small_topics_that_take_a_twentieth_of_a_link_wait_for_no_large_one_of_their_priority(
    large: list[tuple[int, float]], small: list[tuple[int, float]]
) -> None:
    sources = [
        Source(topic=f"/{name}{number}", size_bytes=size_bytes, rate_hz=rate_hz)
        for name, topics in (("large", large), ("small", small))
        for number, (size_bytes, rate_hz) in enumerate(topics)
    ]
    kept = [one for one in sources if one.topic.startswith("/small")]
    while sum((one.size_bytes + HEADER_BYTES) * one.rate_hz for one in kept) > LINK_BYTES_PER_S / 20:
        sources.remove(kept.pop())
    ends = Ends(Link(((0.0, LINK_BYTES_PER_S),)), sources)
    ends.run(10)
    for source in kept:
        arrived = [
            (at_ns, int.from_bytes(one.payload[:8], "little")) for at_ns, one in ends.arrived[source.topic]
        ]
        # Every message from when the operator's end is there, or a newer one, which is all the better.
        for number in range(math.ceil(source.rate_hz), int(9 * source.rate_hz)):
            at_ns = min(at_ns for at_ns, newer in arrived if newer >= number)
            assert at_ns / S - number / source.rate_hz < 0.4


@given(st.lists(st.binary(max_size=80) | st.binary(min_size=38, max_size=44), max_size=20))
def test_what_is_malformed_is_counted_and_delivers_nothing(strange: list[bytes]) -> None:
    receiver = LinkReceiver("robot", 1, lambda data, _most: data)
    assert all(receiver.receive(data, 0) is None for data in strange)


@given(st.binary(min_size=1, max_size=4_000), st.lists(st.integers(0, 40), max_size=60))
def test_cut_repeated_and_reordered_chunks_never_make_another_message(
    payload: bytes, order: list[int]
) -> None:
    ends = Ends(Link(((0.0, 1e9),)), (Source(topic="/a", size_bytes=8, rate_hz=1, to_s=0.5),))
    ends.run(0.2)
    sender = ends.sender
    sender.put(1, payload, 1 * S)
    chunks = []
    while (data := sender.scheduler.next_chunk(1 * S)) is not None:
        chunks.append(data)
    for number in order:
        got = ends.receiver.receive(chunks[number % len(chunks)], 1 * S)
        assert got is None or getattr(got, "payload", payload) == payload


@given(st.integers(0, 2**32 - 1), st.integers(0, 2**63), st.integers(0, 5))
def test_what_was_never_sent_cannot_be_acknowledged(session: int, received_bytes: int, receiver: int) -> None:
    ends = Ends(Link(((0.0, 1_000.0),)), (Source(topic="/a", size_bytes=5_000, rate_hz=5),))
    ends.run(1)
    before = ends.sender.state(1 * S)
    received = Acknowledgement(session=session, received_bytes=received_bytes)
    ends.sender.handle_report(Report(receiver=receiver, received=received), 1 * S)
    after = ends.sender.state(1 * S)
    assert after.capacity_kb_per_s == before.capacity_kb_per_s


@given(
    st.binary(max_size=300)
    | st.binary(max_size=60).map(lambda body: bytes((WIRE_VERSION, Kind.REPORT)) + body)
)
def test_random_bytes_are_a_report_or_refused(data: bytes) -> None:
    try:
        report = REPORTS.from_bytes(data)
    except LinkError:
        return
    assert REPORTS.to_bytes(report) == data


@given(
    st.integers(0, 2**32 - 1), st.integers(0, 4_095), st.integers(-(2**63), 2**63 - 1), st.binary(max_size=50)
)
def test_a_chunk_is_what_travelled(session: int, stream: int, stamp_ns: int, body: bytes) -> None:
    chunk = Chunk(
        session=session,
        session_offset=session ^ 1,
        stream=stream,
        number=3,
        offset=7,
        size_bytes=7 + len(body),
        offered_ns=stamp_ns,
        sent_ns=stamp_ns,
        is_compressed=True,
        is_kept=False,
        body=body,
    )
    assert Chunk.from_bytes(chunk.to_bytes()) == chunk


def test_a_sender_that_nobody_hears_keeps_the_newest_only() -> None:
    sender: LinkSender[None] = LinkSender()
    ends = Ends(Link(((0.0, 0.0),)), (Source(topic="/a", size_bytes=5_000, rate_hz=50),), sender)
    ends.run(10)
    assert sender.counts(0)["/a"].queued_bytes == 5_000
    assert sender.counts(0)["/a"].replaced == len(ends.payloads["/a"]) - 1


def test_counts_of_a_topic_go_on_when_one_of_its_publishers_leaves() -> None:
    sender: LinkSender[None] = LinkSender()
    first, second = sender.open(stream(), 0), sender.open(stream(publisher=1), 0)
    assert first is not None
    assert second is not None
    for number in range(10):
        sender.put(first, b"one", number)
        sender.put(second, b"other", number)
    before = sender.counts(10)["/a"]
    sender.close(second, 11)
    after = sender.counts(11)["/a"]
    assert (before.replaced, after.replaced) == (18, 18)
    assert (before.queued_bytes, after.queued_bytes) == (8, 3)
    sender.close(first, 12)
    assert sender.counts(12)["/a"] == replace(after, queued_bytes=0)


@pytest.mark.parametrize("is_latched", [False, True])
def test_the_last_words_of_a_publisher_arrive_although_it_left_in_an_outage(*, is_latched: bool) -> None:
    sender: LinkSender[None] = LinkSender()
    receiver = LinkReceiver("robot", 7, lambda data, _most: data)
    qos = Qos(reliable=True, transient_local=is_latched, depth=1)
    number = sender.open(stream(qos=qos), 0)
    assert number is not None
    assert exchange(sender, receiver, 0) == []
    sender.disconnect()
    sender.put(number, b"motor fault", S)
    sender.close(number, 2 * S)
    sender.put(number, b"nobody says this", 2 * S)
    assert exchange(sender, receiver, 60 * S) == [b"motor fault"]
    assert exchange(sender, receiver, 61 * S) == []
    assert receiver.streams == {}
    assert replace(sender.counts(61 * S)["/a"], sent_bytes=0) == StreamCounts(sent=1)


def test_of_too_many_publishers_that_left_in_an_outage_the_first_are_counted_as_lost() -> None:
    sender: LinkSender[None] = LinkSender()
    receiver = LinkReceiver("robot", 7, lambda data, _most: data)
    exchange(sender, receiver, 0)
    sender.disconnect()
    for publisher in range(MAX_ENDING + 3):
        number = sender.open(stream(publisher=publisher), S)
        assert number is not None
        sender.put(number, b"%d" % publisher, S)
        sender.close(number, S)
    assert sender.counts(S)["/a"].overflowed == 3
    arrived = exchange(sender, receiver, 60 * S)
    assert sorted(arrived) == sorted(b"%d" % publisher for publisher in range(3, MAX_ENDING + 3))
    counts = replace(sender.counts(60 * S)["/a"], sent_bytes=0)
    assert counts == StreamCounts(sent=MAX_ENDING, overflowed=3)


def exchange(sender: LinkSender[None], receiver: LinkReceiver, now_ns: int) -> list[bytes]:
    """Reports and chunks of a link without delay; the messages that arrive."""
    arrived = []
    for _ in range(3):
        sender.handle_report(REPORTS.from_bytes(receiver.next_report(now_ns)), now_ns)
        while (data := sender.scheduler.next_chunk(now_ns)) is not None:
            found = receiver.receive(data, now_ns)
            if isinstance(found, ReceivedMessage):
                arrived.append(found.payload)
    return arrived


def stream(**changes: Any) -> StreamInfo:
    qos = Qos(reliable=True, transient_local=False, depth=1)
    return replace(StreamInfo(topic="/a", type_name="x/msg/Y", qos=qos), **changes)


@pytest.mark.parametrize(
    "said",
    [
        LinkTimes(round_trip_ms=math.inf, report_period_ms=20),
        LinkTimes(round_trip_ms=math.nan, report_period_ms=20),
        LinkTimes(round_trip_ms=-1, report_period_ms=20),
        LinkTimes(round_trip_ms=1, report_period_ms=math.nan),
        LinkTimes(round_trip_ms=1, report_period_ms=-1),
        Announcement(stream=0, info=None),
        Announcement(stream=4096, info=None),
        Announcement(stream=1, info=stream(topic="/x y")),
        Announcement(stream=1, info=stream(type_name="../x")),
        Announcement(stream=1, info=stream(qos=Qos(reliable=True, transient_local=False, depth=0))),
        Announcement(stream=1, info=stream(definition="x" * 300_000)),
        Announcement(stream=1, info=stream(prediction=Prediction(within={"x": math.nan}, heartbeat_hz=1))),
        Announcement(stream=1, info=stream(prediction=Prediction(within={}, heartbeat_hz=0))),
    ],
)
def test_a_control_message_that_lies_is_refused(said: Announcement | LinkTimes) -> None:
    with pytest.raises(LinkError, match="malformed"):
        CONTROL.from_bytes(CONTROL.to_bytes(said))
    told = Announcement(stream=3, info=stream(), predicted_for=frozenset({2**64 - 1}))
    assert CONTROL.from_bytes(CONTROL.to_bytes(told)) == told


def test_a_session_that_somebody_else_claimed_does_not_end_the_link() -> None:
    ends = Ends(Link(((0.0, 1e6),)), (Source(topic="/a", size_bytes=500, rate_hz=10),))
    forged = Chunk(
        session=2**31,
        session_offset=0,
        stream=5,
        number=0,
        offset=0,
        size_bytes=3,
        offered_ns=0,
        sent_ns=0,
        is_compressed=False,
        is_kept=False,
        body=b"abc",
    )

    def forge(now_ns: int) -> None:
        ends.receiver.receive(forged.to_bytes(), now_ns)

    ends.at(1 * S, forge)
    ends.run(10)
    assert len(ends.ages_s("/a", 4)) >= 55


@given(st.integers(1, 40), st.integers(1, 40))
def test_messages_arrive_once_each_and_follow_on_each_other_beyond_the_last_number(
    before: int, after: int
) -> None:
    receiver = LinkReceiver("robot", 7, lambda data, _most: data)
    chunks = WholeChunks(is_kept=False)
    told = CONTROL.to_bytes(Announcement(stream=1, info=stream()))
    receiver.receive(chunks.of(CONTROL_STREAM, told), 0)
    numbers = [number % 2**32 for number in range(2**32 - before, 2**32 + after)]
    for number in numbers:
        got = [receiver.receive(chunks.of(1, b"x", number), 0) for _ in range(2)]
        assert isinstance(got[0], ReceivedMessage)
        assert got[0].begins_anew == (number == numbers[0])
        assert got[1] is None
    assert receiver.receive(chunks.of(1, b"x", numbers[0]), 0) is None
    assert receiver.counts.repeated == len(numbers) + 1


def test_no_claim_of_a_session_leaves_none_for_the_next_outages() -> None:
    sender: LinkSender[None] = LinkSender()
    sender.open(stream(), 0)
    for session in (0, 2**32 - 2**16 - 1, 2**32 - 2, 2**32 - 1):
        received = Acknowledgement(session=session, received_bytes=0)
        sender.handle_report(Report(receiver=7, received=received), 0)
    for _ in range(10):
        sender.disconnect()
        sender.handle_report(Report(receiver=7, received=NOTHING_RECEIVED), 0)
        assert sender.scheduler.next_chunk(0) is not None


@given(st.lists(st.sampled_from(["open", "close", "cut", "report"]), max_size=30))
def test_whoever_hears_the_robot_knows_its_streams_whatever_was_closed_in_an_outage(acts: list[str]) -> None:
    sender: LinkSender[None] = LinkSender()
    receiver = LinkReceiver("robot", 7, lambda data, _most: data)
    is_cut, now_ns, opened = True, 0, dict[int, StreamInfo]()
    for count, act in enumerate([*acts, "report"]):
        now_ns += 100_000_000
        if act == "open":
            info = stream(publisher=count)
            number = sender.open(info, now_ns)
            assert number is not None
            opened[number] = info
        elif act == "close" and opened:
            sender.close(number := min(opened), now_ns)
            del opened[number]
        elif act == "cut":
            sender.disconnect()
            is_cut = True
        elif act == "report":
            is_cut = False
        if not is_cut:
            for _ in range(2):
                sender.handle_report(REPORTS.from_bytes(receiver.next_report(now_ns)), now_ns)
                while (data := sender.scheduler.next_chunk(now_ns)) is not None:
                    receiver.receive(data, now_ns)
    assert receiver.streams == opened


@given(
    st.lists(
        st.tuples(st.sampled_from([7, 8, 9]), st.booleans(), st.sampled_from([0.3, 16.0, 90.0])), max_size=8
    )
)
def test_an_outage_is_counted_where_no_operator_was_there_though_there_had_been_one(
    comings: list[tuple[int, bool, float]],
) -> None:
    sender: LinkSender[Any] = LinkSender()
    now_ns, outages = S, 0
    for number, (receiver, is_noticed, absent_s) in enumerate(comings):
        for _ in range(4):
            sender.handle_report(Report(receiver=receiver, received=NOTHING_RECEIVED), now_ns)
            now_ns += S // 2
        assert sender.state(now_ns).outages == outages
        if is_noticed or absent_s > 10:
            sender.disconnect()
        now_ns += int(absent_s * S)
        outages += absent_s > 10 and number + 1 < len(comings)
    assert sender.state(now_ns + 4 * S).operators == frozenset()
