# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The parts of one session by datagrams: which arrived, which are lost, and what of these is sent again.

Losses are detected as QUIC does (RFC 9002, section 6): by time, once something that was sent later is known
to have arrived, or after so long that an acknowledgement must have come.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field

from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.link.protocol.chunks import (
    MOST_HEADER_BYTES,
    SESSION_OFFSETS,
    Acknowledgement,
    Chunk,
)
from smarttestudo.link.protocol.datagram_window import DatagramState, DatagramWindow
from smarttestudo.link.protocol.fates import Ends
from smarttestudo.link.protocol.outgoing_stream import (
    LossReason,
    OutgoingMessage,
    OutgoingStream,
    SentMessage,
)

DATAGRAM_BYTES = 1_168
"""The largest chunk that goes as a datagram: sealed, 1200 bytes, which every path takes (RFC 9000, 14)."""
PART_BYTES = DATAGRAM_BYTES - MOST_HEADER_BYTES
"""How much of a message a part has at most."""

_LATE_NS = 3 * NS_PER_S // 2
"""A message that was sent whole is given up after so long and four round trips, which no outage is."""
_UNDER_WAY_NS = NS_PER_S
"""For so long, and six round trips, what was given up may arrive all the same."""
_FIRST_TRIP_NS = 333 * NS_PER_MS
_LEAST_REORDERING_NS = 5 * NS_PER_MS
_REPORTS = 3
"""For how many periods of reports an acknowledgement may be late."""
_SHARE_SECONDS = 60


@dataclass(slots=True, eq=False)
class _Part:
    """A part that is under way, or lost, as it was sent once."""

    sent: SentMessage
    offset: int
    size_bytes: int
    sending: DatagramState

    @property
    def sent_ns(self) -> int:
        return self.sending.sent_ns


@dataclass(slots=True, eq=False)
class _Turns:
    """How far a stream is in the session.

    ``waiting`` are messages that arrive in order, from the first on that is not known to have arrived.
    """

    begun: SentMessage | None = None
    turns: int = 0
    in_order: int = 0
    newest_whole: int = -1
    newest_arrived: int = -1
    waiting: deque[SentMessage] = field(default_factory=deque)


class LossShare:
    """Parts, and pings, that were sent and lost in the last minute."""

    def __init__(self) -> None:
        self._seconds: deque[list[int]] = deque()

    def count(self, now_ns: int, *, sent: int = 0, lost: int = 0) -> None:
        second = now_ns // NS_PER_S
        if not self._seconds or self._seconds[-1][0] != second:
            self._seconds.append([second, 0, 0])
        self._seconds[-1][1] += sent
        self._seconds[-1][2] += lost

    def at(self, now_ns: int) -> float:
        """The share that was lost, from 0 to 1."""
        sent, lost = self._counts(now_ns)
        return min(lost / sent, 1.0) if sent else 0.0

    def is_above(self, share: float, now_ns: int) -> bool:
        """Whether a larger share was lost, and not one alone."""
        return self._counts(now_ns)[1] > 1 and self.at(now_ns) > share

    def _counts(self, now_ns: int) -> tuple[int, int]:
        while self._seconds and self._seconds[0][0] < now_ns // NS_PER_S - _SHARE_SECONDS:
            self._seconds.popleft()
        # What was found again may have been lost more than a minute ago.
        return sum(one[1] for one in self._seconds), max(sum(one[2] for one in self._seconds), 0)


