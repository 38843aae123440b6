# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages that wait to be sent: the most important first, the newest of each."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable, Iterator
from dataclasses import replace

from smarttestudo.domain.link import LinkNeeds, MessageOrigin, MissedMessage
from smarttestudo.domain.link_state import StreamCounts
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.chunks import CONTROL_STREAM, NUMBERS, Chunk
from smarttestudo.link.protocol.outgoing_stream import Encode, OutgoingMessage, OutgoingStream

MAX_QUEUED_BYTES = 1_000_000
"""The size of the queue of a topic that is sent whole."""
PATIENCE_NS = NS_PER_S // 10
"""For how long none gives way to another after nothing waited: a link that carries all is late at times."""
MAX_PATIENT_BYTES = 16_000_000
"""The size of all messages of a stream that wait so."""
MAX_GIVEN_UP_BYTES = 16_000_000
"""The size of all messages kept that gave way, until something arrives; the oldest beyond it are missed."""
MAX_WAITING = 1024
"""How many messages of one stream may wait at once, those of a topic that is sent whole apart."""


class Outbox:
    """Streams with what waits in them. All messages of the control stream arrive.

    A message that has not begun is replaced by a newer one of its stream and lane, after ``PATIENCE_NS``; one
    that has begun is finished. Latched messages and those of topics that are sent whole queue instead, up to
    ``MAX_QUEUED_BYTES`` a stream; what overflows is counted, once there was a session.

    What gives way while nothing arrives at the other end is ``missed`` there, and so is what was under way
    and is not sent again.
    """

    def __init__(self, encode: Encode) -> None:
        self._encode = encode
        self._streams: dict[int, OutgoingStream] = {}
        self._active: dict[int, OutgoingStream] = {}
        self._had_session = False
        self._waits_since_ns = 0
        """Since when something waits."""
        self.missed: deque[MissedMessage] = deque()
        """Missed messages with an origin, to be taken from here."""
        self._given_up: deque[OutgoingMessage] = deque()
        self._given_up_bytes = 0
        self._is_cut = False
        self._waited_before_ns = 0
        self._sent_bytes = self._acknowledged_bytes = 0

    def open(self, stream: int, *, depth: int | None = None) -> None:
        """Have a stream; one with ``depth`` is latched and keeps so many messages for another session."""
        latched = None if depth is None else deque[OutgoingMessage](maxlen=depth)
        self._streams[stream] = OutgoingStream(stream, LinkNeeds(), latched)

    def end(self, stream: int) -> None:
        """Have a stream latch nothing any more; what waits in it is sent."""
        self._streams[stream].latched = None

    def is_drained(self, stream: int) -> bool:
        """Whether nothing of a stream is to be sent, or sent again; so it is before the first session."""
        one = self._streams[stream]
        return not self._had_session or not (one.has_work or any(each.is_kept for each in one.unacknowledged))

    def close(self, stream: int, now_ns: int) -> StreamCounts:
        """Forget a stream; returns its last counts, in which what waited has overflowed."""
        closed = self._streams.pop(stream)
        self._active.pop(stream, None)
        waiting = [*closed.waiting]
        closed.overflowed += len(waiting) if self._had_session else 0
        self._give_up(*waiting, *closed.unacknowledged)
        return replace(closed.counts(now_ns), queued_bytes=0, is_losing=False)

    def skip(self, stream: int) -> None:
        """Leave out a number, so that the next message does not follow on the last one."""
        open_stream = self._streams[stream]
        open_stream.next_number = (open_stream.next_number + 1) % NUMBERS

    def set_needs(self, stream: int, needs: LinkNeeds) -> None:
        """Serve a stream so from now on."""
        self._streams[stream].needs = needs

    def put(
        self,
        stream: int,
        payload: bytes,
        now_ns: int,
        lane: Hashable = None,
        origin: MessageOrigin | None = None,
    ) -> None:
        """Have a message sent. It replaces only messages of its ``lane``."""
        if not self._active:
            self._waits_since_ns = now_ns
        open_stream = self._streams[stream]
        number, open_stream.next_number = open_stream.next_number, (open_stream.next_number + 1) % NUMBERS
        is_kept = open_stream.latched is not None or stream == CONTROL_STREAM or open_stream.needs.is_full
        message = OutgoingMessage(number, payload, now_ns, is_kept, lane, origin)
        if open_stream.latched is not None:
            open_stream.latched.append(message)
        is_patient = self._had_session and not self._is_cut and now_ns - self._waits_since_ns <= PATIENCE_NS
        if is_kept:
            self._queue(open_stream, message, MAX_PATIENT_BYTES if is_patient else MAX_QUEUED_BYTES)
        else:
            self._replace(open_stream, message, is_patient=is_patient)
        if open_stream.has_work:
            self._active[stream] = open_stream

    @property
    def is_empty(self) -> bool:
        """Whether nothing waits."""
        return not self._active

    def next_chunk(self, session: int, body_bytes: int, now_ns: int) -> Chunk | None:
        """The chunk that goes next, with at most ``body_bytes`` of its message."""
        if not self._active:
            return None
        stream = self._first(now_ns)
        message = stream.begun or stream.begin(now_ns)
        if message.encoded is None:
            message.encoded = self._encode(stream.number, message.payload)
        data = message.encoded.data
        body = data[message.offset : message.offset + body_bytes]
        chunk = Chunk(
            session,
            stream.number,
            message.number,
            message.offset,
            len(data),
            message.offered_ns,
            now_ns,
            message.encoded.is_compressed,
            message.is_kept,
            body,
        )
        message.offset += len(body)
        message.sent_ns = now_ns
        if message.offset >= len(data):
            self._finish(stream, message)
        return chunk

    def sent_until(self, chunk: Chunk, total_bytes: int) -> None:
        """``chunk`` was sent, and with it ``total_bytes`` of the session."""
        self._sent_bytes = total_bytes
        stream = self._streams.get(chunk.stream)
        if stream is not None and stream.unacknowledged and stream.unacknowledged[-1].number == chunk.number:
            stream.unacknowledged[-1].sent_total = total_bytes

    def acknowledge(self, total_bytes: int, dropped_before_ns: int | None = None) -> None:
        """The other end has ``total_bytes`` of the session.

        It dropped those that were sent before ``dropped_before_ns``, unless they are kept.
        """
        for stream in self._streams.values():
            while stream.unacknowledged and 0 < stream.unacknowledged[0].sent_total <= total_bytes:
                message = stream.unacknowledged.popleft()
                is_dropped = dropped_before_ns is not None and message.sent_ns < dropped_before_ns
                if is_dropped and not message.is_kept:
                    self._miss(message)
        if self._acknowledged_bytes < total_bytes or total_bytes == self._sent_bytes:
            self._acknowledged_bytes, self._is_cut = total_bytes, False
            self._given_up.clear()
            self._given_up_bytes = 0

    def cut(self) -> None:
        """Count as missed what gave way since the last acknowledgement, and what does until the next."""
        if self._had_session:
            self._is_cut = True
            self._miss_given_up()

    def give_up_all(self) -> None:
        """Nothing is sent any more."""
        for stream in self._streams.values():
            self._give_up(*stream.waiting, *stream.unacknowledged)

    def restart(self, now_ns: int) -> None:
        """Another session begins: latched messages go again, and kept ones that may not have arrived."""
        self._miss_given_up()
        # What waited in the outage, and gives way because so much did, was missed as well.
        self._waited_before_ns = now_ns if self._had_session else 0
        self._had_session, self._is_cut = True, False
        self._sent_bytes = self._acknowledged_bytes = 0
        for stream in self._streams.values():
            self._restart(stream)
            if stream.has_work:
                self._active[stream.number] = stream

    def send_latched_again(self) -> None:
        """Have latched messages go once more, for an end that may lack them."""
        for stream in self._streams.values():
            stream.queue_latched_again()
            if stream.has_work:
                self._active[stream.number] = stream

    def counts(self, now_ns: int) -> Iterator[tuple[int, StreamCounts]]:
        """The counts of each stream."""
        for number, stream in self._streams.items():
            yield number, stream.counts(now_ns)

    def _first(self, now_ns: int) -> OutgoingStream:
        """The stream that goes before the others."""
        if len(self._active) == 1:
            return next(iter(self._active.values()))
        return min(self._active.values(), key=lambda each: _rank(each, now_ns))

    def _queue(self, stream: OutgoingStream, message: OutgoingMessage, most_bytes: int) -> None:
        may_overflow = stream.number != CONTROL_STREAM
        while may_overflow and stream.queue and stream.queued_bytes + len(message.payload) > most_bytes:
            # As in a DDS history with KEEP_LAST.
            oldest = stream.queue.popleft()
            stream.queued_bytes -= len(oldest.payload)
            self._give_up(oldest)
            if self._had_session:
                stream.overflowed += 1
                stream.overflowed_ns = message.offered_ns
        stream.queue.append(message)
        stream.queued_bytes += len(message.payload)

    def _replace(self, stream: OutgoingStream, message: OutgoingMessage, *, is_patient: bool) -> None:
        if not is_patient or stream.slots_bytes + len(message.payload) > MAX_PATIENT_BYTES:
            for number in tuple(stream.lanes.get(message.lane, ())):
                self._give_way(stream, number)
        if len(stream.slots) >= MAX_WAITING:
            self._give_way(stream, next(iter(stream.slots)))
        stream.put_slot(message)

    def _give_way(self, stream: OutgoingStream, number: int) -> None:
        stream.replaced += 1
        self._give_up(stream.take_slot(number))

    def _finish(self, stream: OutgoingStream, message: OutgoingMessage) -> None:
        stream.begun, stream.is_floor_begun = None, False
        stream.sent += 1
        if message.is_kept or message.origin is not None:
            stream.unacknowledged.append(message)
        if not stream.has_work:
            del self._active[stream.number]

    def _restart(self, stream: OutgoingStream) -> None:
        begun, stream.begun, stream.is_floor_begun = stream.begun, None, False
        again = [message for message in stream.unacknowledged if message.is_kept]
        self._miss(*(message for message in stream.unacknowledged if not message.is_kept))
        stream.unacknowledged.clear()
        if begun is not None and begun.is_kept:
            again.append(begun)
        elif begun is not None and begun.lane in stream.lanes:
            stream.replaced += 1
            self._miss(begun)
        elif begun is not None:
            waiting, stream.slots = stream.slots, {}
            stream.put_slot(begun)
            stream.slots |= waiting
        for lane in list(stream.lanes.values()):
            for number in list(lane)[:-1]:
                self._give_way(stream, number)
        if stream.latched is not None:
            self._miss(*(one for one in (*again, *stream.queue) if one not in stream.latched))
            again, stream.queue, stream.queued_bytes = list(stream.latched), deque(), 0
        for message in reversed(again):
            stream.queue.appendleft(message)
            stream.queued_bytes += len(message.payload)
        for message in (*stream.queue, *stream.slots.values()):
            message.offset = message.sent_total = 0

    def _give_up(self, *messages: OutgoingMessage) -> None:
        """These are not sent, or not known to arrive."""
        for message in messages:
            if message.origin is None or not self._had_session:
                continue
            if self._is_cut or message.offered_ns < self._waited_before_ns:
                self._miss(message)
                continue
            self._given_up.append(message)
            self._given_up_bytes += len(message.payload)
        self._miss_given_up(MAX_GIVEN_UP_BYTES)

    def _miss_given_up(self, most_bytes: int = -1) -> None:
        """The oldest beyond so many bytes were missed, or all."""
        while self._given_up and self._given_up_bytes > most_bytes:
            message = self._given_up.popleft()
            self._given_up_bytes -= len(message.payload)
            self._miss(message)

    def _miss(self, *messages: OutgoingMessage) -> None:
        for message in messages:
            if message.origin is not None:
                self.missed.append(MissedMessage(origin=message.origin, payload=message.payload))


def _rank(stream: OutgoingStream, now_ns: int) -> tuple[bool, bool, float, int]:
    """The order in which streams are served, the least first. Streams are announced before their messages."""
    is_control = stream.number == CONTROL_STREAM
    return not is_control, not stream.is_urgent(now_ns), -stream.needs.priority, stream.oldest_ns
