# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robot's end of a link: its streams, whom it serves, and what each session begins with."""

from __future__ import annotations

import math
from collections.abc import Collection, Hashable, Mapping
from dataclasses import replace
from typing import Generic, TypeVar

from smarttestudo.domain.link import (
    LinkNeeds,
    LinkState,
    MessageOrigin,
    MissedMessage,
    Prediction,
    StreamCounts,
    StreamInfo,
)
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_MS, NS_PER_S
from smarttestudo.link.protocol.chunks import CONTROL_STREAM, HEADER_BYTES, MAX_STREAMS, Acknowledgement
from smarttestudo.link.protocol.messages import CONTROL, Announcement, LinkTimes, Report
from smarttestudo.link.protocol.outgoing_stream import Encode, Encoded, plain
from smarttestudo.link.protocol.receivers import Receivers
from smarttestudo.link.protocol.scheduler import STALLED_AFTER_NS, Scheduler
from smarttestudo.link.protocol.window import ACKNOWLEDGE_PERIOD_NS
from smarttestudo.pacing.coded_video import VideoReader, is_coded_video

LOST_AFTER_NS = 3 * NS_PER_S
"""An operator's end that said nothing for so long is no longer there; it says something twice a second."""
MAX_ENDING = 64
"""How many streams may still have something to send whose publishers are gone."""
_BLOCKED_AFTER_NS = NS_PER_S // 2
"""Datagrams of which none arrives for so long, and three round trips, are blocked where reports come."""
_HEARD_NS = NS_PER_S // 10
"""Reports come: one did so long, and a round trip, after the first of them was sent, and another later."""
HOLD_NS = 10 * NS_PER_S
"""For so long a session goes on before datagrams are tried again."""
_FAST_BYTES_PER_S = 5_000_000.0
"""A link that carries so much and loses little is a wire, where large chunks take less CPU."""
_LOSSY, _LOSSLESS = 0.01, 0.005
"""A radio loses a larger share than the first; what a wire loses, its queues overflowed."""
_LAST_SESSION = 2**32 - 2**16
"""A session that somebody else claimed is gone beyond only where many can follow."""
_Request = TypeVar("_Request")