class SentParts:
    """All that was sent in a session by datagrams and is not over. Bytes under way are those of ``window``.

    A message that has its place in order is sent again until it has arrived. Of others, one of a single part
    is given up once a newer one of its stream was sent, a larger one once a newer one has arrived, and each
    when it is too late; what of it was under way may still arrive for a while.
    """

    def __init__(self, window: DatagramWindow, share: LossShare, trip_ns: int | None) -> None:
        """``trip_ns`` is the round trip, as far as it is known."""
        self._window = window
        self._share = share
        # One that was measured in an outage is no reason to wait as long after it.
        self._trip_ns = _FIRST_TRIP_NS if trip_ns is None else min(trip_ns, 2 * _FIRST_TRIP_NS)
        self._parts: dict[int, _Part] = {}
        """Parts under way, by where they end in the session, in the order in which they were sent."""
        self._lost: dict[int, _Part] = {}
        """Parts that count as lost, which may arrive all the same."""
        self._open: dict[SentMessage, None] = {}
        self._given_up: deque[tuple[int, SentMessage]] = deque()
        self._turns: dict[OutgoingStream, _Turns] = {}
        self._received_bytes = 0
        self._heard_ns = 0
        """When the other end said last what it has."""
        self._end_bytes = 0
        self.wake_ns: int | None = None
        """When to look for losses though nothing happens; ``None`` while nothing is under way."""

    def begin(self, stream: OutgoingStream, message: OutgoingMessage, size_bytes: int) -> None:
        """Begin to send a message, which travels as so many bytes."""
        turns = self._turns.setdefault(stream, _Turns())
        is_in_order = message.is_kept or stream.video is not None
        before = turns.in_order if is_in_order or turns.waiting else 0
        parts = max(1, -(-size_bytes // PART_BYTES))
        sent = SentMessage(stream, message, turns.turns, before, is_in_order, parts)
        turns.turns += 1
        turns.begun = sent
        self._open[sent] = None
        if is_in_order:
            turns.in_order += 1
            turns.waiting.append(sent)

    def next_part(self, stream: OutgoingStream, session: int, now_ns: int) -> Chunk:
        """The part of a stream that goes next; there must be one."""
        if stream.repairs:
            sent = stream.repairs[0]
            offset = sent.missing.popleft()
            if not sent.missing:
                stream.repairs.popleft()
            sent.was_repaired = True
        else:
            begun = self._turns[stream].begun
            assert begun is not None
            sent, offset = begun, begun.message.offset
        message = sent.message
        assert message.encoded is not None
        data = message.encoded.data
        body = data[offset : offset + PART_BYTES]
        chunk = Chunk(
            session,
            self._end_bytes % SESSION_OFFSETS,
            stream.number,
            message.number,
            offset,
            len(data),
            message.offered_ns,
            now_ns,
            message.encoded.is_compressed,
            message.is_kept,
            body,
            sent.before,
            sent.is_in_order,
        )
        self._add(sent, offset, chunk.sent_bytes, now_ns)
        if sent.whole_ns is None and offset == message.offset:
            message.offset += len(body)
            if message.offset >= len(data):
                self._finish(sent, now_ns)
        return chunk

    def acknowledge(self, received: Acknowledgement, now_ns: int) -> Iterator[SentMessage]:
        """The messages that were delivered by what the other end has of the session."""
        if received.received_bytes > self._end_bytes:
            return
        self._heard_ns = now_ns
        found = _taken(self._lost, received)
        arrived = _taken(self._parts, received)
        self._window.found(sum(part.size_bytes for _, part in found))
        self._share.count(now_ns, lost=-len(found))
        newest = None
        # Each place was sent once: one that counted as lost tells, too, how long a round trip takes.
        end_bytes, part = max((*found[-1:], *arrived[-1:]), default=(0, None), key=lambda one: one[0])
        if part is not None and end_bytes > self._received_bytes:
            newest = part.sending
            self._trip_ns = now_ns - newest.sent_ns
        self._received_bytes = max(self._received_bytes, received.received_bytes)
        # What was passed by what arrived may be lost.
        self.wake_ns = now_ns
        size_bytes = sum(part.size_bytes for _, part in (*found, *arrived))
        self._window.arrived(size_bytes, newest, now_ns, self._behind_since_ns)
        for _, part in (*found, *arrived):
            sent = part.sent
            had_arrived = sent.has_arrived
            sent.arrived.add(part.offset)
            if sent.has_arrived and not had_arrived and not sent.is_over:
                yield from self._arrive(sent, now_ns)

    def lost(self, now_ns: int) -> list[SentMessage]:
        """The messages of which parts were found to be lost, and are to be sent again."""
        again: dict[SentMessage, None] = {}
        self.wake_ns = None
        for end_bytes, part in list(self._parts.items()):
            is_passed = end_bytes < self._received_bytes
            due_ns = part.sent_ns + (self._passed_ns if is_passed else self._timeout_ns)
            if due_ns > now_ns:
                self.wake_ns = due_ns if self.wake_ns is None else min(self.wake_ns, due_ns)
                if not is_passed:
                    break
                continue
            self._lost[end_bytes] = self._parts.pop(end_bytes)
            self._window.lose(part.size_bytes)
            self._share.count(now_ns, lost=1)
            if self._is_to_repair(part, now_ns):
                part.sent.missing.append(part.offset)
                again[part.sent] = None
        gone_ns = self._heard_ns - self._gone_ns
        while self._lost and (first := next(iter(self._lost.items())))[1].sent_ns < gone_ns:
            del self._lost[first[0]]
        if self._given_up and (due_ns := self._given_up[0][0]) > now_ns:
            self.wake_ns = due_ns if self.wake_ns is None else min(self.wake_ns, due_ns)
        return list(again)

    def gone(self) -> Iterator[SentMessage]:
        """The messages that were given up, and can arrive no more."""
        # In an outage it is not known what arrived before it.
        while self._given_up and self._given_up[0][0] <= self._heard_ns:
            _, sent = self._given_up.popleft()
            if not sent.is_over:
                self._end(sent)
                yield sent
        if not self._open:
            self._window.rest()

    def close(self, stream: OutgoingStream, now_ns: int) -> None:
        """Send nothing of a stream again."""
        turns = self._turns.pop(stream, None)
        if turns is None:
            return
        for sent in [one for one in self._open if one.stream is stream]:
            sent.message.is_kept = False
            self._give_up(sent, LossReason.LATE, now_ns)

    def keeps(self, stream: OutgoingStream) -> bool:
        """Whether something of a stream may be sent until it arrives."""
        turns = self._turns.get(stream)
        return turns is not None and any(sent.message.is_kept for sent in turns.waiting)

    @property
    def under_way(self) -> Iterator[tuple[Ends, OutgoingMessage]]:
        """Messages that were sent whole and are not known to be delivered, in their order."""
        for sent in self._open:
            if sent.whole_ns is not None:
                yield tuple(sent.ends.values()), sent.message

    @property
    def _behind_since_ns(self) -> int | None:
        """When the first part was sent of those behind the last that arrived; ``None`` without any."""
        behind = (
            part.sent_ns
            for parts in (self._lost, self._parts)
            for end_bytes, part in parts.items()
            if end_bytes > self._received_bytes
        )
        return min(behind, default=None)

    @property
    def _passed_ns(self) -> int:
        """After so long a part is lost that was sent before another which arrived."""
        return self._trip_ns + max(self._least_trip_ns // 4, _LEAST_REORDERING_NS)

    @property
    def _timeout_ns(self) -> int:
        """After so long an acknowledgement must have come."""
        return 3 * self._trip_ns // 2 + _REPORTS * self._window.acknowledge_period_ns

    @property
    def _gone_ns(self) -> int:
        return _UNDER_WAY_NS + 6 * self._trip_ns

    @property
    def _least_trip_ns(self) -> int:
        trip_ns = self._window.round_trip_ns
        return self._trip_ns if trip_ns is None else trip_ns

    def _add(self, sent: SentMessage, offset: int, size_bytes: int, now_ns: int) -> None:
        self._end_bytes += size_bytes
        sent.ends.setdefault(offset, []).append(self._end_bytes)
        self._parts[self._end_bytes] = _Part(
            sent, offset, size_bytes, self._window.sent_datagram(size_bytes, now_ns)
        )
        self._share.count(now_ns, sent=1)
        due_ns = now_ns + self._timeout_ns
        self.wake_ns = due_ns if self.wake_ns is None else min(self.wake_ns, due_ns)

    def _finish(self, sent: SentMessage, now_ns: int) -> None:
        turns = self._turns[sent.stream]
        sent.whole_ns = now_ns
        turns.begun = None
        turns.newest_whole = sent.turn

    def _arrive(self, sent: SentMessage, now_ns: int) -> Iterator[SentMessage]:
        sent.stream.repaired += sent.was_repaired
        turns = self._turns.get(sent.stream)
        if turns is None or not sent.is_in_order:
            self._end(sent)
            yield sent
        if turns is None:
            return
        turns.newest_arrived = max(turns.newest_arrived, sent.turn)
        while turns.waiting and turns.waiting[0].has_arrived:
            first = turns.waiting.popleft()
            self._end(first)
            yield first
        for other in list(sent.stream.repairs):
            if (why := self._why_not(other, now_ns)) is not None:
                self._give_up(other, why, now_ns)

    def _end(self, sent: SentMessage) -> None:
        sent.is_over = True
        sent.missing.clear()
        del self._open[sent]
        if sent in sent.stream.repairs:
            sent.stream.repairs.remove(sent)

    def _is_to_repair(self, part: _Part, now_ns: int) -> bool:
        sent = part.sent
        if sent.is_over or sent.given_up is not None or part.offset in sent.arrived:
            return False
        why = self._why_not(sent, now_ns)
        if why is not None:
            self._give_up(sent, why, now_ns)
        return why is None

    def _why_not(self, sent: SentMessage, now_ns: int) -> LossReason | None:
        """Why a message is not sent again; ``None`` while it is wanted."""
        if sent.is_in_order or sent.whole_ns is None:
            return None
        turns = self._turns[sent.stream]
        if sent.turn < (turns.newest_whole if sent.parts == 1 else turns.newest_arrived):
            return LossReason.REPLACED
        return LossReason.LATE if now_ns - sent.whole_ns > _LATE_NS + 4 * self._least_trip_ns else None

    def _give_up(self, sent: SentMessage, why: LossReason, now_ns: int) -> None:
        sent.given_up = why
        sent.missing.clear()
        if sent in sent.stream.repairs:
            sent.stream.repairs.remove(sent)
        self._given_up.append((now_ns + self._gone_ns, sent))


def _taken(parts: dict[int, _Part], received: Acknowledgement) -> list[tuple[int, _Part]]:
    """Take those parts out that were received, by where they end."""
    spans = iter(received.lost)
    span = next(spans, None)
    ends = []
    for end_bytes in sorted(parts):
        if end_bytes > received.received_bytes:
            break
        while span is not None and span.until_bytes < end_bytes:
            span = next(spans, None)
        if span is None or end_bytes <= span.after_bytes:
            ends.append(end_bytes)
    return [(end_bytes, parts.pop(end_bytes)) for end_bytes in ends]
