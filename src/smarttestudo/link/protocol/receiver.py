# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The operator's end of a link: messages put together, how old they are, and what to report."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.link.protocol.chunks import (
    CONTROL_STREAM,
    MAX_MESSAGE_BYTES,
    NUMBERS,
    Chunk,
    LostSpan,
    Reassembler,
    ReceivedSessions,
)
from smarttestudo.link.protocol.messages import CONTROL, REPORTS, Announcement, Report, ReportWriter
from smarttestudo.link.protocol.ordered_parts import OrderedParts, WholeMessage
from smarttestudo.link.protocol.window import (
    ACKNOWLEDGE_BYTES,
    ACKNOWLEDGE_PERIOD_NS,
    CLOCK_WINDOW_NS,
    LeastOfWindow,
)
from smarttestudo.pacing.coded_video import VideoGroup, VideoReader

KEEP_ALIVE_NS = NS_PER_S // 2
"""How often to report though nothing arrived, so that the robot's end knows that somebody is there."""
LATE_AFTER_NS = NS_PER_S
"""A chunk that was under way for so long, and four round trips, met an outage."""

_AGES_PERIOD_NS = NS_PER_S

Decompress = Callable[[bytes, int], bytes]
"""Makes the payload of what travelled compressed, at most so many bytes. Raises ``LinkError``."""


@dataclass(slots=True)
class ReceiverCounts:
    """Counts of what arrived since the start.

    ``messages`` are whole and delivered, ``late`` ones not, because they were under way in an outage;
    ``repeated`` ones were there already, of ``broken`` ones a part was missing, ``malformed`` are chunks.
    """

    messages: int = 0
    late: int = 0
    repeated: int = 0
    broken: int = 0
    malformed: int = 0
    received_bytes: int = 0