class LinkSender(Generic[_Request]):
    """The policy of the robot's end: its streams, whom it serves and what a session begins with.

    The driver gives it messages (``put``) and reports (``handle_report``), and sends what its ``scheduler``
    gives. Times are passed in.

    It serves one operator's end at a time: the first that reports, until that is silent. Others receive what
    that one is sent; as one comes, latched messages are sent once more.
    """

    def __init__(
        self, encode: Encode = plain, fetch_budget_bytes_per_s: float = math.inf, start_ns: int = 0
    ) -> None:
        self._encode = encode
        self.scheduler: Scheduler[_Request] = Scheduler(self._encoded, fetch_budget_bytes_per_s)
        """What is sent next; it has the requests that others enqueue, too."""
        self._outbox = self.scheduler.outbox
        self._infos: dict[int, StreamInfo] = {}
        self._video: dict[int, VideoReader] = {}
        self._ending: dict[int, None] = {}
        """Streams whose publisher is gone, of which something waits, the first first."""
        self._closed: set[int] = set()
        """Numbers that were announced, and have no stream now."""
        self._counts_closed: dict[str, StreamCounts] = {}
        """The counts of closed streams, by topic."""
        self._needs: Mapping[str, LinkNeeds] = {}
        self._sessions = 0
        self._predictions: Mapping[str, Prediction] = {}
        self._anew: set[str] = set()
        self._receivers = Receivers(LOST_AFTER_NS)
        self._receiver: int | None = None
        self._is_cut_off = False
        """Whether the receiver that is served has no reliable link, and may be gone."""
        self.prefers_datagrams = True
        """Whether datagrams are used where nothing is lost, too, if the link is not fast."""
        self._datagrams_to: frozenset[int] = frozenset()
        """The receivers with which datagrams come through either way."""
        self._served_receiver: int | None = None
        """The receiver of the last session, though its connection may be cut."""
        self._received_ns = 0
        self._reported_ns = 0
        """When any receiver reported last."""
        self._arrived_ns = start_ns
        """When an operator's end said last that more has arrived."""
        self._restarted_ns = 0
        self._outages = 0
        self.report_bytes = 0
        """The size of all reports, which who reads them counts."""
        self._ages_ms: dict[str, float] = {}
        self._times_said_ns = 0
        self._said_period_ns = ACKNOWLEDGE_PERIOD_NS

    def open(self, info: StreamInfo, now_ns: int) -> int | None:
        """The number of a new stream; ``None`` where there are too many."""
        number = next((free for free in range(1, MAX_STREAMS) if free not in self._infos), None)
        if number is None:
            return None
        self._closed.discard(number)
        self._infos[number] = replace(info, prediction=self._predictions.get(info.topic))
        if (video := VideoReader.of(info.type_name)) is not None:
            self._video[number] = video
        # Of coded video, what was kept for a late receiver could not be decoded.
        is_latched = info.qos.transient_local and not is_coded_video(info.type_name)
        self._outbox.open(number, depth=info.qos.depth if is_latched else None)
        self._outbox.set_needs(number, self._needs.get(info.topic, LinkNeeds()))
        self._announce(number, now_ns)
        return number

    def close(self, stream: int, now_ns: int) -> None:
        """Have nothing more put into a stream; it ends once what waits in it has arrived."""
        if stream not in self._infos or stream in self._ending:
            return
        self._outbox.end(stream)
        self._ending[stream] = None
        self._close_drained(now_ns)
        if len(self._ending) > MAX_ENDING:
            self._close(next(iter(self._ending)), now_ns)

    def follow(self, needs: Mapping[str, LinkNeeds]) -> None:
        self._needs = needs
        for number, info in self._infos.items():
            self._outbox.set_needs(number, needs.get(info.topic, LinkNeeds()))

    def predict(self, predictions: Mapping[str, Prediction], anew: Collection[str], now_ns: int) -> None:
        """Have the operator's end reckon these topics; of some, ``anew`` from the next message on.

        It ends with the session and when a receiver comes, which may lack what was sent before. From then on
        a topic is reckoned when it has begun anew.
        """
        self._anew |= set(anew)
        self._predictions = {
            topic: prediction for topic, prediction in predictions.items() if topic in self._anew
        }
        for number, info in self._infos.items():
            said = replace(info, prediction=self._predictions.get(info.topic))
            if said != info:
                self._infos[number] = said
                self._announce(number, now_ns)
            if info.topic in anew:
                self._outbox.skip(number)

    def put(
        self,
        stream: int,
        payload: bytes,
        now_ns: int,
        lane: Hashable = None,
        origin: MessageOrigin | None = None,
    ) -> None:
        """Have a message sent; it replaces one of its ``lane`` that has not begun.

        A message that has an ``origin`` is kept where an operator's end misses it.
        """
        if not self.is_connected(now_ns):
            self._outbox.fates.cut()
        if stream in self._infos and stream not in self._ending:
            video = self._video.get(stream)
            frame = None if video is None else video.frame(payload)
            self._outbox.put(stream, payload, now_ns, lane, origin, frame=frame)

    def take_missed(self, now_ns: int, *, is_last: bool = False) -> list[MissedMessage]:
        """The messages missed since the last call; if it ``is_last``, what waits for nobody, too."""
        if is_last:
            self._outbox.fates.settle_all()
        if is_last and not self.is_connected(now_ns):
            self._outbox.give_up_all()
            self._outbox.fates.cut()
        missed = self._outbox.fates.missed
        return [missed.popleft() for _ in range(len(missed))]

    @property
    def is_settled(self) -> bool:
        """Whether it is known of what former sessions carried whether it arrived."""
        return self._outbox.fates.is_settled

    def handle_report(self, report: Report, now_ns: int) -> None:
        """An operator's end says what it has, over the reliable link."""
        was_cut_off, self._is_cut_off = self._is_cut_off, False
        self._handle_report(report, now_ns, was_cut_off=was_cut_off)

    def _handle_report(self, report: Report, now_ns: int, *, was_cut_off: bool = False) -> None:
        self._note_absence(report.receiver, now_ns)
        has_joined = self._receivers.handle(report, now_ns)
        if has_joined:
            self._introduce(now_ns)
        is_silent = self._receiver is None or was_cut_off or now_ns - self._received_ns > LOST_AFTER_NS
        if report.receiver == self._receiver or is_silent:
            self._serve(report, now_ns)
        elif report.received.is_cut and self._may_restart(report.received, now_ns):
            self._restart(now_ns)
        elif has_joined and not self.scheduler.is_by_datagrams:
            self._outbox.send_latched_again()

    def handle_datagram_report(self, report: Report, now_ns: int) -> None:
        """The same by a datagram: it comes from an end that the reliable link has as well, or had."""
        if report.receiver == self._receiver or report.receiver in self._receivers.numbers:
            self._handle_report(report, now_ns)
        elif report.receiver == self._served_receiver:
            # It is not served, as its links were cut; what it has is no less true.
            self._learn_late(report.received, now_ns)

    def allow_datagrams(self, receivers: frozenset[int]) -> None:
        """Datagrams come through to these receivers and back."""
        self._datagrams_to = receivers

    def note_pings(self, now_ns: int, *, sent: int, lost: int) -> None:
        """So many asked whether datagrams come through, of which so many had no answer."""
        self.scheduler.losses.count(now_ns, sent=sent, lost=lost)

    @property
    def receiver(self) -> int | None:
        """The receiver that is served."""
        return self._receiver

    def is_connected(self, now_ns: int) -> bool:
        """Whether an operator's end was heard lately."""
        return self.scheduler.is_open(now_ns)

    def disconnect(self) -> None:
        """The reliable link has no operator's end; the next that reports there gets a new session.

        One that moves to another network may lose that link alone: datagrams go on while it reports by these.
        """
        self._receivers = Receivers(LOST_AFTER_NS)
        if self.scheduler.is_by_datagrams and self._receiver in self._datagrams_to:
            self._is_cut_off = True
            return
        self._receiver = self.scheduler.open_until_ns = None
        self._outbox.fates.cut()

    def state(self, now_ns: int) -> LinkState:
        window = self.scheduler.window
        is_limit = self.scheduler.budget.is_limit(window)
        return LinkState(
            is_connected=self.is_connected(now_ns),
            capacity_kb_per_s=window.capacity_bytes_per_s / BYTES_PER_KB if is_limit else None,
            round_trip_ms=None if window.round_trip_ns is None else window.round_trip_ns / NS_PER_MS,
            outages=self._outages,
            sessions=self._sessions,
            predicted=self._receivers.predicted(now_ns),
            operators=self._receivers.present(now_ns),
            sent_bytes=self.scheduler.sent_bytes,
            report_bytes=self.report_bytes,
            silent_s=(now_ns - self._arrived_ns) / NS_PER_S,
            by_datagrams=self.scheduler.is_by_datagrams,
            lost_percent=100 * self.scheduler.losses.at(now_ns) if self.scheduler.is_by_datagrams else None,
        )

    def counts(self, now_ns: int) -> dict[str, StreamCounts]:
        counts = {**self._counts_closed}
        for number, one in self._outbox.counts(now_ns):
            info = self._infos.get(number)
            if info is not None:
                counts[info.topic] = counts.get(info.topic, StreamCounts()) + one
        return counts

    def age_ms(self, topic: str) -> float | None:
        """How old the last message of ``topic`` was when it arrived."""
        return self._ages_ms.get(topic)

    def _serve(self, report: Report, now_ns: int) -> None:
        received = report.received
        must_restart = report.receiver != self._receiver or received.session == 0
        # One that comes may have heard what another was sent.
        self._outbox.fates.settle(received.session, report.ended)
        if must_restart and report.receiver == self._served_receiver:
            self._learn_of_cut(received, now_ns)
        self._receiver = self._served_receiver = report.receiver
        heard_ns, self._received_ns = self._received_ns, now_ns
        self.scheduler.open_until_ns = now_ns + LOST_AFTER_NS
        if self.scheduler.session < received.session < _LAST_SESSION:
            # Somebody else's chunks were taken for ours; ours count again from the next session on.
            self._restart(now_ns, after=received.session)
        else:
            is_lost = not must_restart and self._acknowledge(received, now_ns)
            is_blocked = self._are_datagrams_blocked(heard_ns, now_ns)
            if must_restart or is_lost or is_blocked or self._is_to_switch(now_ns):
                self._restart(now_ns, is_blocked=is_blocked)
        for number, age_ms in report.ages_ms.items():
            info = self._infos.get(number)
            if info is not None:
                self._ages_ms[info.topic] = age_ms
        self._close_drained(now_ns)
        self._say_times(now_ns)
        self.scheduler.budget.measure(self.scheduler.window, now_ns)

    def _note_absence(self, receiver: int, now_ns: int) -> None:
        """Count an outage where one receiver was there, then for a while none, and then another."""
        absent_ns, self._reported_ns = now_ns - self._reported_ns, now_ns
        # A receiver that is back itself knows what had arrived, and is counted with that.
        if self._served_receiver not in {None, receiver}:
            self._outages += absent_ns > self.scheduler.stalled_after_ns

    def _close_drained(self, now_ns: int) -> None:
        for stream in [ending for ending in self._ending if self._outbox.is_drained(ending)]:
            self._close(stream, now_ns)

    def _close(self, stream: int, now_ns: int) -> None:
        """Send nothing more of a stream; what waits in it overflows."""
        info = self._infos.pop(stream)
        self._video.pop(stream, None)
        del self._ending[stream]
        had = self._counts_closed.get(info.topic, StreamCounts())
        self._counts_closed[info.topic] = had + self._outbox.close(stream, now_ns)
        self._closed.add(stream)
        self._announce(stream, now_ns)

    def _learn_of_cut(self, received: Acknowledgement, now_ns: int) -> None:
        """A receiver whose connection was cut is back, and knows what had arrived by then."""
        if self._receiver is None:
            self._outages += now_ns - self._received_ns > self.scheduler.stalled_after_ns
        self._learn_late(received, now_ns)

    def _learn_late(self, received: Acknowledgement, now_ns: int) -> None:
        is_newest = received.session == self.scheduler.session
        if is_newest and received.received_bytes <= self.scheduler.window.sent_bytes:
            self._outbox.acknowledge(received, now_ns)

    def _acknowledge(self, received: Acknowledgement, now_ns: int) -> bool:
        """The receiver has so much of this session; whether another is to begin: the rest is lost."""
        is_stalled = self.scheduler.is_stalled(now_ns)
        if is_stalled:
            self._outbox.fates.cut()
        before_bytes = self.scheduler.window.acknowledged_bytes
        self.scheduler.acknowledge(received, now_ns)
        if self.scheduler.window.acknowledged_bytes > before_bytes:
            self._arrived_ns = now_ns
        self._outages += is_stalled
        if self.scheduler.is_by_datagrams:
            return is_stalled
        is_lossy = received.is_cut or bool(received.lost)
        return (is_stalled and self.scheduler.window.in_flight_bytes > 0) or (
            is_lossy and self._may_restart(received, now_ns)
        )

    def _is_to_switch(self, now_ns: int) -> bool:
        """Whether datagrams are to be used from now on, or no more."""
        if self._may_use_datagrams(now_ns):
            has_held = now_ns - self._restarted_ns >= HOLD_NS or self._sessions <= 1
            return has_held and not self.scheduler.is_by_datagrams
        return self.scheduler.is_by_datagrams

    def _are_datagrams_blocked(self, heard_ns: int, now_ns: int) -> bool:
        """Whether none arrives while reports come, the last one then: in an outage these would not come."""
        since_ns, trip_ns = self.scheduler.window.waiting_since_ns, self.scheduler.round_trip_ns
        if not self.scheduler.is_by_datagrams or since_ns is None or trip_ns is None:
            return False
        has_heard = heard_ns - since_ns > _HEARD_NS + trip_ns and now_ns - heard_ns > _HEARD_NS
        return has_heard and now_ns - since_ns > _BLOCKED_AFTER_NS + 3 * trip_ns

    def _may_use_datagrams(self, now_ns: int) -> bool:
        """Whether the receiver that is served, and no other, is there, and has them come through."""
        if self._receiver not in self._datagrams_to or self._receivers.present(now_ns) != {self._receiver}:
            return False
        is_fast = self.scheduler.window.capacity_bytes_per_s >= _FAST_BYTES_PER_S
        if self.prefers_datagrams and not is_fast:
            return True
        return self.scheduler.losses.is_above(_LOSSLESS if self.scheduler.is_by_datagrams else _LOSSY, now_ns)

    def _may_restart(self, received: Acknowledgement, now_ns: int) -> bool:
        """Whether what is lost is of this session, and it is not the first second of it."""
        is_newest = received.session == self.scheduler.session
        return is_newest and now_ns - self._restarted_ns >= STALLED_AFTER_NS

    def _restart(self, now_ns: int, *, after: int = 0, is_blocked: bool = False) -> None:
        """Begin another session, ``after`` one, over the reliable link where datagrams are blocked."""
        self._restarted_ns = now_ns
        self._said_period_ns = ACKNOWLEDGE_PERIOD_NS
        session = max(self.scheduler.session, after) + 1
        by_datagrams = self._may_use_datagrams(now_ns) and not is_blocked
        self.scheduler.restart(session, now_ns, by_datagrams=by_datagrams)
        self._introduce(now_ns)

    def _introduce(self, now_ns: int) -> None:
        """Say all that a receiver must know that may lack what was sent before, which nobody predicts now."""
        self._sessions += 1
        self._predictions, self._anew = {}, set()
        self._infos = {number: replace(info, prediction=None) for number, info in self._infos.items()}
        # What was closed in an outage was not heard.
        for number in (*self._closed, *self._infos):
            self._announce(number, now_ns)

    def _announce(self, stream: int, now_ns: int) -> None:
        said = Announcement(
            stream=stream, info=self._infos.get(stream), predicted_for=self._receivers.numbers
        )
        self._outbox.put(CONTROL_STREAM, CONTROL.to_bytes(said), now_ns, about=stream)

    def _encoded(self, stream: int, payload: bytes) -> Encoded:
        """Encode a message, and keep how many bytes that saves of those that are planned."""
        encoded = self._encode(stream, payload)
        info = self._infos.get(stream)
        if info is not None and info.topic in self._needs:
            self.scheduler.budget.encoded(len(payload), len(encoded.data) + HEADER_BYTES)
        return encoded

    def _say_times(self, now_ns: int) -> None:
        """Say once a second what the operator's end is to know, and at once how often it is to report."""
        window = self.scheduler.window
        trip_ns, period_ns = window.round_trip_ns, window.acknowledge_period_ns
        is_due = now_ns - self._times_said_ns >= NS_PER_S or period_ns != self._said_period_ns
        if trip_ns is not None and is_due:
            self._times_said_ns, self._said_period_ns = now_ns, period_ns
            said = LinkTimes(round_trip_ms=trip_ns / NS_PER_MS, report_period_ms=period_ns / NS_PER_MS)
            self._outbox.put(CONTROL_STREAM, CONTROL.to_bytes(said), now_ns)
