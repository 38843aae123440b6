# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is asked of a window and of a stream for every chunk is what the long way says."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.link import LinkNeeds
from smarttestudo.domain.units import NS_PER_MS
from smarttestudo.link.protocol.outgoing_stream import OutgoingMessage, OutgoingStream
from smarttestudo.link.protocol.window import START_BYTES_PER_S, Window

STEPS = st.lists(
    st.tuples(
        st.sampled_from(["sent", "acknowledged", "limited", "idle"]), st.integers(0, 40), st.floats(0, 1)
    ),
    max_size=60,
)
TIMES = st.lists(st.integers(0, 9), max_size=3)


@given(STEPS)
def test_a_window_has_room_exactly_where_a_chunk_may_have_bytes(steps: list[tuple[str, int, float]]) -> None:
    window, now_ns = Window(), 0
    for what, after_ms, share in steps:
        now_ns += after_ms * NS_PER_MS
        if what == "sent":
            window.sent(max(1, int(window.chunk_bytes * share)), now_ns)
        elif what == "acknowledged":
            window.acknowledge(window.acknowledged_bytes + int(window.in_flight_bytes * share), now_ns)
        elif what == "limited":
            window.limited()
        else:
            window.idle()
        assert window.has_room == (window.chunk_bytes > 0)


@given(st.integers(1, 1_000), st.integers(1, 20), st.integers(0, 5), st.booleans())
def test_a_link_on_which_nothing_is_under_way_carries_what_was_known_though_the_last_bytes_took_long(
    size_bytes: int, stalled_s: int, more_messages: int, is_idle: bool
) -> None:
    window, now_ns = Window(), 0
    for trip_ms in (5, stalled_s * 1_000, *[5] * more_messages):
        window.sent(size_bytes, now_ns)
        now_ns += trip_ms * NS_PER_MS
        if is_idle:
            window.idle()
        window.acknowledge(window.sent_bytes, now_ns)
        for _ in range(6):
            now_ns += 500 * NS_PER_MS
            window.acknowledge(window.sent_bytes, now_ns)
    assert window.capacity_bytes_per_s >= START_BYTES_PER_S


@given(TIMES, TIMES)
def test_the_next_message_of_a_stream_is_the_oldest_of_its_queue_and_its_slots(
    queued: list[int], slots: list[int]
) -> None:
    stream = OutgoingStream(1, LinkNeeds(), None)
    for number, offered_ns in enumerate([*queued, *slots]):
        message = OutgoingMessage(1, number, b"", offered_ns, is_kept=False)
        if number < len(queued):
            stream.queue.append(message)
        else:
            stream.put_slot(message)
    first = [times[0] for times in (queued, slots) if times]
    if first:
        assert stream.next_message.offered_ns == min(first)
