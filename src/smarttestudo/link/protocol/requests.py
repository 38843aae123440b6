# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Requests that are answered beside live topics: urgent ones between these, others in what these leave."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.link.protocol.window import Window

MAX_CLIENTS = 16
MAX_URGENT = 32
"""How many urgent requests may wait."""
KEPT_NS = 15 * NS_PER_S
"""How long a request is answered whose client says nothing."""

_LOST_AFTER_NS = 5 * NS_PER_S
"""Bytes that were not acknowledged for so long are under way no more."""
_PIECE_NS = 5 * NS_PER_MS
"""How much of the link a piece takes, which is how long a live message may wait for it."""
_LEAST_PIECE_BYTES = 600
_MOST_PIECE_BYTES = 16_000
_LONGEST_PAUSE_NS = NS_PER_S // 2
_URGENT_PAUSE = 5
"""So many times what an urgent piece takes of the link, the next one goes."""
_BUDGET_PIECE_S = 0.5
"""How much of the budget a piece takes at most."""
_BUDGET_CREDIT_NS = NS_PER_S
"""How much of the budget that live topics kept from being used may be used later."""
_FRAMING_BYTES = 150
"""The head of a piece on the wire: it is an answer of Zenoh in a packet of its own."""
_USED = 0.95
"""The share of the capacity up to which the link is filled."""
_MARGIN = 0.75
"""The share of the window that all bytes under way may take while something is sent beside live topics."""
_FIRST_PROBE = 1.5
_PROBE = 1.25
"""How much faster than its capacity the link is filled to see whether it carries more."""
_PROBE_NS = 300 * NS_PER_MS
_SAMPLE_NS = 250 * NS_PER_MS
_EARLY_PROBES = 3
"""So many in a row that found nothing are followed by others soon, for the first of them are of few bytes."""
_EARLY_WAIT_NS = NS_PER_S // 2
_LEAST_WAIT_NS = 5 * NS_PER_S
_MOST_DOUBLINGS = 4

_Request = TypeVar("_Request")


@dataclass(frozen=True, slots=True)
class Grant(Generic[_Request]):
    """A request to answer now with at most ``size_bytes``; an urgent one is of no ``client``."""

    client: int | None
    request: _Request
    size_bytes: int


@dataclass(slots=True, eq=False)
class _Client(Generic[_Request]):
    """Of what was sent to a client, all up to ``done_bytes`` has arrived or was lost."""

    seen_ns: int
    first_bytes: int
    """Bytes that it had got at its first request; an earlier run of this end sent them."""
    sent_bytes: int = 0
    done_bytes: int = 0
    lost_bytes: int = 0
    request: _Request | None = None
    flights: deque[tuple[int, int]] = field(default_factory=deque)


