# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's end of a link over Zenoh."""

from __future__ import annotations

import secrets
import threading
from collections import deque
from collections.abc import Callable, Collection, Hashable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import zenoh

from smarttestudo.domain.errors import LinkError, said
from smarttestudo.domain.link import (
    LinkNeeds,
    LinkState,
    MessageOrigin,
    MissedMessage,
    Prediction,
    StreamCounts,
    StreamInfo,
)
from smarttestudo.domain.robot import Payload
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.link.protocol.chunks import MAX_MESSAGE_BYTES
from smarttestudo.link.protocol.datagrams import DATAGRAM_OFFERS, DATAGRAM_REQUESTS, DATAGRAM_VERSION
from smarttestudo.link.protocol.keys import new_boot
from smarttestudo.link.protocol.messages import ReportReader
from smarttestudo.link.protocol.requests import Grant
from smarttestudo.link.protocol.sender import LinkSender
from smarttestudo.link.transfer.catalog import IncidentCatalog
from smarttestudo.link.worker import Worker
from smarttestudo.link.zenoh.commands import CommandInbox
from smarttestudo.link.zenoh.compression import Compressor
from smarttestudo.link.zenoh.queries import MAX_WAITING, Query, QueryServer, WaitingQuestion
from smarttestudo.link.zenoh.security import LinkOptions
from smarttestudo.link.zenoh.session import OPERATOR, LinkSession, OtherVersions, has_subscribers
from smarttestudo.link.zenoh.statuses import StatusServer
from smarttestudo.link.zenoh.transfer import Answer, ByteServer
from smarttestudo.pacing.cdr import STREAM_TYPES, StreamReader

if TYPE_CHECKING:
    from smarttestudo.link.zenoh.datagrams import Datagrams

_POLL_AGAIN_S = 0.2
"""After so long it is asked again what is to be sent, though nothing happened."""


