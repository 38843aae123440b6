# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The order in which the robot's end sends: the one place that owns window, outbox and requests."""

from __future__ import annotations

import math
from typing import Generic, TypeVar

from smarttestudo.domain.profile import UNLIMITED_KB_PER_S
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.link.protocol.chunks import CONTROL_STREAM, HEADER_BYTES, Acknowledgement
from smarttestudo.link.protocol.datagram_window import DatagramWindow
from smarttestudo.link.protocol.outbox import Outbox
from smarttestudo.link.protocol.outgoing_stream import Encode
from smarttestudo.link.protocol.repair import LossShare, SentParts
from smarttestudo.link.protocol.requests import Grant, Requests
from smarttestudo.link.protocol.window import Window

STALLED_AFTER_NS = NS_PER_S
"""Bytes that were under way for so long, and four round trips, met an outage."""
FIRST_STALLED_AFTER_NS = 15 * NS_PER_S
"""The same for the first bytes, which may be many for a link of which nothing is known."""

_Request = TypeVar("_Request")

_PERIOD_NS = NS_PER_S // 4
_KEPT_SHARE = 0.99
"""How much an earlier message counts beside the newest: about the last hundred say what compression saves."""
_USABLE = 0.95
"""The share of the capacity that is planned with; the rest carries what nobody planned."""
_OUTGROWN = 2.0
"""A budget of so many times what was measured has grown while the link stood idle."""
_GROWTH = ((0.5, 1.4), (0.15, 1.07), (0.05, 1.0))
"""Shares of a period in which nothing waited to be sent, and by how much the budget grows after it."""
_MOST_BYTES_PER_S = UNLIMITED_KB_PER_S * BYTES_PER_KB


class BudgetEstimator:
    """The capacity where the link is the limit; elsewhere it grows while nothing waits to be sent."""

    def __init__(self) -> None:
        self._bytes_per_s: float | None = None
        self._measured_ns = 0
        self._idle_ns = 0
        """For how long nothing waited to be sent, since ``_measured_ns``."""
        self._idle_since_ns: int | None = None
        self._payload_bytes = self._wire_bytes = 1.0

    def idle(self, now_ns: int) -> None:
        self._idle_since_ns = self._idle_since_ns or now_ns

    def sent(self, now_ns: int) -> None:
        if self._idle_since_ns is not None:
            self._idle_ns += now_ns - self._idle_since_ns
            self._idle_since_ns = None

    def encoded(self, payload_bytes: int, wire_bytes: int) -> None:
        """A message that is planned takes so many bytes on the link."""
        self._payload_bytes = self._payload_bytes * _KEPT_SHARE + payload_bytes
        self._wire_bytes = self._wire_bytes * _KEPT_SHARE + wire_bytes

    def measure(self, window: Window, now_ns: int) -> None:
        """Set the budget by what was measured, four times a second."""
        span_ns = now_ns - self._measured_ns
        if span_ns < _PERIOD_NS:
            return
        if self._idle_since_ns is not None:
            self._idle_ns += now_ns - self._idle_since_ns
            self._idle_since_ns = now_ns
        idle_share, self._idle_ns, self._measured_ns = self._idle_ns / span_ns, 0, now_ns
        if not window.is_measured:
            return
        usable = window.capacity_bytes_per_s * _USABLE
        before = usable if self._bytes_per_s is None else self._bytes_per_s
        growth = next((growth for share, growth in _GROWTH if idle_share > share), None)
        grown = usable if growth is None else max(usable, before * growth)
        self._bytes_per_s = min(grown, _MOST_BYTES_PER_S)

    def is_limit(self, window: Window) -> bool:
        """Whether the capacity was measured, and topics need so much that it says something by now."""
        usable = window.capacity_bytes_per_s * _USABLE
        budget = self._bytes_per_s
        return window.is_measured and (budget is None or budget <= _OUTGROWN * usable)

    @property
    def kb_per_s(self) -> float | None:
        """The budget of all relayed topics now, before compression; ``None`` while it is not known.

        ``UNLIMITED_KB_PER_S`` where the link is no limit.
        """
        if self._bytes_per_s is None:
            return None
        if self._bytes_per_s >= _MOST_BYTES_PER_S:
            return UNLIMITED_KB_PER_S
        budget_kb_per_s = self._bytes_per_s * self._payload_bytes / self._wire_bytes / BYTES_PER_KB
        return min(budget_kb_per_s, UNLIMITED_KB_PER_S)


