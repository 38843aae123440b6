# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What becomes of each message: whatever its size, the chunks and the reports, it arrives or is counted."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from link.protocol.stepped_wire import LANES, MS, TOPICS, Wire
from smarttestudo.link.protocol.outbox import MAX_QUEUED_BYTES
from smarttestudo.link.protocol.window import ACKNOWLEDGE_BYTES, ACKNOWLEDGE_PERIOD_NS, Window

sizes = st.integers(0, 300) | st.integers(0, 400_000)
steps = st.one_of(
    st.tuples(st.just("put"), st.sampled_from(TOPICS), sizes),
    st.tuples(st.just("pass"), st.integers(0, 60), st.none()),
    st.tuples(st.just("send"), st.integers(1, 20), st.none()),
    st.tuples(st.just("arrive"), st.integers(1, 20), st.none()),
    st.tuples(st.just("report"), st.booleans(), st.none()),
    st.tuples(st.just("hear"), st.integers(1, 5), st.none()),
)


@given(st.lists(steps, max_size=120))
def test_each_message_arrives_in_order_or_is_counted(order: list[tuple[str, int, int]]) -> None:
    wire = Wire()
    wire.run(order)
    drain(wire)
    assert wire.sender.state(wire.now_ns).outages == 0
    for topic in TOPICS:
        counts, offered, arrived = wire.counts(topic), wire.offered[topic], wire.arrived[topic]
        assert counts.sent == len(arrived)
        assert counts.sent + counts.replaced + counts.overflowed == len(offered)
        assert {*arrived} <= {*offered}
        lanes = LANES if topic == "/lanes" else 1
        for lane in range(lanes):
            of_lane = offered[lane::lanes]
            places = [of_lane.index(payload) for payload in arrived if payload in of_lane]
            assert places == sorted(set(places))
            # The newest is never replaced.
            assert places[-1:] == [len(of_lane) - 1] * bool(of_lane)
    assert wire.counts("/full").replaced == 0
    if sum(map(len, wire.offered["/full"])) <= MAX_QUEUED_BYTES:
        assert wire.arrived["/full"] == wire.offered["/full"]
    got = wire.receiver.counts
    assert got.broken == got.malformed == got.late == got.repeated == 0


def drain(wire: Wire) -> None:
    """Go on until each message was sent or counted."""
    for _ in range(3_000):
        wire.turn()
        wire.now_ns += 20 * MS
        counted = (wire.counts(topic) for topic in TOPICS)
        offered = sum(map(len, wire.offered.values()))
        if sum(one.sent + one.replaced + one.overflowed for one in counted) == offered:
            break
    wire.turn()


@given(st.lists(st.tuples(st.integers(1, 200_000), st.integers(0, 15)), min_size=1, max_size=30))
def test_what_arrived_is_reported_in_time_and_after_so_many_bytes_at_once(
    messages: list[tuple[int, int]],
) -> None:
    wire = Wire()
    wire.turn()
    reported_ns, unreported_bytes = wire.now_ns, 0
    wire.report(gets_through=True)
    for size_bytes, wait_ms in messages:
        wire.put("/full", size_bytes)
        wire.now_ns += wait_ms * MS
        # What it is sent is known to it at once, so that the window holds nothing back.
        while wire.send(1):
            unreported_bytes += len(wire.chunks[0])
            wire.arrive(1)
            is_due = wire.receiver.wake_ns <= wire.now_ns
            waited_ns = wire.now_ns - reported_ns
            period_ns = wire.receiver.report_period_ns
            assert is_due == (unreported_bytes >= ACKNOWLEDGE_BYTES or waited_ns >= period_ns)
            assert period_ns >= ACKNOWLEDGE_PERIOD_NS
            if is_due:
                wire.report(gets_through=True)
                reported_ns, unreported_bytes = wire.now_ns, 0
                wire.hear(len(wire.reports))


def test_a_window_may_be_told_that_nothing_arrived_before_anything_was_sent() -> None:
    window = Window()
    window.idle()
    assert window.acknowledge(0, 5 * MS)
    assert not window.acknowledge(1, 6 * MS)