class LinkReceiver:
    """One robot's messages as they come, in the time that is passed in; the robot's own clock may be another.

    Give it chunks (``receive``), and send what ``next_report`` gives at ``wake_ns``.
    """

    def __init__(
        self,
        robot: str,
        receiver: int,
        decompress: Decompress,
        predicts: frozenset[str] = frozenset(),
        *,
        boot: str = "",
    ) -> None:
        """``predicts`` are the topics that this end reckons where the robot's does so too.

        ``boot`` is the run of the robot's end.
        """
        self.robot = robot
        self.boot = boot
        self.counts = ReceiverCounts()
        self.streams: dict[int, StreamInfo] = {}
        self._receiver = receiver
        self._reports = ReportWriter(receiver)
        self._decompress = decompress
        self._predicts = predicts
        self._sessions = ReceivedSessions()
        self._parts = Reassembler()
        self._ordered: OrderedParts | None = None
        """The parts of a session by datagrams."""
        self._offset = LeastOfWindow(CLOCK_WINDOW_NS)
        self._round_trip_ns = 0
        self._newest: dict[int, int] = {}
        self._video: dict[int, VideoReader] = {}
        self._groups: dict[int, VideoGroup] = {}
        """The last group of each stream of coded video."""
        self._ages_ms: dict[int, float] = {}
        self.report_period_ns = ACKNOWLEDGE_PERIOD_NS
        """How often to report while something comes."""
        self.has_news = False
        """Whether anything arrived since the last report."""
        self._reported_bytes = 0
        self._reported_ns: int | None = None
        self._ages_reported_ns = 0

    def receive(self, data: bytes, now_ns: int) -> Announcement | ReceivedMessage | None:
        """The stream or the message that is whole with the chunk ``data``: announced, closed or received."""
        try:
            chunk = Chunk.from_bytes(data)
            return self._receive(chunk, len(data), now_ns)
        except LinkError:
            self.counts.malformed += 1
            return None

    def receive_datagram(self, data: bytes, now_ns: int) -> list[Announcement | ReceivedMessage]:
        """The streams and messages that are whole with a chunk which may come before or after others."""
        try:
            chunk = Chunk.from_bytes(data)
            return self._receive_datagram(chunk, len(data), now_ns)
        except LinkError:
            self.counts.malformed += 1
            return []

    @property
    def is_by_datagrams(self) -> bool:
        """Whether the newest session came by datagrams."""
        return self._ordered is not None

    @property
    def wake_ns(self) -> int:
        if self._reported_ns is None:
            return 0
        if self._sessions.received_bytes - self._reported_bytes >= ACKNOWLEDGE_BYTES:
            return self._reported_ns
        return self._reported_ns + (self.report_period_ns if self.has_news else KEEP_ALIVE_NS)

    def next_report(self, now_ns: int) -> bytes:
        self._reported_ns, self._reported_bytes = now_ns, self._sessions.received_bytes
        self.has_news = False
        received, ended = self._sessions.newest, self._sessions.ended
        if now_ns - self._ages_reported_ns < _AGES_PERIOD_NS and received.session:
            return self._reports.to_bytes(received, ended)
        self._ages_reported_ns = now_ns
        ages_ms, self._ages_ms = self._ages_ms, {}
        report = Report(
            receiver=self._receiver, received=received, ended=ended, ages_ms=ages_ms, predicts=self._predicts
        )
        return REPORTS.to_bytes(report)

    def _receive(self, chunk: Chunk, size_bytes: int, now_ns: int) -> Announcement | ReceivedMessage | None:
        self.has_news = True
        self._follow_session(chunk)
        is_next = self._sessions.on_chunk(chunk, size_bytes)
        if not is_next:
            # Of a connection that was given up or cut; what must not be lost comes again.
            self.counts.late += 1
            return None
        self.counts.received_bytes += size_bytes
        offset_ns = now_ns - chunk.sent_ns
        transit_ns = offset_ns - self._offset.add(offset_ns, now_ns)
        data = self._parts.add(chunk)
        if data is None:
            if chunk.is_last:
                self._lack(chunk)
            return None
        if chunk.is_compressed:
            data = self._decompress(data, MAX_MESSAGE_BYTES)
        if chunk.stream == CONTROL_STREAM:
            return self._control(data)
        return self._message(chunk, data, transit_ns)

    def _follow_session(self, chunk: Chunk, ordered: OrderedParts | None = None) -> None:
        """Begin a session with its first chunk; what is unfinished of the last one is lost."""
        if chunk.session <= self._sessions.session:
            return
        if self._ordered is not None:
            for span in self._ordered.undelivered:
                self._sessions.refuse(span)
        self.counts.broken += self._parts.broken
        self._parts, self._ordered, self._reported_bytes = Reassembler(), ordered, 0
        self.report_period_ns = ACKNOWLEDGE_PERIOD_NS

    def _receive_datagram(
        self, chunk: Chunk, size_bytes: int, now_ns: int
    ) -> list[Announcement | ReceivedMessage]:
        self.has_news = True
        self._follow_session(chunk, OrderedParts())
        ordered = self._ordered
        span = None if ordered is None else self._sessions.on_datagram(chunk, size_bytes)
        if span is None or ordered is None:
            self.counts.repeated += 1
            return []
        self.counts.received_bytes += size_bytes
        if not chunk.is_in_order and chunk.number == self._newest.get(chunk.stream):
            # It is there; refused, it would count as lost.
            self.counts.repeated += 1
            return []
        offset_ns = now_ns - chunk.sent_ns
        transit_ns = offset_ns - self._offset.add(offset_ns, now_ns)
        is_late = transit_ns > LATE_AFTER_NS + 4 * self._round_trip_ns and not chunk.is_kept
        if is_late or not self._is_wanted(chunk, span, ordered):
            # What is needed of it comes again.
            self._sessions.refuse(span)
            self.counts.late += 1
            return []
        try:
            whole = ordered.add(chunk, span, now_ns - transit_ns)
        except LinkError:
            self._sessions.refuse(span)
            raise
        found = [self._deliver(one, now_ns) for one in whole]
        return [one for one in found if one is not None]

    def _is_wanted(self, chunk: Chunk, span: LostSpan, ordered: OrderedParts) -> bool:
        if chunk.stream == CONTROL_STREAM:
            return True
        if chunk.stream not in self.streams or span.after_bytes < ordered.announced(chunk.stream):
            # It is of a stream that had the number before.
            return False
        if chunk.is_in_order:
            return True
        before = self._newest.get(chunk.stream)
        is_newer = before is None or 0 < (chunk.number - before) % NUMBERS < NUMBERS // 2
        return is_newer and chunk.before <= ordered.delivered(chunk.stream)

    def _deliver(self, whole: WholeMessage, now_ns: int) -> Announcement | ReceivedMessage | None:
        chunk, data = whole.chunk, whole.data
        if chunk.is_compressed:
            data = self._decompress(data, MAX_MESSAGE_BYTES)
        if chunk.stream != CONTROL_STREAM:
            return self._message(chunk, data, now_ns - whole.sent_ns)
        said = self._control(data)
        if said is not None and self._ordered is not None:
            self._ordered.announce(said.stream, whole.span, is_open=said.info is not None)
        return said

    def _control(self, data: bytes) -> Announcement | None:
        said = CONTROL.from_bytes(data)
        if not isinstance(said, Announcement):
            self._round_trip_ns = int(said.round_trip_ms * NS_PER_MS)
            self.report_period_ns = min(int(said.report_period_ms * NS_PER_MS), KEEP_ALIVE_NS)
            return None
        known = self.streams.get(said.stream)
        if said.info is not None and self._receiver not in said.predicted_for:
            said = replace(said, info=replace(said.info, prediction=None))
        if known == said.info:
            return None
        if said.info is None:
            self.streams.pop(said.stream, None)
        else:
            self.streams[said.stream] = said.info
        if known is None or said.info is None or replace(known, prediction=said.info.prediction) != said.info:
            self._newest.pop(said.stream, None)
            self._groups.pop(said.stream, None)
            self._video.pop(said.stream, None)
            if said.info is not None and (video := VideoReader.of(said.info.type_name)) is not None:
                self._video[said.stream] = video
        return said

    def _group(self, stream: int, payload: bytes, *, follows: bool) -> VideoGroup | None:
        """The group of coded video with ``payload`` in it: the robot's end does not know what was late."""
        video = self._video.get(stream)
        frame = None if video is None else video.frame(payload)
        if frame is None and stream not in self._groups:
            return None
        group = self._groups.setdefault(stream, VideoGroup())
        group.is_broken |= not follows
        group.take(frame)
        return group

    def _lack(self, chunk: Chunk) -> None:
        """Say that the message of the last chunk is lost, where it does not come again."""
        if self._ordered is None and not chunk.is_kept:
            self._sessions.lack()

    def _message(self, chunk: Chunk, payload: bytes, transit_ns: int) -> ReceivedMessage | None:
        info = self.streams.get(chunk.stream)
        if info is None:
            self._lack(chunk)
            self.counts.malformed += 1
            return None
        before = self._newest.get(chunk.stream)
        ahead = 1 if before is None else (chunk.number - before) % NUMBERS
        if not 0 < ahead < NUMBERS // 2:
            self.counts.repeated += 1
            return None
        group = self._group(chunk.stream, payload, follows=ahead == 1)
        if transit_ns > LATE_AFTER_NS + 4 * self._round_trip_ns and not chunk.is_kept:
            if group is not None:
                group.is_broken = True
            self._lack(chunk)
            self.counts.late += 1
            return None
        if group is not None and group.is_known and group.is_broken:
            self.counts.late += 1
            return None
        self._newest[chunk.stream] = chunk.number
        self.counts.messages += 1
        age_ns = chunk.sent_ns - chunk.offered_ns + transit_ns + self._round_trip_ns // 2
        self._ages_ms[chunk.stream] = max(age_ns, 0) / NS_PER_MS
        return ReceivedMessage(
            robot=self.robot,
            stream=info,
            payload=payload,
            offered_ns=chunk.offered_ns,
            age_ns=max(age_ns, 0),
            begins_anew=before is None or ahead != 1,
            boot=self.boot,
        )