class Scheduler(Generic[_Request]):
    """All that waits for one link and is under way on it, in the time that is passed in.

    The ``outbox`` says which message of the live streams is next, the ``window`` how many bytes may be under
    way, and ``requests`` are answered beside them. The ``budget`` is learned from all.
    It is open, so that live messages go, up to ``open_until_ns``. Who is served and what a session begins
    with is not decided here.

    The driver sends what ``next_chunk`` gives; where that has nothing, it answers the request that
    ``next_grant`` gives, and says how much that was (``requests.sent``). Another look is due after anything
    happened, and at ``wake_ns``.
    """

    def __init__(self, encode: Encode, fetch_budget_bytes_per_s: float = math.inf) -> None:
        self.session = 0
        """Number of the session of which chunks are; 0 before the first."""
        self.open_until_ns: int | None = None
        self._chunk_bytes = 0
        self.losses = LossShare()
        self.outbox = Outbox(encode)
        self.outbox.open(CONTROL_STREAM)
        self.window: Window | DatagramWindow = Window()
        self.budget = BudgetEstimator()
        self._trip_ns: int | None = None
        """The least round trip of earlier sessions."""
        self.requests: Requests[_Request] = Requests(self._live_window, fetch_budget_bytes_per_s)

    @property
    def is_by_datagrams(self) -> bool:
        """Whether the session goes by datagrams, of which some may be lost."""
        return isinstance(self.window, DatagramWindow)

    @property
    def round_trip_ns(self) -> int | None:
        """The least round trip, of an earlier session until this one has any."""
        trip_ns = self.window.round_trip_ns
        return self._trip_ns if trip_ns is None else trip_ns

    @property
    def _free_ns(self) -> int:
        return self.window.free_ns if isinstance(self.window, DatagramWindow) else 0

    def is_open(self, now_ns: int) -> bool:
        """Whether somebody is there to receive live messages."""
        return self.open_until_ns is not None and now_ns <= self.open_until_ns

    @property
    def sent_bytes(self) -> int:
        """Bytes that were put on the link since the start: chunks of all sessions, and answers."""
        return self._chunk_bytes + self.requests.sent_bytes

    def is_stalled(self, now_ns: int) -> bool:
        """Whether what is under way should long have arrived."""
        since_ns = self.window.waiting_since_ns
        # No outage is shorter than that, and this is asked of every chunk.
        if since_ns is None or now_ns - since_ns <= STALLED_AFTER_NS:
            return False
        return now_ns - since_ns > self.stalled_after_ns

    @property
    def stalled_after_ns(self) -> int:
        """The longest time that bytes are under way on a link without an outage, in ns."""
        trip_ns = self.window.round_trip_ns
        return FIRST_STALLED_AFTER_NS if trip_ns is None else STALLED_AFTER_NS + 4 * trip_ns

    def next_chunk(self, now_ns: int) -> bytes | None:
        """The chunk to send now; ``None`` while nothing waits, nobody is there, or enough is under way."""
        if not self._may_send(now_ns):
            return None
        if isinstance(self.window, DatagramWindow):
            return self._next_datagram(self.window, now_ns)
        chunk_bytes = self.window.chunk_bytes
        if not chunk_bytes:
            if not self.outbox.is_empty:
                self.window.limited()
            return None
        chunk = self.outbox.next_chunk(self.session, chunk_bytes - HEADER_BYTES, now_ns)
        if chunk is None:
            self._note_idle(now_ns)
            return None
        data = chunk.to_bytes()
        self.window.sent(len(data), now_ns)
        self._note_sent(len(data), now_ns)
        return data

    def _next_datagram(self, window: DatagramWindow, now_ns: int) -> bytes | None:
        self.outbox.look_for_losses(now_ns)
        if self.outbox.is_empty:
            self._note_idle(now_ns)
            return None
        if not window.may_send(now_ns, is_small=self.outbox.is_next_small(now_ns)):
            if not window.has_room:
                window.limited()
            return None
        chunk = self.outbox.next_chunk(self.session, 0, now_ns)
        assert chunk is not None
        data = chunk.to_bytes()
        self._note_sent(len(data), now_ns)
        return data

    def _note_sent(self, size_bytes: int, now_ns: int) -> None:
        self._chunk_bytes += size_bytes
        self.budget.sent(now_ns)
        self.requests.fill(size_bytes, now_ns, self.window)
        if self.outbox.is_empty:
            self._note_idle(now_ns)

    def next_grant(self, now_ns: int) -> Grant[_Request] | None:
        """The request to answer now; to be asked for when ``next_chunk`` has nothing."""
        is_busy = self.is_open(now_ns) and (not self.outbox.is_empty or self.is_stalled(now_ns))
        return self.requests.next(now_ns, is_free=not is_busy)

    def has_next(self, now_ns: int) -> bool:
        """Whether ``next_chunk`` or ``next_grant`` may give something."""
        if not self.outbox.is_empty and self._may_send(now_ns):
            if isinstance(self.window, DatagramWindow):
                return self.window.may_send(now_ns, is_small=self.outbox.is_next_small(now_ns))
            if self.window.has_room:
                return True
            self.window.limited()
        return not self.requests.is_empty

    def wake_ns(self, now_ns: int) -> int | None:
        """When to look again though nothing happens; ``None`` where that is not known."""
        due_ns = [self.requests.wake_ns(now_ns)]
        if self.is_by_datagrams and self._may_send(now_ns):
            due_ns.append(self.outbox.wake_ns)
            if not self.outbox.is_empty and self.window.has_room:
                due_ns.append(self._free_ns)
        return min((one for one in due_ns if one is not None), default=None)

    def acknowledge(self, received: Acknowledgement, now_ns: int) -> None:
        """The other end has so much of a session; what it says of another than this one is no news."""
        if received.session != self.session:
            return
        if self.is_by_datagrams or self.window.acknowledge(received.received_bytes, now_ns):
            self.outbox.acknowledge(received, now_ns)

    def restart(self, session: int, now_ns: int, *, by_datagrams: bool = False) -> None:
        """Begin another session: what was under way in the last one is lost, or goes again."""
        ended, self.session = self.session, session
        before, parts = self.window, None
        self._trip_ns = self.round_trip_ns
        if by_datagrams:
            window = DatagramWindow(before.capacity_bytes_per_s, is_measured=before.is_measured)
            parts = SentParts(window, self.losses, self._trip_ns)
            self.window = window
        else:
            self.window = Window(before.capacity_bytes_per_s, is_measured=before.is_measured)
        self.outbox.close(CONTROL_STREAM, now_ns)
        self.outbox.open(CONTROL_STREAM)
        self.outbox.restart(ended, now_ns, parts)

    def _may_send(self, now_ns: int) -> bool:
        return self.is_open(now_ns) and not self.is_stalled(now_ns)

    def _note_idle(self, now_ns: int) -> None:
        self.window.idle()
        self.budget.idle(now_ns)

    def _live_window(self, now_ns: int) -> Window | None:
        """The window of the topics, while anybody receives them."""
        return self.window if self.is_open(now_ns) else None