class Requests(Generic[_Request]):
    """Requests that are answered piece by piece until nothing is left, in the time that is passed in.

    An urgent one is answered though live topics need all of the link, of which it takes a fifth at most.
    The others, one a client, wait until the link has nothing better to do.

    Beside live topics, whose window ``live`` gives at a time, the link is modelled as a queue that drains at
    its capacity, and a piece is sent only when that queue is empty, nothing live waits, and all bytes under
    way leave a margin in the window. So a live message waits for one piece at most. Now and then the link is
    filled a little faster, to learn whether it carries more than live topics needed so far. Without live
    topics, a window of its own says how much may be under way. Where there is a budget, all answers together
    take no more of the wire than that.
    """

    def __init__(self, live: Callable[[int], Window | None], budget_bytes_per_s: float = math.inf) -> None:
        self._live = live
        self._budget_bytes_per_s = budget_bytes_per_s
        self._within_budget_ns = 0
        """When all that was sent is within the budget."""
        self._clients: dict[int, _Client[_Request]] = {}
        self._urgent: deque[_Request] = deque()
        self._urgent_ns = 0
        """When the next urgent piece may go."""
        self.sent_bytes = 0
        """Bytes of all answers, with what frames them."""
        self._alone = Window()
        self._busy_ns = self._sent_ns = 0
        self._delivered_bytes = 0
        self._probe_until_ns = 0
        self._next_probe_ns = 0
        self._failed_probes = 0
        self._sample: tuple[int, int] | None = None
        """When the sample of a probe began, and what was delivered by then."""

    @property
    def is_empty(self) -> bool:
        return not self._urgent and not self._waits

    @property
    def _waits(self) -> bool:
        return any(client.request is not None for client in self._clients.values())

    @property
    def in_flight_bytes(self) -> int:
        """Bytes that were sent and are not known to have arrived or to be lost."""
        return sum(client.sent_bytes - client.done_bytes for client in self._clients.values())

    def enqueue_urgent(self, request: _Request) -> bool:
        """Have an urgent request wait; whether there is room for it."""
        if len(self._urgent) >= MAX_URGENT:
            return False
        self._urgent.append(request)
        return True

    def enqueue(self, client: int, got_bytes: int, request: _Request, now_ns: int) -> _Request | None:
        """Have a request wait, of a client that has got so much.

        Return what is not answered any more: its request of before, or this one where there is no room.
        """
        if client not in self._clients:
            if len(self._clients) >= MAX_CLIENTS:
                return request
            self._clients[client] = _Client(now_ns, got_bytes)
        self.acknowledge(client, got_bytes, now_ns)
        known = self._clients[client]
        before, known.request = known.request, request
        return before

    def acknowledge(self, client: int, got_bytes: int, now_ns: int) -> None:
        """Note how much a client has got since its first request."""
        known = self._clients.get(client)
        if known is None:
            return
        known.seen_ns = now_ns
        done_bytes = min(got_bytes - known.first_bytes + known.lost_bytes, known.sent_bytes)
        if done_bytes > known.done_bytes:
            self._arrived(known, done_bytes, now_ns)

    def expired(self, now_ns: int) -> list[_Request]:
        """Requests that are not answered any more: nobody says that anything arrives."""
        gone = []
        for number, client in list(self._clients.items()):
            is_silent = now_ns - client.seen_ns > KEPT_NS
            while client.flights and now_ns - client.flights[0][1] > _LOST_AFTER_NS:
                is_silent = True
                total, _ = client.flights.popleft()
                client.lost_bytes += total - client.done_bytes
                client.done_bytes = total
                self._alone = Window(self._alone.capacity_bytes_per_s)
            if is_silent and client.request is not None:
                gone.append(client.request)
                client.request = None
            if client.request is None and not client.flights and now_ns - client.seen_ns > _LOST_AFTER_NS:
                del self._clients[number]
        return gone

    def wake_ns(self, now_ns: int) -> int | None:
        """When something may be sent though nothing happens; ``None`` where that is not known."""
        due_ns = [self._urgent_ns] if self._urgent else []
        if self._waits:
            due_ns.append(max(self._free_ns, self._within_budget_ns))
        return min((one for one in due_ns if one > now_ns), default=None)

    def next(self, now_ns: int, *, is_free: bool = True) -> Grant[_Request] | None:
        """The request to answer now; ``is_free`` says that nothing live waits."""
        if self._urgent and now_ns >= self._urgent_ns:
            live = self._live(now_ns)
            size_bytes = _MOST_PIECE_BYTES if live is None else _piece_bytes(live)
            return Grant(None, self._urgent[0], size_bytes)
        if not self._waits:
            self._alone.idle()
            return None
        if not is_free or now_ns < self._within_budget_ns or not self._budget_bytes_per_s:
            return None
        live = self._live(now_ns)
        room_bytes = self._room_alone() if live is None else self._room_beside(live, now_ns)
        if not room_bytes:
            return None
        size_bytes = int(min(room_bytes, max(_LEAST_PIECE_BYTES, self._budget_bytes_per_s * _BUDGET_PIECE_S)))
        number = next(number for number, client in self._clients.items() if client.request is not None)
        client = self._clients.pop(number)
        # All take turns.
        self._clients[number] = client
        assert client.request is not None
        return Grant(number, client.request, size_bytes)

    def sent(self, grant: Grant[_Request], size_bytes: int, now_ns: int) -> None:
        """Count the bytes that went out for a grant."""
        wire_bytes = size_bytes + _FRAMING_BYTES
        self.sent_bytes += wire_bytes
        live = self._live(now_ns)
        if live is not None:
            self.fill(wire_bytes, now_ns, live)
        if grant.client is None:
            if live is not None:
                self._urgent_ns = now_ns + int(
                    _URGENT_PAUSE * wire_bytes * NS_PER_S / live.capacity_bytes_per_s
                )
            return
        known = self._clients[grant.client]
        known.sent_bytes += size_bytes
        known.flights.append((known.sent_bytes, now_ns))
        self._sent_ns = now_ns
        of_budget_ns = int(wire_bytes * NS_PER_S / self._budget_bytes_per_s)
        self._within_budget_ns = max(self._within_budget_ns, now_ns - _BUDGET_CREDIT_NS) + of_budget_ns
        if live is None:
            self._alone.sent(size_bytes, now_ns)

    def finish(self, grant: Grant[_Request]) -> None:
        """Nothing is left to answer the request of a grant with."""
        if grant.client is None:
            self._urgent.popleft()
        elif self._clients[grant.client].request is grant.request:
            self._clients[grant.client].request = None

    def _room_alone(self) -> int:
        room_bytes = min(self._alone.chunk_bytes, _MOST_PIECE_BYTES)
        if not room_bytes:
            self._alone.limited()
        return room_bytes

    def _room_beside(self, live: Window, now_ns: int) -> int:
        """How large a piece may be; 0 while none may be sent."""
        if now_ns >= self._next_probe_ns:
            self._begin_probe(live, now_ns)
        piece_bytes = _piece_bytes(live)
        under_way_bytes = live.in_flight_bytes + self.in_flight_bytes
        self._drain(under_way_bytes, live, now_ns)
        margin = 1.0 if now_ns < self._probe_until_ns else _MARGIN
        # One piece is never too much, or a window that is too small would stay so.
        fits = not self.in_flight_bytes or under_way_bytes + piece_bytes <= margin * live.size_bytes
        return piece_bytes if fits and now_ns >= self._free_ns else 0

    @property
    def _free_ns(self) -> int:
        """When the next piece may be sent; some always are, or too low a capacity would never be noticed."""
        return min(self._busy_ns, self._sent_ns + _LONGEST_PAUSE_NS)

    def fill(self, size_bytes: int, now_ns: int, live: Window) -> None:
        """Count bytes of live topics or of an answer that went out beside live topics."""
        share = self._probe_gain if now_ns < self._probe_until_ns else _USED
        takes_ns = int(size_bytes * NS_PER_S / (live.capacity_bytes_per_s * share))
        self._busy_ns = max(self._busy_ns, now_ns) + takes_ns

    def _drain(self, under_way_bytes: int, live: Window, now_ns: int) -> None:
        """No more is on the link than is under way."""
        most_ns = int(under_way_bytes * NS_PER_S / (live.capacity_bytes_per_s * _USED))
        self._busy_ns = min(self._busy_ns, now_ns + most_ns)

    def _arrived(self, client: _Client[_Request], done_bytes: int, now_ns: int) -> None:
        delivered, client.done_bytes = done_bytes - client.done_bytes, done_bytes
        while client.flights and client.flights[0][0] <= done_bytes:
            client.flights.popleft()
        self._delivered_bytes += delivered
        self._alone.acknowledge(
            min(self._alone.acknowledged_bytes + delivered, self._alone.sent_bytes), now_ns
        )
        live = self._live(now_ns)
        if live is not None:
            live.delivered_beside(delivered)
            self._judge_probe(live, now_ns)

    @property
    def _probe_gain(self) -> float:
        return _FIRST_PROBE if self._failed_probes <= _EARLY_PROBES else _PROBE

    def _begin_probe(self, live: Window, now_ns: int) -> None:
        """Begin a probe, which counts as one without result until it has one."""
        self._probe_until_ns = now_ns + _PROBE_NS
        self._sample = None
        self._failed_probes += 1
        wait_ns = _EARLY_WAIT_NS
        if self._failed_probes > _EARLY_PROBES:
            doubled = min(self._failed_probes - _EARLY_PROBES - 1, _MOST_DOUBLINGS)
            wait_ns = _LEAST_WAIT_NS << doubled
        self._next_probe_ns = now_ns + _PROBE_NS + (live.round_trip_ns or 0) + wait_ns

    def _judge_probe(self, live: Window, now_ns: int) -> None:
        """Learn from what arrives while the link is filled faster; probe again at once where that helped."""
        trip_ns = live.round_trip_ns or 0
        if now_ns > self._probe_until_ns + trip_ns + _SAMPLE_NS:
            return
        delivered = self._delivered_bytes + live.acknowledged_bytes
        if self._sample is None:
            if now_ns >= self._probe_until_ns - _PROBE_NS + trip_ns:
                self._sample = now_ns, delivered
            return
        since_ns, before = self._sample
        if now_ns - since_ns < _SAMPLE_NS:
            return
        self._probe_until_ns = 0
        rate = (delivered - before) * NS_PER_S / (now_ns - since_ns)
        if rate > live.capacity_bytes_per_s:
            # More was not tried, however the news of it came together.
            live.raise_capacity(min(rate, self._probe_gain * live.capacity_bytes_per_s))
            self._failed_probes, self._next_probe_ns = 0, now_ns


def _piece_bytes(live: Window) -> int:
    of_link_bytes = int(live.capacity_bytes_per_s * _PIECE_NS / NS_PER_S)
    return max(_LEAST_PIECE_BYTES, min(of_link_bytes, _MOST_PIECE_BYTES))
