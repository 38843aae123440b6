# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Fetches of files over the simulated link, in virtual time, beside live topics or alone."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

from link.protocol.simulated_link import Ends, Link, S, Source
from smarttestudo.domain.link import LinkNeeds
from smarttestudo.link.protocol.sender import LinkSender
from smarttestudo.link.transfer.fetching import Fetching
from smarttestudo.link.transfer.messages import PARTS, VERSION_BYTES, Ask, ContentPart, Got
from smarttestudo.link.transfer.order import ByteRange, MessageRange, TransferOrder

LOOK_NS = S // 10
FRAMING_BYTES = 100
"""What goes with a part on the wire beside what it is."""


@dataclass(frozen=True, kw_only=True)
class Recorded:
    """A topic of a recording with its messages' stamps, in one file."""

    topic: str
    size_bytes: int
    rate_hz: float


@dataclass(kw_only=True)
class Contents:
    """The bytes of some files and the order in which they travel."""

    files: list[bytes]
    messages: list[MessageRange]
    order: TransferOrder

    @staticmethod
    def of(topics: Sequence[Recorded], seconds: float, seed: int = 1) -> Contents:
        """One file with all messages in the order of their stamps, after a head and before a tail."""
        rng = random.Random(seed)
        stamps = sorted(
            (int(number / one.rate_hz * S), one.topic, one.size_bytes)
            for one in topics
            for number in range(int(seconds * one.rate_hz))
        )
        head = ByteRange(0, 0, 2_000)
        messages, place = [], head.size_bytes
        for stamp_ns, topic, size_bytes in stamps:
            messages.append(MessageRange(0, place, size_bytes, topic, stamp_ns))
            place += size_bytes
        tail = ByteRange(0, place, 1_000)
        data = rng.randbytes(place + tail.size_bytes)
        return Contents(files=[data], messages=messages, order=TransferOrder([head], messages, [tail]))

    def part(self, offset: int, size_bytes: int) -> ContentPart:
        """What the robot's end sends."""
        data = self.read(offset, size_bytes)
        total_bytes = self.order.size_bytes
        return ContentPart(version=bytes(VERSION_BYTES), total_bytes=total_bytes, offset=offset, data=data)

    def read(self, offset: int, size_bytes: int) -> bytes:
        """Bytes of the order."""
        data = b""
        for one in self.order.stretches(offset, size_bytes):
            if isinstance(one, bytes):
                data += one
            else:
                data += self.files[one.file][one.offset : one.offset + one.size_bytes]
        return data


@dataclass(eq=False)
class Answering:
    """A question for bytes with what is left of its answer."""

    operator: Operator
    ask: Ask
    offset: int


@dataclass(eq=False)
class Operator:
    """Who fetches; what is there of the bytes survives a restart, questions that are under way do not."""

    fetching: Fetching
    asker: int
    data: bytearray


