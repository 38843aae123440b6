# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A link in virtual time between the two ends, with a rate that changes, a delay, a queue and outages."""

from __future__ import annotations

import heapq
import itertools
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from smarttestudo.domain.link import MessageOrigin, ReceivedMessage, StreamInfo
from smarttestudo.domain.robot import Qos
from smarttestudo.link.protocol.messages import REPORTS, Announcement, Report
from smarttestudo.link.protocol.receiver import LinkReceiver
from smarttestudo.link.protocol.sender import LinkSender

MS = 1_000_000
S = 1_000 * MS
NEVER_NS = 2**62


@dataclass(frozen=True, kw_only=True)
class Source:
    """A topic that sends ``size_bytes`` at ``rate_hz`` from ``from_s`` to ``to_s``."""

    topic: str
    size_bytes: int
    rate_hz: float
    from_s: float = 0.0
    to_s: float = float("inf")
    transient_local: bool = False


@dataclass
class Link:
    """The rate in bytes/s from each time on (0: an outage, in which what is sent waits), and the delay."""

    steps: Sequence[tuple[float, float]]
    delay_s: float = 0.01
    free_ns: int = 0
    carried_bytes: int = 0

    def rate(self, at_ns: int) -> float:
        return [rate for from_s, rate in self.steps if from_s * S <= at_ns][-1]

    def arrival_ns(self, size_bytes: int, now_ns: int) -> int:
        """When the last byte arrives of what is sent now."""
        at_ns, left = max(now_ns, self.free_ns), float(size_bytes)
        ends = [*(int(from_s * S) for from_s, _ in self.steps), 2**62]
        while left > 0:
            until_ns = next(end for end in ends if end > at_ns)
            rate = self.rate(at_ns)
            could = rate * (until_ns - at_ns) / S
            if could >= left:
                at_ns += int(left / rate * S)
                break
            left, at_ns = left - could, until_ns
        self.free_ns = at_ns
        self.carried_bytes += size_bytes
        return at_ns + int(self.delay_s * S)


@dataclass
class Ends:
    """Both ends and what was seen: each message with its arrival, by topic."""

    link: Link
    sources: Sequence[Source]
    sender: LinkSender[Any] = field(default_factory=LinkSender)
    arrived: dict[str, list[tuple[int, ReceivedMessage]]] = field(default_factory=lambda: defaultdict(list))
    budgets: list[tuple[int, float | None]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.receiver = LinkReceiver("robot", 7, lambda data, _most: data)
        self.payloads: dict[str, list[bytes]] = defaultdict(list)
        self._events: list[tuple[int, int, Callable[[int], None]]] = []
        self._order = itertools.count()
        self._streams: dict[str, int] = {}
        self._report_ns = 0

    def at(self, at_ns: int, act: Callable[[int], None]) -> None:
        heapq.heappush(self._events, (at_ns, next(self._order), act))

    def run(self, seconds: float) -> None:
        self.open_streams(0)
        for source in self.sources:
            self.at(int(source.from_s * S), partial(self._publish, source))
        self.at(0, self._report)
        self.go_on(seconds)

    def open_streams(self, now_ns: int) -> None:
        """Have the robot's end carry all sources."""
        for source in self.sources:
            qos = Qos(reliable=True, transient_local=source.transient_local, depth=10)
            info = StreamInfo(topic=source.topic, type_name="std_msgs/msg/String", qos=qos)
            stream = self.sender.open(info, now_ns)
            assert stream is not None
            self._streams[source.topic] = stream

    def go_on(self, seconds: float) -> None:
        """Run until so many seconds have passed since the beginning."""
        end_ns = int(seconds * S)
        while self._events and self._events[0][0] <= end_ns and not self.is_over():
            at_ns, _, act = heapq.heappop(self._events)
            act(at_ns)
            self._pump(at_ns)

    def is_over(self) -> bool:
        """Whether nothing that happens later matters."""
        return False

    def _publish(self, source: Source, now_ns: int) -> None:
        count = len(self.payloads[source.topic])
        payload = count.to_bytes(8, "little") + bytes(source.size_bytes - 8)
        self.payloads[source.topic].append(payload)
        origin = MessageOrigin(topic=source.topic, stamp_ns=now_ns)
        self.sender.put(self._streams[source.topic], payload, now_ns, origin=origin)
        next_ns = now_ns + int(S / source.rate_hz)
        if next_ns < source.to_s * S:
            self.at(next_ns, partial(self._publish, source))

    def _pump(self, now_ns: int) -> None:
        while (data := self.sender.scheduler.next_chunk(now_ns)) is not None:
            self.at(self.link.arrival_ns(len(data), now_ns), partial(self._arrive, data))

    def _arrive(self, data: bytes, now_ns: int) -> None:
        got = self.receiver.receive(data, now_ns)
        if got is not None and not isinstance(got, Announcement):
            self.arrived[got.stream.topic].append((now_ns, got))
        self._report_soon(now_ns)

    def _report_soon(self, now_ns: int) -> None:
        due_ns = max(now_ns, self.receiver.wake_ns)
        if due_ns < self._report_ns:
            self._report_ns = due_ns
            self.at(due_ns, self._report)

    def _report(self, now_ns: int) -> None:
        if now_ns < self.receiver.wake_ns or now_ns != self._report_ns:
            return
        report = REPORTS.from_bytes(self.receiver.next_report(now_ns))
        if self.link.rate(now_ns) > 0:
            self.at(now_ns + int(self.link.delay_s * S), partial(self._take_report, report))
        self._report_ns = NEVER_NS
        self._report_soon(now_ns)

    def _take_report(self, report: Report, now_ns: int) -> None:
        self.sender.handle_report(report, now_ns)
        self.budgets.append((now_ns, self.sender.scheduler.budget.kb_per_s))

    def ages_s(self, topic: str, from_s: float = 0.0, to_s: float = float("inf")) -> list[float]:
        """How old the messages were that arrived in that time, by the times of the simulation."""
        return [
            (at_ns - message.offered_ns) / S
            for at_ns, message in self.arrived[topic]
            if from_s * S <= at_ns < to_s * S
        ]


def quantile(values: Sequence[float], share: float) -> float:
    """The value that ``share`` of them do not exceed."""
    return sorted(values)[min(len(values) - 1, int(len(values) * share))]
