# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What becomes of each message: whatever its size, the chunks and the reports, it arrives or is counted."""

from __future__ import annotations

from collections import deque

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.link import LinkNeeds, StreamInfo
from smarttestudo.domain.link_state import StreamCounts
from smarttestudo.domain.robot import Qos
from smarttestudo.link.protocol.messages import REPORTS, Announcement
from smarttestudo.link.protocol.outbox import MAX_QUEUED_BYTES
from smarttestudo.link.protocol.receiver import LinkReceiver
from smarttestudo.link.protocol.sender import LinkSender
from smarttestudo.link.protocol.window import ACKNOWLEDGE_BYTES, ACKNOWLEDGE_PERIOD_NS, Window

MS = 1_000_000
TOPICS = ("/replaced", "/lanes", "/full")
LANES = 3
sizes = st.integers(0, 300) | st.integers(0, 400_000)
steps = st.one_of(
    st.tuples(st.just("put"), st.sampled_from(TOPICS), sizes),
    st.tuples(st.just("pass"), st.integers(0, 60), st.none()),
    st.tuples(st.just("send"), st.integers(1, 20), st.none()),
    st.tuples(st.just("arrive"), st.integers(1, 20), st.none()),
    st.tuples(st.just("report"), st.booleans(), st.none()),
    st.tuples(st.just("hear"), st.integers(1, 5), st.none()),
)


class Wire:
    """Both ends with what is under way between them, in order either way, and late as the steps will."""

    def __init__(self) -> None:
        self.now_ns = self.turned_ns = 0
        self.sender: LinkSender[None] = LinkSender()
        self.receiver = LinkReceiver("robot", 7, lambda data, _most: data)
        self.sender.follow({"/full": LinkNeeds(is_full=True, priority=1), "/lanes": LinkNeeds(priority=2)})
        qos = Qos(reliable=True, transient_local=False, depth=1)
        self.streams = {
            topic: self.sender.open(StreamInfo(topic=topic, type_name="a/msg/A", qos=qos), 0)
            for topic in TOPICS
        }
        self.chunks: deque[bytes] = deque()
        self.reports: deque[bytes] = deque()
        self.offered: dict[str, list[bytes]] = {topic: [] for topic in TOPICS}
        self.arrived: dict[str, list[bytes]] = {topic: [] for topic in TOPICS}

    def put(self, topic: str, size_bytes: int) -> None:
        number = len(self.offered[topic])
        payload = number.to_bytes(4, "little") + bytes(size_bytes)
        self.offered[topic].append(payload)
        stream = self.streams[topic]
        assert stream is not None
        self.sender.put(stream, payload, self.now_ns, number % LANES if topic == "/lanes" else None)

    def send(self, most: int) -> bool:
        before = len(self.chunks)
        for _ in range(most):
            data = self.sender.next_chunk(self.now_ns)
            if data is None:
                # Whoever goes by has_next misses nothing.
                assert not self.sender.has_next(self.now_ns)
                break
            self.chunks.append(data)
        return len(self.chunks) > before

    def arrive(self, most: int) -> None:
        for _ in range(min(most, len(self.chunks))):
            got = self.receiver.receive(self.chunks.popleft(), self.now_ns)
            if got is not None and not isinstance(got, Announcement):
                self.arrived[got.stream.topic].append(got.payload)

    def report(self, *, gets_through: bool) -> None:
        report = self.receiver.next_report(self.now_ns)
        if gets_through:
            self.reports.append(report)

    def hear(self, most: int) -> None:
        for _ in range(min(most, len(self.reports))):
            self.sender.handle_report(REPORTS.from_bytes(self.reports.popleft()), self.now_ns)

    def turn(self) -> None:
        """All that is under way arrives, and what may be sent then is."""
        self.turned_ns = self.now_ns
        self.arrive(len(self.chunks))
        self.report(gets_through=True)
        self.hear(len(self.reports))
        while self.send(100):
            self.arrive(len(self.chunks))

    def act(self, step: str, first: str | int | bool, second: int | None) -> None:
        match step:
            case "put":
                self.put(str(first), second or 0)
            case "pass":
                self.wait(int(first) * MS)
            case "send":
                self.send(int(first))
            case "arrive":
                self.arrive(int(first))
            case "report":
                self.report(gets_through=bool(first))
            case "hear":
                self.hear(int(first))

    def wait(self, time_ns: int) -> None:
        """Let time pass; what is under way for nearly a second arrives, as this is about no outage."""
        if self.now_ns + time_ns > self.turned_ns + 900 * MS:
            self.turn()
        self.now_ns += time_ns

    def drain(self) -> None:
        """Go on until each message was sent or counted."""
        for _ in range(3_000):
            self.turn()
            self.now_ns += 20 * MS
            counted = (self.counts(topic) for topic in TOPICS)
            offered = sum(map(len, self.offered.values()))
            if sum(one.sent + one.replaced + one.overflowed for one in counted) == offered:
                break
        self.turn()

    def counts(self, topic: str) -> StreamCounts:
        return self.sender.counts(self.now_ns)[topic]


@given(st.lists(steps, max_size=120))
def test_each_message_arrives_in_order_or_is_counted(order: list[tuple[str, int, int]]) -> None:
    wire = Wire()
    wire.turn()
    for step in order:
        wire.act(*step)
    wire.drain()
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
