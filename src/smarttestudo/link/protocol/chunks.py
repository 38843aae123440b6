# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages cut into chunks and put together again, and how much of each session arrived."""

from __future__ import annotations

import struct
from bisect import bisect
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.wire import HEAD_BYTES, Kind, frame, kind_of, malformed

MAX_MESSAGE_BYTES = 64 * 1024 * 1024
MAX_STREAMS = 4096
MAX_PARTIAL_BYTES = 4 * MAX_MESSAGE_BYTES
"""The size of all unfinished messages together."""
NUMBERS = 2**32
"""After so many messages of a stream, their numbers begin again."""
SESSION_OFFSETS = 2**32
"""After so many bytes of a session, their offsets begin again."""
CONTROL_STREAM = 0
"""The stream in which the robot's end says what the others are."""

# stream and flags, session, offset in the session, number, offset, size, offered_ns, sent_ns
_HEADER = struct.Struct(f"<{HEAD_BYTES}sHIIIIIqq")
HEADER_BYTES = _HEADER.size
_FRAME = frame(Kind.CHUNK, b"")
_PLACE = struct.Struct("<I")
MOST_HEADER_BYTES = HEADER_BYTES + _PLACE.size
_COMPRESSED = MAX_STREAMS
_KEPT = 2 * MAX_STREAMS
_PLACED = 4 * MAX_STREAMS
_IN_ORDER = 8 * MAX_STREAMS


class Chunk(NamedTuple):
    """A part of a message: ``body`` stands at ``offset`` of the ``size_bytes`` that travel.

    ``session`` counts the connections of the robot's end, ``session_offset`` the bytes that were sent of it
    before, modulo ``SESSION_OFFSETS``, and ``number`` the messages of the stream. The times are the robot's
    clock: when the loop relayed the message, and when the chunk was sent. A message that ``is_kept`` is never
    too old to be delivered.

    In a session by datagrams, ``before`` messages of the stream that arrive in order are delivered before
    this one, which may be one of them (``is_in_order``).
    """

    session: int
    session_offset: int
    stream: int
    number: int
    offset: int
    size_bytes: int
    offered_ns: int
    sent_ns: int
    is_compressed: bool
    is_kept: bool
    body: bytes
    before: int = 0
    is_in_order: bool = False

    def to_bytes(self) -> bytes:
        flags = _COMPRESSED * self.is_compressed | _KEPT * self.is_kept | _IN_ORDER * self.is_in_order
        is_placed = self.is_in_order or self.before > 0
        head = _HEADER.pack(
            _FRAME,
            self.stream | flags | _PLACED * is_placed,
            self.session,
            self.session_offset,
            self.number,
            self.offset,
            self.size_bytes,
            self.offered_ns,
            self.sent_ns,
        )
        # One copy of a body that may be large.
        return head + _PLACE.pack(self.before) + self.body if is_placed else head + self.body

    @staticmethod
    def from_bytes(data: bytes) -> Chunk:
        """The chunk that ``to_bytes`` gave ``data`` for. Raises ``LinkError`` for anything else."""
        if not data.startswith(_FRAME) or len(data) < HEADER_BYTES:
            kind_of(data)
            raise malformed("no chunk")
        _, flags, session, session_offset, number, offset, size_bytes, offered_ns, sent_ns = (
            _HEADER.unpack_from(data)
        )
        before = 0
        if flags >= _PLACED:
            if not flags & _PLACED or len(data) < MOST_HEADER_BYTES:
                raise malformed("a chunk without its place")
            (before,) = _PLACE.unpack_from(data, HEADER_BYTES)
            body = data[MOST_HEADER_BYTES:]
        else:
            body = data[HEADER_BYTES:]
        if size_bytes > MAX_MESSAGE_BYTES or offset + len(body) > size_bytes:
            raise malformed("a chunk that reaches beyond its message")
        return Chunk(
            session,
            session_offset,
            flags % MAX_STREAMS,
            number,
            offset,
            size_bytes,
            offered_ns,
            sent_ns,
            bool(flags & _COMPRESSED),
            bool(flags & _KEPT),
            body,
            before,
            bool(flags & _IN_ORDER),
        )

    @property
    def sent_bytes(self) -> int:
        """How many bytes ``to_bytes`` gives."""
        is_placed = self.is_in_order or self.before > 0
        return (MOST_HEADER_BYTES if is_placed else HEADER_BYTES) + len(self.body)

    @property
    def is_last(self) -> bool:
        return self.offset + len(self.body) == self.size_bytes


