# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How many bytes may be under way: what the link delivers, and its least round trip.

The model is that of BBR (Cardwell et al., "BBR: Congestion-Based Congestion Control", ACM Queue 2016): the
largest delivered rate and the least round trip, each over a window, with regular phases that look for more
of the one and less of the other. It differs where the other end acknowledges every 20 ms instead of each
packet, and where a sender with little to send must not forget what the link carries.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from smarttestudo.domain.units import NS_PER_MS, NS_PER_S

CLOCK_WINDOW_NS = 60 * NS_PER_S
"""For how long a comparison of two clocks counts: clocks drift."""
ACKNOWLEDGE_PERIOD_NS = 20_000_000
"""How often the other end says what it has received, while something comes."""
SELDOM_PERIOD_NS = 50_000_000
"""How often on a link that ``is_fast``: saying it takes CPU of both ends."""
ACKNOWLEDGE_BYTES = 500_000
"""After so many bytes it is said at once."""
START_BYTES_PER_S = 40_000.0
"""The capacity of a link of which nothing is known."""

_SAMPLE_NS = 200 * NS_PER_MS
"""The length of time over which the delivered rate is measured; all samples are alike."""
_LEAST_PAUSE_NS = ACKNOWLEDGE_PERIOD_NS
"""A sample reaches over shorter pauses."""
_LEAST_BURST_BYTES = 64_000
"""What arrived of so many bytes in a shorter time counts as well, where it is more than was known."""
_RATE_WINDOW_NS = 1_500 * NS_PER_MS
_TRIP_WINDOW_NS = 10 * NS_PER_S
_DRAIN_AFTER_NS = 5 * NS_PER_S
"""A least round trip that was not seen again for so long is looked for with a nearly empty link."""
_DRAIN_NS = 200 * NS_PER_MS
_ALLOWANCE_NS = 10 * NS_PER_MS
"""Bytes that have arrived are under way until the next acknowledgement, and so much longer."""
_FAST_BYTES_PER_S = 5_000_000.0
"""Links that carry less may soon carry much less, and are watched more closely: they are radios."""
_LEAST_WINDOW_BYTES = 3_000
_CHUNK_S = 0.02
_LEAST_CHUNK_BYTES = 1_200
_MOST_CHUNK_BYTES = 16_000
_MOST_FREE_CHUNK_BYTES = 128_000
"""The same where topics leave a part of the link unused: many small chunks take much CPU of both ends."""
_FALL = 0.7
"""A link that delivers less than this share of its capacity, with a long round trip, has become slower."""
_RISE = 1.15
_GROW_GAIN = 2.0
_PROBE_GAIN = 1.25
_FIRST_TRIP_NS = 50 * NS_PER_MS


class LeastOfWindow:
    """The least of what was added in the last ``window_ns``. Times never fall."""

    def __init__(self, window_ns: int) -> None:
        self._window_ns = window_ns
        self._least: deque[tuple[int, int]] = deque()

    def add(self, value: int, now_ns: int) -> int:
        """The least value, this one included."""
        while self._least and self._least[-1][1] >= value:
            self._least.pop()
        self._least.append((now_ns, value))
        least = self.at(now_ns)
        assert least is not None
        return least

    def at(self, now_ns: int) -> int | None:
        """The least value at ``now_ns``; ``None`` where none was added lately."""
        while self._least and self._least[0][0] < now_ns - self._window_ns:
            self._least.popleft()
        return self._least[0][1] if self._least else None