@dataclass
class FetchingEnds(Ends):
    """Both ends with a fetch from ``from_s`` on. ``loses`` says whether what arrives then is lost."""

    contents: Contents = field(default_factory=lambda: Contents.of((), 0))
    from_s: float = 0.0
    is_live: bool = True
    is_urgent: bool = False
    ends_when_done: bool = False
    loses: Callable[[int], bool] = lambda _now_ns: False
    sender: LinkSender[Answering] = field(default_factory=LinkSender)
    progress: list[tuple[int, int]] = field(default_factory=list)
    """When how many bytes of the order were there."""
    sent_bytes: int = 0
    lost_bytes: int = 0
    """Bytes of the order that left the robot, and those that did not arrive or came in vain."""
    done_ns: int | None = None
    under_way: int = 0
    """Parts that did not arrive yet."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.operator = self._operator(bytearray(), 1)
        self._wake_ns = math.inf
        self.at(int(self.from_s * S), self._look)

    def _operator(self, data: bytearray, asker: int) -> Operator:
        return Operator(Fetching("files", asker, offset=len(data)), asker, data)

    @property
    def has_all(self) -> bool:
        """Whether what was fetched are the robot's bytes."""
        order = self.contents.order
        return bytes(self.operator.data) == self.contents.read(0, order.size_bytes)

    def is_over(self) -> bool:
        return self.ends_when_done and self.done_ns is not None and not self.under_way

    def restart(self, now_ns: int) -> None:
        """The process of the operator is killed and begins again where it was."""
        self.operator = self._operator(self.operator.data, self.operator.asker + 1)
        self._ask(now_ns)

    def _report(self, now_ns: int) -> None:
        if self.is_live:
            super()._report(now_ns)

    def _ask(self, now_ns: int) -> None:
        operator, arrival_ns = self.operator, now_ns + int(self.link.delay_s * S)
        said = operator.fetching.next(now_ns)
        if isinstance(said, Ask):
            if self.link.rate(now_ns) > 0 and not self.loses(now_ns):
                self.at(arrival_ns, partial(self._arrive_ask, operator, said))
        elif said is not None and self.link.rate(now_ns) > 0:
            self.at(arrival_ns, partial(self._arrive_got, said))

    def _look(self, now_ns: int) -> None:
        """As the operator's end does where nothing arrives."""
        self._ask(now_ns)
        if self.done_ns is None:
            self.at(now_ns + LOOK_NS, self._look)

    def _arrive_got(self, got: Got, now_ns: int) -> None:
        self.sender.scheduler.requests.acknowledge(got.asker, got.got_bytes, now_ns)

    def _arrive_ask(self, operator: Operator, ask: Ask, now_ns: int) -> None:
        answering = Answering(operator, ask, ask.offset)
        if self.is_urgent:
            assert self.sender.scheduler.requests.enqueue_urgent(answering)
            return
        gone = self.sender.scheduler.requests.enqueue(ask.asker, ask.got_bytes, answering, now_ns)
        assert gone is not answering
        self._drop(gone, now_ns)

    def _drop(self, gone: Answering | None, now_ns: int) -> None:
        """Have who asked hear that nothing more comes."""
        if gone is not None and self.link.rate(now_ns) > 0:
            operator, ask = gone.operator, gone.ask

            def end(at_ns: int) -> None:
                operator.fetching.ended(ask, at_ns)

            self.at(now_ns + int(self.link.delay_s * S), end)

    def _pump(self, now_ns: int) -> None:
        super()._pump(now_ns)
        scheduler = self.sender.scheduler
        for gone in scheduler.requests.expired(now_ns):
            self._drop(gone, now_ns)
        while (grant := scheduler.next_grant(now_ns)) is not None:
            answering = grant.request
            part = self.contents.part(answering.offset, grant.size_bytes)
            data = PARTS.to_bytes(part)
            answering.offset += len(part.data)
            scheduler.requests.sent(grant, len(data), now_ns)
            if answering.offset >= part.total_bytes:
                scheduler.requests.finish(grant)
            self.sent_bytes += len(part.data)
            self.under_way += 1
            arrival_ns = self.link.arrival_ns(len(data) + FRAMING_BYTES, now_ns)
            self.at(arrival_ns, partial(self._arrive_part, answering.operator, data))
            super()._pump(now_ns)
        wake_ns = scheduler.requests.wake_ns(now_ns)
        if wake_ns is not None and not now_ns < self._wake_ns <= wake_ns:
            self._wake_ns = wake_ns
            self.at(wake_ns, lambda _now_ns: None)

    def _arrive_part(self, operator: Operator, data: bytes, now_ns: int) -> None:
        part = PARTS.from_bytes(data)
        self.under_way -= 1
        if operator is not self.operator or self.loses(now_ns):
            self.lost_bytes += len(part.data)
            return
        found = operator.fetching.receive(part, len(data), now_ns)
        self.lost_bytes += len(part.data) - len(found)
        operator.data += found
        self.progress.append((now_ns, operator.fetching.offset))
        if operator.fetching.is_complete and self.done_ns is None:
            self.done_ns = now_ns
        self._ask(now_ns)


LIVE = (
    Source(topic="/odom", size_bytes=720, rate_hz=25),
    Source(topic="/scan", size_bytes=2_940, rate_hz=5),
    Source(topic="/image", size_bytes=33_500, rate_hz=5),
)
"""0.2 MB/s."""
NEEDS = {"/odom": LinkNeeds(priority=3.0), "/scan": LinkNeeds(priority=2.0)}
GAP = (
    Recorded(topic="/odom", size_bytes=750, rate_hz=25),
    Recorded(topic="/scan", size_bytes=2_970, rate_hz=5),
)
SPARE_LINK = 250_000.0
"""Bytes/s of which LIVE leaves a fifth."""


def spare_link(delay_s: float = 0.02) -> Link:
    return Link(((0.0, SPARE_LINK),), delay_s)
