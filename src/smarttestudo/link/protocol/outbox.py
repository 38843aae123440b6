# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages that wait to be sent: the most important first, the newest of each."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable, Iterator
from dataclasses import replace

from smarttestudo.domain.link import LinkNeeds, MessageOrigin, StreamCounts
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.chunks import (
    CONTROL_STREAM,
    HEADER_BYTES,
    NUMBERS,
    SESSION_OFFSETS,
    Acknowledgement,
    Chunk,
)
from smarttestudo.link.protocol.fates import Ends, Fates
from smarttestudo.link.protocol.outgoing_stream import Encode, OutgoingMessage, OutgoingStream, SentMessage
from smarttestudo.link.protocol.repair import PART_BYTES, SentParts
from smarttestudo.pacing.coded_video import VideoFrame, VideoGroup

MAX_QUEUED_BYTES = 1_000_000
"""The size of the queue of a topic that is sent whole."""
PATIENCE_NS = NS_PER_S // 10
"""For how long none gives way to another after nothing waited: a link that carries all is late at times."""
MAX_PATIENT_BYTES = 16_000_000
"""The size of all messages of a stream that wait so."""
VIDEO_PATIENCE_NS = NS_PER_S // 2
"""For how long a frame of coded video waits until its group ends with the last one before the next."""
MAX_WAITING = 1024
"""How many messages of one stream may wait at once, those of a topic that is sent whole apart."""