@dataclass(slots=True)
class _Partial:
    """A message of which not all has arrived."""

    number: int
    size_bytes: int
    data: bytearray


class Reassembler:
    """Puts the messages of one session together; each stream has at most one unfinished message.

    Chunks of a stream come in order. A chunk that does not continue its message costs that message, and is
    counted in ``broken``.
    """

    def __init__(self) -> None:
        self.broken = 0
        self._partials: dict[int, _Partial] = {}
        self._bytes = 0

    def add(self, chunk: Chunk) -> bytes | None:
        """The message that ends with ``chunk``; ``None`` while more is to come, or if it does not fit."""
        partial = self._partials.get(chunk.stream)
        if chunk.offset == 0:
            if partial is not None:
                self._drop(chunk.stream)
            if len(chunk.body) == chunk.size_bytes:
                return chunk.body
            if self._bytes + chunk.size_bytes > MAX_PARTIAL_BYTES:
                self.broken += 1
                return None
            partial = self._partials[chunk.stream] = _Partial(chunk.number, chunk.size_bytes, bytearray())
            self._bytes += chunk.size_bytes
        elif partial is None:
            # Its beginning was sent in an earlier session, or was refused and counted then.
            return None
        expected = (partial.number, partial.size_bytes, len(partial.data))
        if (chunk.number, chunk.size_bytes, chunk.offset) != expected or not chunk.body:
            self._drop(chunk.stream)
            return None
        partial.data += chunk.body
        if len(partial.data) < partial.size_bytes:
            return None
        self._forget(chunk.stream)
        return bytes(partial.data)

    def _drop(self, stream: int) -> None:
        self.broken += 1
        self._forget(stream)

    def _forget(self, stream: int) -> None:
        self._bytes -= self._partials.pop(stream).size_bytes


MAX_LOST_SPANS = 16
"""How many spans of one session are told apart; of more, the first two become one."""
MAX_DATAGRAM_SPANS = 64
"""The same of one by datagrams, of which a radio loses many."""
MAX_ENDED = 8
"""Of how many sessions before the newest it is told what arrived."""
ENDED_TOLD_NS = 20 * NS_PER_S
"""For how long that is told; the robot's end sends nothing for so long that is not acknowledged."""


class LostSpan(NamedTuple):
    """Messages that are lost: those whose last chunk ends after ``after_bytes`` and up to ``until_bytes``."""

    after_bytes: int
    until_bytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Acknowledgement:
    """The chunks of a session that arrived: those up to ``received_bytes``.

    Messages in ``lost`` came too late to be delivered. Where it ``is_cut``, the next chunks are missing, and
    none is taken that follows on them. ``session`` is 0 where there is none.
    """

    session: int
    received_bytes: int
    lost: Sequence[LostSpan] = ()
    is_cut: bool = False

    def has(self, end_bytes: int) -> bool:
        """Whether the message arrived whose last chunk ends there."""
        return end_bytes <= self.received_bytes and not any(
            span.after_bytes < end_bytes <= span.until_bytes for span in self.lost
        )


NOTHING_RECEIVED = Acknowledgement(session=0, received_bytes=0)
"""The state before the first session."""