class _LeastTrip:
    """The least round trip: one that was not seen again for long is looked for on a nearly empty link."""

    def __init__(self) -> None:
        self.least_ns: int | None = None
        """The least of the last ten seconds; ``None`` before the first."""
        self.last_ns = _FIRST_TRIP_NS
        self._least = LeastOfWindow(_TRIP_WINDOW_NS)
        self._seen_ns = 0
        """When a round trip was about as short as the least."""
        self._drain_until_ns: int | None = None
        self._drained_ns = 0

    @property
    def is_draining(self) -> bool:
        """Whether the link is kept nearly empty, so that no queue is part of what is measured."""
        return self._drain_until_ns is not None

    def add(self, trip_ns: int, now_ns: int) -> bool:
        """A round trip ended; whether draining ended with it."""
        self.last_ns = trip_ns
        if self._drain_until_ns is None:
            before_ns = self._least.at(now_ns)
            if before_ns is None or trip_ns <= before_ns * 1.1 + 2 * NS_PER_MS:
                self._seen_ns = now_ns
            self.least_ns = self._least.add(trip_ns, now_ns)
            return False
        self._drained_ns = min(self._drained_ns, trip_ns)
        if now_ns < self._drain_until_ns:
            return False
        # Before, a queue was part of what was measured.
        self._drain_until_ns, self._seen_ns = None, now_ns
        self._least = LeastOfWindow(_TRIP_WINDOW_NS)
        self.least_ns = self._least.add(self._drained_ns, now_ns)
        return True

    def drain_if_due(self, now_ns: int) -> None:
        """Drain the link where the least was not seen for long."""
        if self.least_ns is not None and now_ns - self._seen_ns > _DRAIN_AFTER_NS:
            self._drain_until_ns = now_ns + _DRAIN_NS + self.least_ns
            self._drained_ns = self.last_ns


class _DeliveredRate:
    """The largest rate at which the link delivered lately, measured in samples that are alike.

    Only samples in which the link was the limit say what it carries, and only time in which it was ages
    them: who has little to send does not forget it. What arrives faster than was known counts at any time.
    """

    def __init__(self, bytes_per_s: float, *, is_measured: bool) -> None:
        self.bytes_per_s = bytes_per_s
        self.is_measured = is_measured
        """Whether the rate was measured, not assumed."""
        self.is_growing = True
        """Whether the last sample found that the link carries clearly more."""
        self.is_limit = True
        """Whether the link was the limit in the last sample."""
        self.was_full = self.was_idle = False
        """Whether there was once more to send than room, or nothing, in the sample that goes on."""
        self.was_empty = False
        """Whether nothing was under way at a time of the sample that goes on."""
        self.begun_ns: int | None = None
        """When the sample that goes on began."""
        self.beside_bytes = 0
        """Bytes that arrived beside the session since then."""
        self._begin_bytes = 0
        self._limited_ns = 0
        """Time during which the link was the limit."""
        self._rates: deque[tuple[int, float]] = deque()
        self._has_fallen = False

    def begin(self, total_bytes: int, now_ns: int) -> None:
        """Begin a sample, when so much of the session had arrived."""
        self.begun_ns, self._begin_bytes = now_ns, total_bytes
        self.beside_bytes = 0
        self.was_full = self.was_idle = self.was_empty = False

    def take(self, total_bytes: int, now_ns: int, *, was_limit: bool, has_queue: bool) -> None:
        """Learn from the sample that ends now, and begin the next."""
        span_ns = now_ns - (self.begun_ns or 0)
        rate = (total_bytes - self._begin_bytes + self.beside_bytes) * NS_PER_S / span_ns
        self.begin(total_bytes, now_ns)
        if was_limit:
            self._limited_ns += span_ns
            self.is_measured = True
            self._learn(rate, has_queue=has_queue)
        elif rate > self.bytes_per_s:
            self._learn(rate, has_queue=has_queue)
        else:
            self.is_growing = False

    def take_burst(self, total_bytes: int, now_ns: int, *, has_queue: bool) -> None:
        """Learn from what arrived before there was more to send: the link carries no less."""
        arrived_bytes = total_bytes - self._begin_bytes
        rate = arrived_bytes * NS_PER_S / max(now_ns - (self.begun_ns or 0), ACKNOWLEDGE_PERIOD_NS)
        # The first bytes after a pause may be faster than the link: a shaper lets some pass at once.
        if arrived_bytes >= _LEAST_BURST_BYTES and rate > self.bytes_per_s:
            self._learn(rate, has_queue=has_queue)
            self.begin(total_bytes, now_ns)

    def keep(self, rate: float) -> None:
        """Have the link carry so much, for as long as a sample counts."""
        while self._rates and self._rates[-1][1] <= rate:
            self._rates.pop()
        self._rates.append((self._limited_ns, rate))
        while self._rates[0][0] < self._limited_ns - _RATE_WINDOW_NS:
            self._rates.popleft()
        self.bytes_per_s = max(self._rates[0][1], 1.0)

    def _learn(self, rate: float, *, has_queue: bool) -> None:
        falls = has_queue and rate < _FALL * self.bytes_per_s
        if falls or self._has_fallen:
            # What the link carried before it fell is forgotten; a part of that is in the sample of the fall.
            self._rates.clear()
        self._has_fallen = falls
        self.is_growing = rate > _RISE * self.bytes_per_s
        self.keep(rate)