class RobotEnd:
    """Sends the messages of a robot's streams. No call waits for the link.

    A thread of its own compresses and sends. What others want of the sender meanwhile waits in an inbox,
    which whoever can lock the sender empties: so only ``advertise`` waits for a compression.
    """

    def __init__(
        self,
        opened: LinkSession,
        robot: str,
        warn: Callable[[str], None],
        clock: Callable[[], int],
        fetch_budget_kb_per_s: float,
    ) -> None:
        """Offer the robot to operators. Raises ``UsageError`` for its name."""
        self.boot = new_boot(robot, secrets.randbits(64))
        self.malformed = 0
        """Reports that were not readable."""
        self.commands: CommandInbox | None = None
        """Messages of operators, where the robot accepts any."""
        self._warn = warn
        self._clock = clock
        self._sender: LinkSender[Answer] = LinkSender(
            Compressor().encode, fetch_budget_kb_per_s * BYTES_PER_KB, clock()
        )
        self._lock = threading.Lock()
        self._inbox: deque[Callable[[], None]] = deque()
        self._has_left = False
        self._state = LinkState()
        self._budget_kb_per_s: float | None = None
        self._counts: dict[str, StreamCounts] = {}
        self._origin: Callable[[], MessageOrigin | None] = lambda: None
        self._versions = OtherVersions(warn)
        self._reports, self._datagram_reports = ReportReader(), ReportReader()
        self._datagrams: Datagrams | None = None
        # Neither a message nor an answer waits for the disk.
        self._disk = Worker("link-incidents", lambda error: warn(f"no incident: {said(error)}"))
        self._worker = Worker(
            "link-send", lambda error: warn(f"the link sends nothing more: {error}"), self._send_next
        )
        session = opened.session
        # What is due is sent at once, and in order: chunks are as large as the link takes at a time.
        self._data = session.declare_publisher(
            self.boot.data_key, congestion_control=zenoh.CongestionControl.BLOCK, express=True
        )
        # Kept alive: Zenoh undeclares on garbage collection.
        self._kept = (
            self._data.declare_matching_listener(self._match),
            session.declare_subscriber(self.boot.report_key, self._on_report),
            session.liveliness().declare_token(self.boot.key),
        )
        self._queries = QueryServer(opened, self.boot, warn, self._versions, clock)
        self._bytes = ByteServer(self._queries, self._sender.scheduler.requests, self._do, clock)
        self._status = StatusServer(session, self._bytes, self.boot.status_key, clock)
        self._worker.start()

    def advertise(self, stream: StreamInfo) -> RobotPublisher:
        """A publisher of the messages of a stream. Raises ``LinkError`` where there are too many."""
        with self._lock:
            self._empty_inbox()
            number = self._sender.open(stream, self._clock())
        if number is None:
            raise LinkError("the link has as many topics as it can", place=stream.topic)
        self._worker.wake()
        return RobotPublisher(self, number, stream)

    def offer_incidents(self, folder: Path) -> None:
        """Let operators list and fetch the incidents in ``folder`` from now on."""
        self._disk.start()
        later = partial(self._disk.give, most=MAX_WAITING)
        self._bytes.offer(self.boot.incidents_key, IncidentCatalog(folder).open, later)

    def offer_datagrams(self, options: LinkOptions) -> None:
        """Send what is relayed as datagrams from now on, where an operator's end asks for them.

        Unless they are needed, that is only where the radio loses some: on others large chunks take less CPU.
        """
        from smarttestudo.link.zenoh.datagrams import Datagrams  # noqa: PLC0415  needs cryptography

        datagrams = self._datagrams = Datagrams(
            options,
            self._clock,
            lambda _peer, data: self._take_report(self._datagram_reports, data, is_datagram=True),
            lambda reached: self._do(partial(self._sender.allow_datagrams, frozenset(map(int, reached)))),
            self._warn,
            is_robot=True,
            on_pings=self._note_pings,
        )
        self._sender.prefers_datagrams = options.needs_datagrams

        def handle(query: Query) -> None:
            request = DATAGRAM_REQUESTS.from_bytes(query.data)
            if request.version != DATAGRAM_VERSION:
                raise LinkError(f"datagrams have version {DATAGRAM_VERSION} here, not {request.version}")
            if request.port is None and datagrams.port is None:
                # Both connect to a router, and neither knows where the other is.
                query.drop()
                return
            offer = datagrams.offer(str(request.receiver), DATAGRAM_VERSION, request.port)
            query.reply(DATAGRAM_OFFERS.to_bytes(offer))

        self._queries.serve(self.boot.datagrams_key, handle)

    def _note_pings(self, sent: int, lost: int) -> None:
        self._do(lambda: self._sender.note_pings(self._clock(), sent=sent, lost=lost))

    def follow(self, needs: Mapping[str, LinkNeeds]) -> None:
        self._do(partial(self._sender.follow, needs))

    def predict(self, predictions: Mapping[str, Prediction], anew: Collection[str]) -> None:
        """Have receivers reckon these topics; of some, ``anew`` from the next message on."""
        self._do(lambda: self._sender.predict(predictions, anew, self._clock()))

    def keep_missed(self, origin: Callable[[], MessageOrigin | None]) -> None:
        """Keep from now on what operators' ends miss of messages that have an ``origin``."""
        self._origin = origin

    def take_missed(self, *, is_last: bool = False) -> list[MissedMessage]:
        """The messages missed at operators' ends since the last call; if ``is_last``, those waiting, too."""
        if not self._lock.acquire(blocking=is_last):
            return []
        try:
            self._empty_inbox()
            return self._sender.take_missed(self._clock(), is_last=is_last)
        finally:
            self._lock.release()

    @property
    def is_settled(self) -> bool:
        """Whether it is known of what former connections carried whether it arrived."""
        return self._sender.is_settled

    @property
    def robot(self) -> str:
        return self.boot.robot

    @property
    def is_watched(self) -> bool:
        return self._status.is_watched

    def tell(self, status: Mapping[str, object]) -> None:
        """Have everyone who watches receive this status. Raises ``LinkError`` where that cannot be."""
        self._status.tell(status)

    def take_question(self) -> WaitingQuestion | None:
        return self._queries.take_question()

    @property
    def state(self) -> LinkState:
        self._poll()
        return self._state

    @property
    def budget_kb_per_s(self) -> float | None:
        """The budget of all relayed topics now; ``None`` while nothing is known of the link."""
        self._poll()
        return self._budget_kb_per_s

    def counts(self) -> dict[str, StreamCounts]:
        if self._lock.acquire(blocking=False):
            try:
                self._counts = self._sender.counts(self._clock())
            finally:
                self._lock.release()
        return self._counts

    def age_ms(self, topic: str) -> float | None:
        """How old the last message of ``topic`` was when it arrived at the operator's end."""
        return self._sender.age_ms(topic)

    def send(self, stream: int, payload: bytes, lane: Hashable) -> None:
        self._do(partial(self._sender.put, stream, payload, self._clock(), lane, self._origin()))

    def end(self, stream: int) -> None:
        self._do(partial(self._sender.close, stream, self._clock()))

    def refuse(self, topic: str, size_bytes: int) -> None:
        self._warn(
            f"{topic}: a message of {size_bytes} bytes is too large for the link; it takes up to 64 MiB"
        )

    def close(self) -> None:
        """Send nothing more; the session is to be closed then."""
        for worker in (self._queries, self._disk, self._worker):
            worker.close()
        if self._datagrams is not None:
            self._datagrams.close()

    def _do(self, act: Callable[[], None]) -> None:
        """Act on the sender, and have the thread send what may be sent then."""
        self._inbox.append(act)
        if self._lock.acquire(blocking=False):
            try:
                self._empty_inbox()
                if not self._sender.scheduler.has_next(self._clock()):
                    return
            finally:
                self._lock.release()
        self._worker.wake()

    def _empty_inbox(self) -> None:
        for _ in range(len(self._inbox)):
            self._inbox.popleft()()

    def _poll(self) -> None:
        if self._lock.acquire(blocking=False):
            try:
                self._state = self._sender.state(self._clock())
                self._budget_kb_per_s = self._sender.scheduler.budget.kb_per_s
            finally:
                self._lock.release()

    def _match(self, status: zenoh.MatchingStatus) -> None:
        self._has_left = not status.matching
        if self._has_left:
            self._do(self._sender.disconnect)

    def _on_report(self, sample: zenoh.Sample) -> None:
        # Access control denies this key; a wider one, which includes it, passes there.
        if str(sample.key_expr) != self.boot.report_key:
            return
        # What an operator's end said last may come after the news that it left.
        if self._has_left and not has_subscribers(self._data):
            return
        self._take_report(self._reports, sample.payload.to_bytes())

    def _take_report(self, reader: ReportReader, data: bytes, *, is_datagram: bool = False) -> None:
        try:
            report = reader.from_bytes(data)
        except LinkError:
            self._versions.check(OPERATOR, data)
            self.malformed += 1
            return
        handle = self._sender.handle_datagram_report if is_datagram else self._sender.handle_report

        def take() -> None:
            self._sender.report_bytes += len(data)
            handle(report, self._clock())

        self._do(take)

    def _send_next(self) -> float:
        """Send all chunks that may be sent, or an answer; how long to wait then."""
        scheduler = self._sender.scheduler
        has_more = True
        while has_more and not self._worker.is_closed:
            with self._lock:
                self._empty_inbox()
                now_ns = self._clock()
                chunk = scheduler.next_chunk(now_ns)
                if chunk is None:
                    grant, wait_s = self._next_grant(now_ns)
                    break
                has_more = scheduler.has_next(now_ns)
                receiver = self._sender.receiver if scheduler.is_by_datagrams else None
            if receiver is None:
                self._data.put(chunk)
            else:
                self._send_datagram(receiver, chunk)
        else:
            return _POLL_AGAIN_S
        if grant is None:
            return wait_s
        # It waits where the link is thin, and nobody is to wait for that.
        size_bytes, is_last = self._bytes.answer(grant)
        with self._lock:
            if size_bytes:
                scheduler.requests.sent(grant, size_bytes, now_ns)
            if is_last:
                scheduler.requests.finish(grant)
        return 0.0

    def _send_datagram(self, receiver: int, chunk: bytes) -> None:
        peer = None if self._datagrams is None else self._datagrams.peer(str(receiver))
        if self._datagrams is not None and peer is not None:
            self._datagrams.send(peer, chunk)

    def _next_grant(self, now_ns: int) -> tuple[Grant[Answer] | None, float]:
        """The question for bytes to answer now, or how long to wait."""
        scheduler = self._sender.scheduler
        for answer in scheduler.requests.expired(now_ns):
            answer.query.drop()
        grant = scheduler.next_grant(now_ns)
        wake_ns = scheduler.wake_ns(now_ns)
        wait_ns = NS_PER_S if wake_ns is None else max(wake_ns - now_ns, 0)
        wait_s = min(wait_ns / NS_PER_S, _POLL_AGAIN_S)
        return grant, wait_s


class RobotPublisher:
    """Sends the messages of one topic; of those that name streams, each set of names replaces only itself."""

    def __init__(self, end: RobotEnd, number: int, stream: StreamInfo) -> None:
        self._end = end
        self._number = number
        self._topic = stream.topic
        self._was_refused = False
        self._is_closed = False
        is_named = stream.type_name in STREAM_TYPES
        self._reader = StreamReader(stream.type_name) if is_named else None

    def publish(self, payload: Payload) -> None:
        """Send a serialized message, unless it is too large, which is said once."""
        if self._is_closed:
            return
        if len(payload) > MAX_MESSAGE_BYTES:
            if not self._was_refused:
                self._was_refused = True
                self._end.refuse(self._topic, len(payload))
            return
        data = payload[:]
        lane = (self._reader.streams(data) or None) if self._reader else None
        self._end.send(self._number, data, lane)

    def close(self) -> None:
        if not self._is_closed:
            self._is_closed = True
            self._end.end(self._number)