class ReceivedSessions:
    """Keeps of the chunks that arrive what is to be acknowledged."""

    def __init__(self) -> None:
        self.session = 0
        """The newest session; 0 before the first."""
        self.received_bytes = 0
        """Up to where its chunks arrived."""
        self._begin_bytes = 0
        self._lost: list[LostSpan] = []
        self._is_cut = False
        self._most_spans = MAX_LOST_SPANS
        self._ended: deque[tuple[int, Acknowledgement]] = deque(maxlen=MAX_ENDED)
        """The sessions before it, each with when the first chunk after it was sent."""

    def on_chunk(self, chunk: Chunk, size_bytes: int) -> bool:
        """Take a chunk of so many bytes; whether it follows on the last one, or begins a session."""
        if chunk.session < self.session:
            return False
        if chunk.session > self.session:
            comes_late = not self.session and chunk.session_offset > 0
            self._begin(chunk)
            if comes_late:
                # Whoever has heard nothing yet lacks what the session had before.
                self.received_bytes = chunk.session_offset
                self._lost.append(LostSpan(0, chunk.session_offset))
        while self._ended and chunk.sent_ns - self._ended[0][0] > ENDED_TOLD_NS:
            self._ended.popleft()
        ahead_bytes = (chunk.session_offset - self.received_bytes) % SESSION_OFFSETS
        self._is_cut |= 0 < ahead_bytes < SESSION_OFFSETS // 2
        if ahead_bytes or self._is_cut:
            return False
        self._begin_bytes = self.received_bytes
        self.received_bytes += size_bytes
        return True

    def on_datagram(self, chunk: Chunk, size_bytes: int) -> LostSpan | None:
        """Take a chunk that may come before or after others, or again; its span, if it is a new one."""
        if chunk.session < self.session:
            return None
        if chunk.session > self.session:
            self._begin(chunk)
            self._most_spans = MAX_DATAGRAM_SPANS
        ahead_bytes = (chunk.session_offset - self.received_bytes) % SESSION_OFFSETS
        if ahead_bytes >= SESSION_OFFSETS // 2:
            ahead_bytes -= SESSION_OFFSETS
        begin_bytes = self.received_bytes + ahead_bytes
        span = LostSpan(begin_bytes, begin_bytes + size_bytes)
        if ahead_bytes < 0:
            return span if self._fill(span) else None
        if ahead_bytes:
            self._lost.append(LostSpan(self.received_bytes, begin_bytes))
            self._merge_lost()
        self.received_bytes = span.until_bytes
        return span

    def refuse(self, span: LostSpan) -> None:
        """Count a chunk that came there as lost after all."""
        at = bisect(self._lost, span)
        before, behind = self._lost[:at], self._lost[at:]
        if before and before[-1].until_bytes >= span.after_bytes:
            span = LostSpan(before[-1].after_bytes, max(before.pop().until_bytes, span.until_bytes))
        if behind and behind[0].after_bytes <= span.until_bytes:
            span = LostSpan(span.after_bytes, max(behind.pop(0).until_bytes, span.until_bytes))
        self._lost = [*before, span, *behind]
        self._merge_lost()

    def _fill(self, span: LostSpan) -> bool:
        """Whether all of ``span`` was lost; it is no more."""
        for at, lost in enumerate(self._lost):
            if lost.after_bytes <= span.after_bytes and span.until_bytes <= lost.until_bytes:
                parts = (
                    LostSpan(lost.after_bytes, span.after_bytes),
                    LostSpan(span.until_bytes, lost.until_bytes),
                )
                self._lost[at : at + 1] = [part for part in parts if part.after_bytes < part.until_bytes]
                self._merge_lost()
                return True
        return False

    def lack(self) -> None:
        """The message that ends with the last chunk is lost."""
        span = LostSpan(self._begin_bytes, self.received_bytes)
        if self._lost and self._lost[-1].until_bytes == span.after_bytes:
            span = LostSpan(self._lost.pop().after_bytes, span.until_bytes)
        self._lost.append(span)
        self._merge_lost()

    def _merge_lost(self) -> None:
        while len(self._lost) > self._most_spans:
            # What arrived between them is rather kept by the robot as well than nowhere.
            first, second = self._lost[:2]
            self._lost[:2] = [LostSpan(first.after_bytes, second.until_bytes)]

    @property
    def newest(self) -> Acknowledgement:
        """The acknowledgement of the newest session."""
        return Acknowledgement(
            session=self.session,
            received_bytes=self.received_bytes,
            lost=tuple(self._lost),
            is_cut=self._is_cut,
        )

    @property
    def ended(self) -> tuple[Acknowledgement, ...]:
        """The acknowledgements of the sessions before it, the oldest first."""
        return tuple([session for _, session in self._ended])

    def _begin(self, chunk: Chunk) -> None:
        if self.session:
            self._ended.append((chunk.sent_ns, self.newest))
        self.session, self.received_bytes, self._lost, self._is_cut = chunk.session, 0, [], False
        self._most_spans = MAX_LOST_SPANS
