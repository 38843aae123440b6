# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Fetches of files over the simulated link, in virtual time, beside live topics or alone."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial

from link.protocol.simulated_link import Ends, Link, S, Source
from smarttestudo.domain.link import LinkNeeds
from smarttestudo.link.protocol.background import ANSWERED_WITHIN_NS
from smarttestudo.link.protocol.sender import LinkSender
from smarttestudo.link.transfer.fetching import Fetching, RangeAsk
from smarttestudo.link.transfer.messages import PIECES, TransferPiece, piece_from_bytes
from smarttestudo.link.transfer.order import (
    ByteRange,
    MessageRange,
    RangePart,
    TransferOrder,
)

FRAMING_BYTES = 100
"""What goes with a piece on the wire beside what it is."""


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

    def piece(self, cursor: int, size_bytes: int, advised_bytes: int, waiting: int) -> TransferPiece:
        """What the robot's end answers."""
        parts = tuple(self.order.parts(cursor, size_bytes))
        places = [(one.whole.file, one.whole.offset + one.skipped_bytes, one.size_bytes) for one in parts]
        body = b"".join(self.files[file][start : start + size] for file, start, size in places)
        return TransferPiece(parts=parts, body=body, advised_bytes=advised_bytes, waiting=waiting)


@dataclass(eq=False)
class Operator:
    """Who fetches; what is there of the files survives a restart, asks that are under way do not."""

    fetching: Fetching
    asker: int
    files: list[bytearray]
    under_way: set[int] = field(default_factory=set)


@dataclass
class FetchingEnds(Ends):
    """Both ends with a fetch from ``from_s`` on. ``loses`` says whether what arrives then is lost."""

    contents: Contents = field(default_factory=lambda: Contents.of((), 0))
    from_s: float = 0.0
    is_live: bool = True
    ends_when_done: bool = False
    loses: Callable[[int], bool] = lambda _now_ns: False
    sender: LinkSender[tuple[Operator, RangeAsk]] = field(default_factory=LinkSender)
    progress: list[tuple[int, int]] = field(default_factory=list)
    """When how many bytes of the order were there."""
    sent_bytes: int = 0
    lost_bytes: int = 0
    """Bytes of the order that left the robot, and those that did not arrive or came in vain."""
    done_ns: int | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        self.operator = self._operator(0)
        self._wake_ns = math.inf
        self.at(int(self.from_s * S), self._ask)

    def _operator(self, cursor: int) -> Operator:
        number = getattr(self, "operator", None)
        files = number.files if number else [bytearray(len(one)) for one in self.contents.files]
        fetching = Fetching(self.contents.order.size_bytes, cursor)
        return Operator(fetching, 1 if number is None else number.asker + 1, files)

    def is_over(self) -> bool:
        return self.ends_when_done and self.done_ns is not None

    def restart(self, now_ns: int) -> None:
        """The process of the operator is killed and begins again where it was."""
        # What came out of order was not written.
        self.lost_bytes += self.operator.fetching.waiting_bytes
        self.operator = self._operator(self.operator.fetching.cursor)
        self._ask(now_ns)

    def _report(self, now_ns: int) -> None:
        if self.is_live:
            super()._report(now_ns)

    def _ask(self, now_ns: int) -> None:
        operator = self.operator
        for ask in operator.fetching.asks(now_ns):
            operator.under_way.add(id(ask))
            self.at(now_ns + ANSWERED_WITHIN_NS, partial(self._give_up, operator, ask))
            if self.link.rate(now_ns) > 0 and not self.loses(now_ns):
                got_bytes = operator.fetching.got_bytes
                self.at(
                    now_ns + int(self.link.delay_s * S), partial(self._arrive_ask, operator, ask, got_bytes)
                )
        if operator.fetching.unsaid() and self.link.rate(now_ns) > 0:
            acknowledge = partial(self._acknowledge, operator.asker, operator.fetching.got_bytes)
            self.at(now_ns + int(self.link.delay_s * S), acknowledge)
        wake_ns = operator.fetching.wake_ns
        if wake_ns is not None and wake_ns > now_ns:
            self.at(wake_ns, self._ask)

    def _acknowledge(self, asker: int, got_bytes: int, now_ns: int) -> None:
        self.sender.scheduler.requests.acknowledge(asker, got_bytes, now_ns)

    def _arrive_ask(self, operator: Operator, ask: RangeAsk, got_bytes: int, now_ns: int) -> None:
        assert self.sender.scheduler.requests.enqueue(operator.asker, got_bytes, (operator, ask), now_ns)

    def _pump(self, now_ns: int) -> None:
        super()._pump(now_ns)
        self.sender.scheduler.requests.expired(now_ns)
        while (answer := self.sender.scheduler.next_grant(now_ns)) is not None:
            operator, ask = answer.request
            size_bytes = min(ask.size_bytes, answer.size_bytes)
            piece = self.contents.piece(ask.start, size_bytes, answer.size_bytes, answer.waiting)
            data = PIECES.to_bytes(piece)
            self.sender.scheduler.requests.sent(answer.client, len(data), now_ns)
            self.sent_bytes += piece.covered_bytes
            arrival_ns = self.link.arrival_ns(len(data) + FRAMING_BYTES, now_ns)
            self.at(arrival_ns, partial(self._arrive_piece, operator, ask, data))
            super()._pump(now_ns)
        wake_ns = self.sender.scheduler.requests.wake_ns(now_ns)
        if wake_ns is not None and not now_ns < self._wake_ns <= wake_ns:
            self._wake_ns = wake_ns
            self.at(wake_ns, lambda _now_ns: None)

    def _arrive_piece(self, operator: Operator, ask: RangeAsk, data: bytes, now_ns: int) -> None:
        piece = piece_from_bytes(data, ask.size_bytes)
        if operator is not self.operator or id(ask) not in operator.under_way or self.loses(now_ns):
            self.lost_bytes += piece.covered_bytes
            return
        operator.under_way.discard(id(ask))
        operator.fetching.answered(ask, piece, len(data), now_ns)
        for one in operator.fetching.pieces():
            for part, body in bodies(one):
                start = part.whole.offset + part.skipped_bytes
                operator.files[part.whole.file][start : start + part.size_bytes] = body
        self.progress.append((now_ns, operator.fetching.cursor))
        if operator.fetching.is_complete and self.done_ns is None:
            self.done_ns = now_ns
        self._ask(now_ns)

    def _give_up(self, operator: Operator, ask: RangeAsk, now_ns: int) -> None:
        if operator is self.operator and id(ask) in operator.under_way:
            operator.under_way.discard(id(ask))
            operator.fetching.answered(ask, None, 0, now_ns)
            self._ask(now_ns)


def bodies(piece: TransferPiece) -> Iterator[tuple[RangePart, bytes]]:
    """Each part with its bytes."""
    place = 0
    for part in piece.parts:
        yield part, piece.body[place : place + part.size_bytes]
        place += part.size_bytes


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