class _Flight(NamedTuple):
    """Bytes under way: they end at ``total`` of the session."""

    total: int
    sent_ns: int


class Window:
    """The bytes of one session that may be under way. Times never fall.

    The driver says what happens: only while the window is full and something waits (``limited``), never
    ``idle``, does the delivered rate say what the link carries.
    """

    def __init__(self, capacity_bytes_per_s: float = START_BYTES_PER_S, *, is_measured: bool = False) -> None:
        self.sent_bytes = 0
        self.acknowledged_bytes = 0
        self._rate = _DeliveredRate(capacity_bytes_per_s, is_measured=is_measured)
        self._trip = _LeastTrip()
        self._flights: deque[_Flight] = deque()
        self._acknowledged_ns = 0
        """When the last bytes were acknowledged."""
        self._size_bytes: int | None = None
        """The size as it is until something is learned."""

    @property
    def capacity_bytes_per_s(self) -> float:
        """How much the link carries, as far as it is known."""
        return self._rate.bytes_per_s

    @property
    def is_measured(self) -> bool:
        """Whether the capacity was measured, not assumed."""
        return self._rate.is_measured

    @property
    def in_flight_bytes(self) -> int:
        return self.sent_bytes - self.acknowledged_bytes

    @property
    def round_trip_ns(self) -> int | None:
        """The least round trip of the last ten seconds; ``None`` before the first."""
        return self._trip.least_ns

    @property
    def waiting_since_ns(self) -> int | None:
        """Since when the oldest bytes are under way; ``None`` while none are."""
        return self._flights[0].sent_ns if self._flights else None

    @property
    def is_fast(self) -> bool:
        """Whether it carries more than topics need, and so much that it need not be watched closely."""
        return not self._rate.is_limit and self._rate.bytes_per_s >= _FAST_BYTES_PER_S

    @property
    def acknowledge_period_ns(self) -> int:
        """How often the other end is to say what it has received."""
        return SELDOM_PERIOD_NS if self.is_fast else ACKNOWLEDGE_PERIOD_NS

    @property
    def size_bytes(self) -> int:
        if self._size_bytes is None:
            self._size_bytes = max(_LEAST_WINDOW_BYTES, int(self._rate.bytes_per_s * self._ahead_s))
        return self._size_bytes

    @property
    def _ahead_s(self) -> float:
        """The time by which the link is filled ahead, in s."""
        trip_ns = self._least_trip_ns
        if self._trip.is_draining:
            return trip_ns / NS_PER_S / 2
        # On a short link most of a round trip is the wait for the acknowledgement.
        period_ns = self.acknowledge_period_ns
        if self.is_growing:
            return _GROW_GAIN * (trip_ns + period_ns) / NS_PER_S
        return (_PROBE_GAIN * trip_ns + period_ns + _ALLOWANCE_NS) / NS_PER_S

    @property
    def is_growing(self) -> bool:
        """Whether the link was found to carry clearly more, and has no queue yet."""
        return self._rate.is_growing and self._trip.last_ns < self._least_trip_ns * 1.25 + (
            self.acknowledge_period_ns + _ALLOWANCE_NS
        )

    @property
    def _least_trip_ns(self) -> int:
        return _FIRST_TRIP_NS if self._trip.least_ns is None else self._trip.least_ns

    @property
    def has_room(self) -> bool:
        """Whether another chunk may be sent now."""
        return self.in_flight_bytes < self.size_bytes

    @property
    def chunk_bytes(self) -> int:
        """How long the next chunk may be; 0 while there is no room.

        It is 20 ms of the link within 1.2 and 16 KB, or 128 KB where topics do not need all of the link.
        """
        room_bytes = self.size_bytes - self.in_flight_bytes
        # A small rest is used too: else a window of little more than a chunk never shows that there is more.
        if room_bytes <= 0:
            return 0
        most_bytes = _MOST_CHUNK_BYTES if self._rate.is_limit else _MOST_FREE_CHUNK_BYTES
        of_link_bytes = int(self._rate.bytes_per_s * _CHUNK_S)
        return max(_LEAST_CHUNK_BYTES, min(most_bytes, of_link_bytes, room_bytes))

    def limited(self) -> None:
        """Note that there is more to send than room."""
        self._rate.was_full = True

    def idle(self) -> None:
        """Note that nothing waits to be sent: what is delivered meanwhile says little about the link."""
        self._rate.was_idle = True

    def sent(self, size_bytes: int, now_ns: int) -> None:
        is_after_pause = self._rate.was_idle and not self._flights
        has_paused = is_after_pause and now_ns - self._acknowledged_ns > _LEAST_PAUSE_NS
        if self._rate.begun_ns is None or has_paused:
            # A sample does not reach over a pause.
            self._rate.begin(self.acknowledged_bytes, now_ns)
        elif not self._flights:
            self._rate.was_empty = True
        self.sent_bytes += size_bytes
        self._flights.append(_Flight(self.sent_bytes, now_ns))

    def delivered_beside(self, size_bytes: int) -> None:
        """Bytes of no session arrived, which the link carried all the same."""
        self._rate.beside_bytes += size_bytes

    def raise_capacity(self, bytes_per_s: float) -> None:
        """The link was seen to carry more than was known."""
        self._size_bytes = None
        self._rate.keep(bytes_per_s)

    def acknowledge(self, total_bytes: int, now_ns: int) -> bool:
        """The other end has ``total_bytes`` of the session; whether that can be."""
        if not self.acknowledged_bytes <= total_bytes <= self.sent_bytes:
            return False
        self._size_bytes = None
        self.acknowledged_bytes = total_bytes
        newest = None
        while self._flights and self._flights[0].total <= total_bytes:
            newest = self._flights.popleft()
            self._acknowledged_ns = now_ns
        if newest is not None:
            self._take_trip(now_ns - newest.sent_ns, now_ns)
        if not self._flights:
            self._rate.was_empty = True
        self._take_rate(now_ns)
        return True

    def _take_trip(self, trip_ns: int, now_ns: int) -> None:
        was_draining = self._trip.is_draining
        if self._trip.add(trip_ns, now_ns):
            self._rate.begin(self.acknowledged_bytes, now_ns)
        elif not was_draining and not self._has_queue and not self.is_fast:
            self._trip.drain_if_due(now_ns)

    def _take_rate(self, now_ns: int) -> None:
        rate, is_draining = self._rate, self._trip.is_draining
        if rate.begun_ns is None:
            return
        if now_ns - rate.begun_ns >= _SAMPLE_NS:
            # A queue that was seen before nothing was under way says nothing of what arrives meanwhile.
            has_queue = self._has_queue and not rate.was_empty
            was_limit = (rate.was_full and not rate.was_idle) or has_queue
            if not is_draining:
                rate.is_limit = was_limit
            was_limit = was_limit and not is_draining
            # How long a round trip shows a queue depends on whether the link was the limit.
            rate.take(self.acknowledged_bytes, now_ns, was_limit=was_limit, has_queue=self._has_queue)
        elif not self._flights and rate.was_idle and not is_draining:
            rate.is_limit = False
            rate.take_burst(self.acknowledged_bytes, now_ns, has_queue=self._has_queue)

    @property
    def _has_queue(self) -> bool:
        """Whether the last round trip took so long that bytes of ours, or of others, wait on the link."""
        least_ns = self._trip.least_ns or _FIRST_TRIP_NS
        return self._trip.last_ns > 2 * least_ns + self.acknowledge_period_ns + 20 * NS_PER_MS