class Outbox:
    """Streams with what waits in them. All messages of the control stream arrive.

    A message that has not begun is replaced by a newer one of its stream and lane, after ``PATIENCE_NS``; one
    that has begun is finished. Latched messages and those of topics that are sent whole queue instead, up to
    ``MAX_QUEUED_BYTES`` a stream; what overflows is counted, once there was a session.

    Of coded video a key frame replaces all that waits. Other frames wait behind each other; where one would
    wait too long or overflow, it and the others of its group give way, and those before it are sent.
    What becomes of messages that are not sent is in ``fates``.
    """

    def __init__(self, encode: Encode) -> None:
        self._encode = encode
        self._streams: dict[int, OutgoingStream] = {}
        self._active: dict[int, OutgoingStream] = {}
        self.fates = Fates()
        self._waits_since_ns = 0
        """Since when something waits."""
        self._parts: SentParts | None = None
        """What was sent in a session by datagrams."""
        self._under_way: deque[tuple[int, OutgoingMessage]] = deque()
        """Messages that were sent whole, and are kept or have an origin, each after where it ended."""
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
        ending = self._streams[stream]
        return not self.fates.had_session or not (
            ending.has_work
            or (self._parts is not None and self._parts.keeps(ending))
            or any(sent.stream == stream and sent.is_kept for _, sent in self._under_way)
        )

    def close(self, stream: int, now_ns: int) -> StreamCounts:
        """Forget a stream; returns its last counts, in which what waited has overflowed."""
        closed = self._streams.pop(stream)
        self._active.pop(stream, None)
        waiting = [*closed.waiting]
        closed.overflowed += len(waiting) if self.fates.had_session else 0
        self.fates.give_up(*waiting)
        for _, message in self._under_way:
            # It arrives, or is lost.
            message.is_kept &= message.stream != stream
        if self._parts is not None:
            self._parts.close(closed, now_ns)
        return replace(closed.counts(now_ns), queued_bytes=0, is_losing=False)

    def skip(self, stream: int) -> None:
        """Leave out a number, so that the next message does not follow on the last one."""
        open_stream = self._streams[stream]
        open_stream.next_number = (open_stream.next_number + 1) % NUMBERS

    def set_needs(self, stream: int, needs: LinkNeeds) -> None:
        self._streams[stream].needs = needs

    def put(
        self,
        stream: int,
        payload: bytes,
        now_ns: int,
        lane: Hashable = None,
        origin: MessageOrigin | None = None,
        *,
        frame: VideoFrame | None = None,
        about: int | None = None,
    ) -> None:
        """Have a message sent. It replaces only messages of its ``lane``; it may be a ``frame`` of video.

        In a session by datagrams, a stream that it is ``about`` waits until it has arrived.
        """
        if not self._active:
            self._waits_since_ns = now_ns
        open_stream = self._streams[stream]
        number, open_stream.next_number = open_stream.next_number, (open_stream.next_number + 1) % NUMBERS
        is_kept = open_stream.latched is not None or stream == CONTROL_STREAM or open_stream.needs.is_full
        message = OutgoingMessage(stream, number, payload, now_ns, is_kept, lane, origin)
        if open_stream.latched is not None:
            open_stream.latched.append(message)
        waits_ns = now_ns - self._waits_since_ns
        is_patient = self.fates.had_session and not self.fates.is_cut and waits_ns <= PATIENCE_NS
        most_bytes = MAX_PATIENT_BYTES if is_patient else MAX_QUEUED_BYTES
        if frame is not None or open_stream.video is not None:
            self._put_frame(open_stream, message, frame, most_bytes)
        elif is_kept:
            self._queue(open_stream, message, most_bytes)
        else:
            self._replace(open_stream, message, is_patient=is_patient)
        self._activate(open_stream)
        if self._parts is not None and about in self._streams:
            self._streams[about].announcement = message
            self._active.pop(about, None)

    @property
    def is_empty(self) -> bool:
        return not self._active

    def is_next_small(self, now_ns: int) -> bool:
        """Whether what goes next in a session by datagrams ends a message; something must wait."""
        return self._first(now_ns).next_message.rest_bytes <= PART_BYTES

    def next_chunk(self, session: int, body_bytes: int, now_ns: int) -> Chunk | None:
        """The chunk that goes next, with at most ``body_bytes`` of its message."""
        if not self._active:
            return None
        stream = self._first(now_ns)
        if self._parts is not None:
            return self._next_part(self._parts, stream, session, now_ns)
        message = stream.begun or stream.begin(now_ns)
        if message.encoded is None:
            message.encoded = self._encode(stream.number, message.payload)
        data = message.encoded.data
        body = data[message.offset : message.offset + body_bytes]
        chunk = Chunk(
            session,
            self._sent_bytes % SESSION_OFFSETS,
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
        self._sent_bytes += HEADER_BYTES + len(body)
        stream.sent_bytes += HEADER_BYTES + len(body)
        if message.offset >= len(data):
            self._finish(stream, message)
        return chunk

    def acknowledge(self, received: Acknowledgement, now_ns: int) -> None:
        """The other end has so much of the session."""
        if self._parts is not None:
            for sent in self._parts.acknowledge(received, now_ns):
                self._deliver(sent)
            self._rest_idle()
            return
        total_bytes = received.received_bytes
        while self._under_way and self._under_way[0][0] <= total_bytes:
            end_bytes, message = self._under_way.popleft()
            # A message that is kept is lost only as the session ends.
            if message.is_kept or received.has(end_bytes):
                message.origin = None
            else:
                self.fates.miss(message)
        if self._acknowledged_bytes < total_bytes or total_bytes == self._sent_bytes:
            self._acknowledged_bytes = total_bytes
            self.fates.on_arrival()

    def give_up_all(self) -> None:
        for stream in self._streams.values():
            self.fates.give_up(*stream.waiting)
        self.fates.give_up(*(message for _, message in self._all_under_way()))

    def restart(self, ended: int, now_ns: int, parts: SentParts | None = None) -> None:
        """Session ``ended`` is over: latched messages go again, and kept ones that may not have arrived.

        ``parts`` takes what is sent in the next one, if that goes by datagrams.
        """
        under_way = self._all_under_way()
        again: dict[int, list[OutgoingMessage]] = {}
        for _, message in under_way:
            if message.is_kept:
                again.setdefault(message.stream, []).append(message)
        self.fates.end_session(ended, under_way, now_ns)
        self._under_way.clear()
        self._parts = parts
        self._sent_bytes = self._acknowledged_bytes = 0
        for stream in self._streams.values():
            self._restart(stream, again.get(stream.number, []))
        self._active = {number: stream for number, stream in self._streams.items() if stream.has_work}

    def send_latched_again(self) -> None:
        """Have latched messages go once more, for an end that may lack them."""
        under_way = [message for _, message in self._under_way]
        for stream in self._streams.values():
            stream.queue_latched_again(under_way)
            self._activate(stream)

    def look_for_losses(self, now_ns: int) -> None:
        """Have parts sent again that are lost by now, where their messages are wanted."""
        parts = self._parts
        if parts is None or parts.wake_ns is None or parts.wake_ns > now_ns:
            return
        for sent in parts.lost(now_ns):
            sent.stream.repair(sent)
            self._activate(sent.stream)
        for sent in parts.gone():
            sent.stream.lose(sent)
            self.fates.give_up(sent.message)
        self._rest_idle()

    @property
    def wake_ns(self) -> int | None:
        """When to look for losses though nothing happens."""
        return None if self._parts is None else self._parts.wake_ns

    def counts(self, now_ns: int) -> Iterator[tuple[int, StreamCounts]]:
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
            self._overflow(stream, stream.take_queued(), message.offered_ns)
        stream.put_queued(message)

    def _replace(self, stream: OutgoingStream, message: OutgoingMessage, *, is_patient: bool) -> None:
        if not is_patient or stream.slots_bytes + len(message.payload) > MAX_PATIENT_BYTES:
            for number in tuple(stream.lanes.get(message.lane, ())):
                self._give_way(stream, number)
        if len(stream.slots) >= MAX_WAITING:
            self._give_way(stream, next(iter(stream.slots)))
        stream.put_slot(message)

    def _put_frame(
        self, stream: OutgoingStream, message: OutgoingMessage, frame: VideoFrame | None, most_bytes: int
    ) -> None:
        group = stream.video = stream.video or VideoGroup()
        message.begins_group = group.take(frame)
        waiting = stream.queue if message.is_kept else stream.slots.values()
        waiting_bytes = stream.queued_bytes if message.is_kept else stream.slots_bytes
        is_over = bool(waiting) and (
            waiting_bytes + len(message.payload) > most_bytes or len(waiting) >= MAX_WAITING
        )
        if group.is_known and not message.begins_group:
            is_late = (
                bool(waiting) and message.offered_ns - stream.next_waiting.offered_ns > VIDEO_PATIENCE_NS
            )
            group.is_broken |= is_over or (is_late and not message.is_kept)
            if group.is_broken:
                self._leave_out(stream, message)
                return
        elif is_over or (not message.is_kept and most_bytes < MAX_PATIENT_BYTES):
            for one in tuple(waiting):
                self._leave_out(stream, stream.take_queued() if one.is_kept else stream.take_slot(one.number))
        if message.is_kept:
            stream.put_queued(message)
        else:
            stream.put_slot(message)

    def _leave_out(self, stream: OutgoingStream, message: OutgoingMessage) -> None:
        if message.is_kept:
            self._overflow(stream, message, message.offered_ns)
        else:
            stream.replaced += 1
            self.fates.give_up(message)

    def _overflow(self, stream: OutgoingStream, message: OutgoingMessage, now_ns: int) -> None:
        self.fates.give_up(message)
        if self.fates.had_session:
            stream.overflowed += 1
            stream.overflowed_ns = now_ns

    def _give_way(self, stream: OutgoingStream, number: int) -> None:
        stream.replaced += 1
        self.fates.give_up(stream.take_slot(number))

    def _next_part(self, parts: SentParts, stream: OutgoingStream, session: int, now_ns: int) -> Chunk:
        begun, is_repair = stream.begun, bool(stream.repairs)
        if not is_repair and begun is None:
            begun = stream.begin(now_ns)
            begun.encoded = begun.encoded or self._encode(stream.number, begun.payload)
            parts.begin(stream, begun, len(begun.encoded.data))
        chunk = parts.next_part(stream, session, now_ns)
        stream.sent_bytes += chunk.sent_bytes
        stream.repair_bytes += chunk.sent_bytes if is_repair else 0
        if begun is not None and begun.offset >= chunk.size_bytes and begun.number == chunk.number:
            stream.begun, stream.is_floor_begun = None, False
            stream.sent += 1
        if not stream.has_work:
            del self._active[stream.number]
        return chunk

    def _deliver(self, sent: SentMessage) -> None:
        """A message was delivered: what waits for it may be sent, and it is not missed."""
        sent.message.origin = None
        self.fates.on_arrival()
        if sent.stream.number == CONTROL_STREAM:
            for stream in self._streams.values():
                if stream.announcement is sent.message:
                    stream.announcement = None
                    self._activate(stream)

    def _rest_idle(self) -> None:
        """Serve no stream of which all that was to be sent again has arrived, or was given up."""
        for number in [number for number, stream in self._active.items() if not stream.has_work]:
            del self._active[number]

    def _activate(self, stream: OutgoingStream) -> None:
        """Have a stream served, if it has anything to send and its announcement has arrived."""
        if stream.has_work and stream.announcement is None:
            self._active[stream.number] = stream

    def _all_under_way(self) -> list[tuple[Ends, OutgoingMessage]]:
        if self._parts is not None:
            return list(self._parts.under_way)
        return [(((end,),), message) for end, message in self._under_way]

    def _finish(self, stream: OutgoingStream, message: OutgoingMessage) -> None:
        stream.begun, stream.is_floor_begun = None, False
        stream.sent += 1
        if message.is_kept or message.origin is not None:
            self._under_way.append((self._sent_bytes, message))
        if not stream.has_work:
            del self._active[stream.number]

    def _restart(self, stream: OutgoingStream, again: list[OutgoingMessage]) -> None:
        begun, stream.begun, stream.is_floor_begun = stream.begun, None, False
        stream.announcement = None
        stream.repairs.clear()
        if begun is not None and begun.is_kept:
            again.append(begun)
            begun = None
        if stream.video is None:
            self._restart_slots(stream, begun)
        else:
            self._restart_video(stream, stream.video, begun)
        if stream.latched is not None:
            self.fates.miss(*(one for one in (*again, *stream.queue) if one not in stream.latched))
            again, stream.queue, stream.queued_bytes = list(stream.latched), deque(), 0
        for message in reversed(again):
            # A latched message may be under way and wait to be sent once more.
            if message not in stream.queue:
                stream.put_queued(message, is_first=True)
        for message in (*stream.queue, *stream.slots.values()):
            message.offset = 0

    def _restart_slots(self, stream: OutgoingStream, begun: OutgoingMessage | None) -> None:
        if begun is not None and begun.lane in stream.lanes:
            stream.replaced += 1
            self.fates.miss(begun)
        elif begun is not None:
            waiting, stream.slots = stream.slots, {}
            stream.put_slot(begun)
            stream.slots |= waiting
        for lane in list(stream.lanes.values()):
            for number in list(lane)[:-1]:
                self._give_way(stream, number)

    def _restart_video(
        self, stream: OutgoingStream, group: VideoGroup, begun: OutgoingMessage | None
    ) -> None:
        """Have only frames wait that can be decoded without any that was under way."""
        waiting = [*(() if begun is None else (begun,)), *stream.slots.values()]
        stream.slots, stream.lanes, stream.slots_bytes = {}, {}, 0
        begins = [at for at, frame in enumerate(waiting) if frame.begins_group]
        first = begins[-1] if begins else len(waiting) - (not group.is_known)
        for message in waiting[: max(first, 0)]:
            self._leave_out(stream, message)
        for message in waiting[max(first, 0) :]:
            stream.put_slot(message)
        # Frames of a topic that is sent whole all go again.
        group.is_broken |= not stream.slots and not stream.needs.is_full


def _rank(stream: OutgoingStream, now_ns: int) -> tuple[bool, bool, float, int, int]:
    """The order in which streams are served, the least first. Streams are announced before their messages.

    Of one priority, what has least left to send goes first: the plan leaves the link room for all, and what
    is small need not wait behind an image.
    """
    is_control, message = stream.number == CONTROL_STREAM, stream.next_message
    return (
        not is_control,
        not stream.is_urgent(now_ns),
        -stream.needs.priority,
        message.rest_bytes,
        message.offered_ns,
    )
