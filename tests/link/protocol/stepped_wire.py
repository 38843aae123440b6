# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Both ends of a link that act step by step, so that anything may come late either way."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

from smarttestudo.domain.link import LinkNeeds, MessageOrigin, StreamCounts, StreamInfo
from smarttestudo.domain.robot import Qos
from smarttestudo.link.protocol.messages import REPORTS, Announcement
from smarttestudo.link.protocol.receiver import LinkReceiver
from smarttestudo.link.protocol.sender import LinkSender

MS = 1_000_000
TOPICS = ("/replaced", "/lanes", "/full")
LANES = 3


class Wire:
    """Both ends with what is under way between them, in order either way, and late as the steps will."""

    def __init__(self, *latched: str) -> None:
        self.now_ns = self.turned_ns = 0
        self.sender: LinkSender[None] = LinkSender()
        self.receiver = LinkReceiver("robot", 7, lambda data, _most: data)
        self.sender.follow({"/full": LinkNeeds(is_full=True, priority=1), "/lanes": LinkNeeds(priority=2)})
        self.streams = {topic: self._open(topic, is_latched=topic in latched) for topic in TOPICS + latched}
        self.chunks: deque[bytes] = deque()
        self.reports: deque[bytes] = deque()
        self.offered: dict[str, list[bytes]] = {topic: [] for topic in self.streams}
        self.arrived: dict[str, list[bytes]] = {topic: [] for topic in self.streams}

    def put(self, topic: str, size_bytes: int) -> None:
        number = len(self.offered[topic])
        payload = number.to_bytes(4, "little") + bytes(size_bytes)
        self.offered[topic].append(payload)
        lane = number % LANES if topic == "/lanes" else None
        origin = MessageOrigin(topic=topic, stamp_ns=number)
        self.sender.put(self.streams[topic], payload, self.now_ns, lane, origin)

    def send(self, most: int) -> bool:
        before = len(self.chunks)
        for _ in range(most):
            data = self.sender.scheduler.next_chunk(self.now_ns)
            if data is None:
                # Whoever goes by has_next misses nothing.
                assert not self.sender.scheduler.has_next(self.now_ns)
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

    def run(self, steps: Iterable[tuple[str, int, int]]) -> None:
        """Have both ends know each other, and act."""
        self.turn()
        for step in steps:
            self.act(*step)

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

    def counts(self, topic: str) -> StreamCounts:
        return self.sender.counts(self.now_ns)[topic]

    def _open(self, topic: str, *, is_latched: bool) -> int:
        qos = Qos(reliable=True, transient_local=is_latched, depth=2)
        stream = self.sender.open(StreamInfo(topic=topic, type_name="a/msg/A", qos=qos), 0)
        assert stream is not None
        return stream
