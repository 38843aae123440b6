# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Each message arrives or is missed, whatever a link loses and however late chunks and reports are."""

from __future__ import annotations

from collections.abc import Sequence

from hypothesis import given
from hypothesis import strategies as st

from link.protocol.stepped_wire import MS, TOPICS, Wire
from smarttestudo.domain.link import MissedMessage, ReceivedMessage
from smarttestudo.link.protocol.chunks import (
    MAX_LOST_SPANS,
    NOTHING_RECEIVED,
    SESSION_OFFSETS,
    Chunk,
    ReceivedSessions,
)
from smarttestudo.link.protocol.messages import REPORTS, Report
from smarttestudo.link.protocol.receiver import LinkReceiver

MAP = "/map"
sizes = st.integers(0, 300) | st.integers(0, 20_000)
# What is passed on in one step may be all that is under way.
many = st.integers(1, 5) | st.just(10**6)
steps = st.one_of(
    st.tuples(st.just("put"), st.sampled_from((*TOPICS, MAP)), sizes),
    st.tuples(st.just("pass"), st.integers(0, 60) | st.integers(0, 4_000), st.none()),
    st.tuples(st.just("send"), many, st.none()),
    st.tuples(st.just("arrive"), many, st.none()),
    st.tuples(st.just("report"), st.booleans(), st.none()),
    st.tuples(st.just("hear"), many, st.none()),
    st.tuples(st.just("lose"), many, st.none()),
    st.tuples(st.just("disconnect"), st.none(), st.none()),
    st.tuples(st.just("join"), st.none(), st.none()),
    st.tuples(st.just("close"), st.none(), st.none()),
)


class LossyWire(Wire):
    """A link whose connection may be cut at any time, so that chunks under way are lost."""

    joined = 0
    is_map_closed = False

    def act(self, step: str, first: str | int | bool, second: int | None) -> None:
        match step:
            case "put" if first == MAP and self.is_map_closed:
                pass
            case "close":
                self.sender.close(self.streams[MAP], self.now_ns)
                self.is_map_closed = True
            case "join":
                # Another operator's end, while this one is served.
                self.turn()
                self.joined += 1
                report = Report(receiver=100 + self.joined, received=NOTHING_RECEIVED)
                self.sender.handle_report(report, self.now_ns)
            case "pass":
                self.now_ns += int(first) * MS
            case "lose":
                for _ in range(min(int(first), len(self.chunks))):
                    self.chunks.popleft()
            case "disconnect":
                self.sender.disconnect()
            case _:
                super().act(step, first, second)

    def settle(self) -> None:
        """Go on until it is known of each message what became of it."""
        for _ in range(60):
            self.turn()
            self.now_ns += 600 * MS


@given(st.lists(steps, max_size=80))
def test_each_message_arrived_or_was_missed_and_none_was_both(order: list[tuple[str, int, int]]) -> None:
    wire = LossyWire(MAP)
    wire.run(order)
    wire.settle()
    assert wire.sender.is_settled
    missed = wire.sender.take_missed(wire.now_ns)
    require_known(wire, missed)
    for topic in wire.streams:
        assert {*wire.arrived[topic]} & payloads(missed, topic) == set()
    # These are never given up: what overflows is counted.
    assert len(wire.arrived["/full"]) + wire.counts("/full").overflowed == len(wire.offered["/full"])
    assert wire.arrived["/full"] == [one for one in wire.offered["/full"] if one in wire.arrived["/full"]]


@given(st.lists(steps, max_size=80))
def test_what_a_run_that_ends_had_for_nobody_is_missed_once(order: list[tuple[str, int, int]]) -> None:
    wire = LossyWire(MAP)
    wire.run(order)
    wire.sender.disconnect()
    require_known(wire, wire.sender.take_missed(wire.now_ns, is_last=True))


def require_known(wire: Wire, missed: Sequence[MissedMessage]) -> None:
    """Each message once has arrived or was missed, or is counted where a newer one took its place."""
    assert len(missed) == len({(one.origin.topic, one.payload) for one in missed})
    for topic, arrived in wire.arrived.items():
        assert len(arrived) == len({*arrived})
        counts = wire.counts(topic)
        unknown = {*wire.offered[topic]} - {*arrived} - payloads(missed, topic)
        assert len(unknown) <= counts.replaced + counts.overflowed


def payloads(missed: Sequence[MissedMessage], topic: str) -> set[bytes]:
    return {one.payload for one in missed if one.origin.topic == topic}


@given(st.lists(st.tuples(st.integers(1, 2**30), st.booleans()), min_size=1, max_size=60))
def test_no_lost_message_is_acknowledged_and_of_few_spans_each_other_one(
    messages: list[tuple[int, bool]],
) -> None:
    sessions, end_bytes, spans, was_lost = ReceivedSessions(), 0, 0, False
    ends = dict[int, bool]()
    for size_bytes, is_lost in messages:
        assert sessions.on_chunk(chunk_at(end_bytes), size_bytes)
        end_bytes += size_bytes
        ends[end_bytes] = is_lost
        spans += is_lost and not was_lost
        was_lost = is_lost
        if is_lost:
            sessions.lack()
    received = sessions.newest
    assert received.received_bytes == end_bytes
    assert [end for end, is_lost in ends.items() if is_lost and received.has(end)] == []
    if spans <= MAX_LOST_SPANS:
        assert [end for end, is_lost in ends.items() if not is_lost and not received.has(end)] == []
    assert len(received.lost) <= MAX_LOST_SPANS


def chunk_at(begin_bytes: int) -> Chunk:
    """A chunk of the first session that begins there."""
    offset = begin_bytes % SESSION_OFFSETS
    return Chunk(1, offset, 1, 0, 0, 1, 0, 0, is_compressed=False, is_kept=False, body=b"x")


def test_another_operators_end_that_lost_a_chunk_hears_the_next_session() -> None:
    wire = Wire()
    other, heard = LinkReceiver("robot", 9, lambda data, _most: data), list[bytes]()
    wire.turn()
    for number in range(40):
        wire.put("/replaced", 100)
        assert wire.send(10)
        for data in wire.chunks:
            got = other.receive(data, wire.now_ns) if number != 10 else None
            heard += [got.payload] if isinstance(got, ReceivedMessage) else []
        wire.arrive(10)
        wire.report(gets_through=True)
        wire.hear(1)
        wire.sender.handle_report(REPORTS.from_bytes(other.next_report(wire.now_ns)), wire.now_ns)
        wire.now_ns += 100 * MS
    offered = wire.offered["/replaced"]
    assert wire.arrived["/replaced"] == offered
    # It gets to know the topic after the first message, and the loss by the one that follows it.
    assert [offered.index(payload) for payload in heard] == [*range(1, 10), *range(12, 40)]
