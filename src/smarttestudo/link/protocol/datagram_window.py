# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How many bytes may be under way as datagrams, of which a radio loses some, and how fast they may go.

A lost datagram is no sign of a full queue; a round trip that grows is. Rates are estimated as BBR does
(draft-cheng-iccrg-delivery-rate-estimation): over a round trip, by the longer of the times in which the bytes
were sent and in which they arrived, so that what jitter brings together is not taken for more.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.link.protocol.window import START_BYTES_PER_S, LeastOfWindow, Window

_PHASES = (1.25, 0.75, 1.0, 1.0, 1.0, 1.0)
"""How much faster than the link delivers datagrams go, one phase after the other.

Where more than a fifth of them is lost, the faster phase finds less than what was known: the rate falls.
"""
_LEAST_PHASE_NS = 60 * NS_PER_MS
_COUNTED_PHASES = 8
"""For so many phases a rate counts."""
_GROWING = 2.0
_GROWTH = 1.1
"""A link that delivers so much more than before is filled faster and faster."""
_FULL_ROUNDS = 3
"""After so many rounds without that it is full."""
_FALL = 0.7
_SMALL_NS = 15 * NS_PER_MS
"""How much of the link small messages may take in advance, so that they wait for no part of a large one."""
_LEAST_BYTES_PER_S = 5_000.0
"""No radio that is worth a session carries less, however much it loses."""
_BURST_NS = 20 * NS_PER_MS
"""How much of the link may go at once: no thread wakes at the right time always."""
_JITTER_NS = 20 * NS_PER_MS
"""A round trip that is longer by so much, and by a quarter, has a queue in it."""
_AHEAD = 1.1
_PROBE_AHEAD = 1.5
_TRIPS = 8
"""Of so many round trips the mean is taken."""
_TRIPS_WINDOW_NS = 10 * NS_PER_S
_MOST_ROUND_NS = 200 * NS_PER_MS


class DatagramState(NamedTuple):
    """The state of the window as a datagram was sent.

    So much ``arrived_bytes`` had arrived, the last of it at ``arrived_ns``, which was sent at
    ``first_sent_ns``. ``is_limited`` says that more waited than could be sent.
    """

    sent_ns: int
    arrived_bytes: int
    arrived_ns: int
    first_sent_ns: int
    is_limited: bool


class DatagramWindow(Window):
    """The bytes of one session by datagrams that may be under way, and when the next may go."""

    def __init__(self, capacity_bytes_per_s: float = START_BYTES_PER_S, *, is_measured: bool = False) -> None:
        super().__init__(capacity_bytes_per_s, is_measured=is_measured)
        self.lost_bytes = 0
        """Bytes that are under way no more, and have not arrived."""
        self.free_ns = 0
        """From when on the next datagram may go."""
        self._since_ns: int | None = None
        """Since when datagrams are under way and none of them has arrived."""
        self._trips_ns: list[int] = []
        self._means = LeastOfWindow(_TRIPS_WINDOW_NS)
        self._mean_trip_ns: int | None = None
        """The least of the mean round trips of the last seconds, with jitter and without a queue."""
        self._arrived_ns = self._first_sent_ns = 0
        self._idle_until_bytes = 0
        """What arrives up to there was sent while nothing waited."""
        self._rates = deque([(0, capacity_bytes_per_s)])
        self._limited_ns = 0
        self._round_end_bytes = 0
        self._known_bytes_per_s = 0.0
        self._full_rounds = 0
        self._was_full = False
        self._phase = 0
        self._phase_end_ns = 0

    @property
    def in_flight_bytes(self) -> int:
        return self.sent_bytes - self.acknowledged_bytes - self.lost_bytes

    @property
    def waiting_since_ns(self) -> int | None:
        return self._since_ns

    @property
    def is_growing(self) -> bool:
        """Whether it is not known yet how much the link carries, and there is no queue."""
        least_ns = self._least_trip_ns if self._mean_trip_ns is None else self._mean_trip_ns
        most_ns = 1.25 * least_ns + self.acknowledge_period_ns + _JITTER_NS
        if self._trip.last_ns > most_ns:
            self._full_rounds = _FULL_ROUNDS
        return self._full_rounds < _FULL_ROUNDS

    def idle(self) -> None:
        """Note that nothing waits to be sent: what is delivered meanwhile says little about the link."""
        self._idle_until_bytes = self.acknowledged_bytes + self.in_flight_bytes

    def may_send(self, now_ns: int, *, is_small: bool) -> bool:
        """Whether a datagram may go now; one of a small message also a little before its time."""
        ahead_ns = _SMALL_NS if is_small else 0
        ahead_bytes = int(self.capacity_bytes_per_s * ahead_ns / NS_PER_S)
        return self.in_flight_bytes < self.size_bytes + ahead_bytes and now_ns >= self.free_ns - ahead_ns

    def limited(self) -> None:
        """Note that there is more to send than room."""
        self._was_full = True

    def sent_datagram(self, size_bytes: int, now_ns: int) -> DatagramState:
        """Count a datagram; the state that tells of the link once it arrives."""
        if not self.in_flight_bytes:
            self._arrived_ns = self._first_sent_ns = now_ns
        self.sent_bytes += size_bytes
        if self._since_ns is None:
            self._since_ns = now_ns
        if now_ns - self.free_ns > 2 * _BURST_NS and not self._was_full:
            # The thread came late, and less was sent than might have been.
            self.idle()
        self._was_full = False
        gain = self._gain(now_ns)
        takes_ns = int(size_bytes * NS_PER_S / (self.capacity_bytes_per_s * gain))
        self.free_ns = max(self.free_ns, now_ns - _BURST_NS) + takes_ns
        is_limited = self.acknowledged_bytes >= self._idle_until_bytes
        return DatagramState(
            now_ns, self.acknowledged_bytes, self._arrived_ns, self._first_sent_ns, is_limited
        )

    def arrived(
        self, size_bytes: int, newest: DatagramState | None, now_ns: int, behind_ns: int | None
    ) -> None:
        """Datagrams of so many bytes arrived; ``newest`` is of the one sent last of all, if it is there.

        Of those sent after it the first was at ``behind_ns``.
        """
        self._size_bytes = None
        self.acknowledged_bytes += size_bytes
        if not size_bytes:
            return
        self._acknowledged_ns = now_ns
        self._since_ns = behind_ns
        if newest is not None:
            self._take_trip(now_ns - newest.sent_ns, now_ns)
            self._note_trip(now_ns - newest.sent_ns, now_ns)
            self._first_sent_ns = newest.sent_ns
            self._sample(newest, now_ns)
        self._arrived_ns = now_ns

    def lose(self, size_bytes: int) -> None:
        """Datagrams of so many bytes are under way no more."""
        self.lost_bytes += size_bytes

    def found(self, size_bytes: int) -> None:
        """Datagrams of so many bytes were not lost after all; they have ``arrived``."""
        self.lost_bytes -= size_bytes

    def rest(self) -> None:
        """Note that nothing of what is lost is waited for."""
        if self.in_flight_bytes <= 0:
            self._since_ns = None

    def _note_trip(self, trip_ns: int, now_ns: int) -> None:
        self._trips_ns.append(trip_ns)
        if len(self._trips_ns) >= _TRIPS:
            self._mean_trip_ns = self._means.add(sum(self._trips_ns) // len(self._trips_ns), now_ns)
            self._trips_ns.clear()

    @property
    def _ahead_s(self) -> float:
        mean_ns = self._mean_trip_ns
        if mean_ns is None or self._trip.is_draining:
            return super()._ahead_s
        # Half of what jitter takes longer would else be time in which nothing may go.
        is_probe = _PHASES[self._phase] > 1
        gain = _GROWING if self.is_growing else _PROBE_AHEAD if is_probe else _AHEAD
        return (gain * mean_ns + self.acknowledge_period_ns) / NS_PER_S

    def _gain(self, now_ns: int) -> float:
        if now_ns >= self._phase_end_ns:
            self._phase = (self._phase + 1) % len(_PHASES)
            self._phase_end_ns = now_ns + self._phase_ns
        return _GROWING if self.is_growing else _PHASES[self._phase]

    @property
    def _phase_ns(self) -> int:
        return max(_LEAST_PHASE_NS, self._least_trip_ns + self.acknowledge_period_ns)

    def _sample(self, newest: DatagramState, now_ns: int) -> None:
        """Learn from what arrived since ``newest`` was sent."""
        span_ns = max(newest.sent_ns - newest.first_sent_ns, now_ns - newest.arrived_ns)
        if span_ns < max(self._least_trip_ns // 2, NS_PER_MS) or self._trip.is_draining:
            return
        arrived_bytes = self.acknowledged_bytes - newest.arrived_bytes + self._rate.beside_bytes
        self._rate.beside_bytes = 0
        rate = max(arrived_bytes * NS_PER_S / span_ns, _LEAST_BYTES_PER_S)
        self._rate.is_limit = newest.is_limited
        if newest.is_limited:
            self._rate.is_measured = True
            self._limited_ns += min(now_ns - self._arrived_ns, _MOST_ROUND_NS)
        elif rate <= self.capacity_bytes_per_s:
            return
        self._keep(rate)
        if newest.arrived_bytes >= self._round_end_bytes:
            self._round_end_bytes = self.acknowledged_bytes + self.in_flight_bytes
            self._end_round(rate, is_limited=newest.is_limited)

    def _keep(self, rate: float) -> None:
        while self._rates and self._rates[-1][1] <= rate:
            self._rates.pop()
        self._rates.append((self._limited_ns, rate))
        while self._rates[0][0] < self._limited_ns - _COUNTED_PHASES * self._phase_ns:
            self._rates.popleft()
        self._rate.bytes_per_s = self._rates[0][1]

    def _end_round(self, rate: float, *, is_limited: bool) -> None:
        capacity = self.capacity_bytes_per_s
        if is_limited and self._has_queue and rate < _FALL * capacity:
            self._rates.clear()
            self._keep(rate)
        elif capacity > _GROWTH * self._known_bytes_per_s:
            # What helped is done again at once.
            self._known_bytes_per_s, self._phase, self._phase_end_ns = capacity, -1, 0
            if self._full_rounds < _FULL_ROUNDS:
                self._full_rounds = 0
            return
        elif is_limited:
            self._full_rounds += 1 if self.is_growing else _FULL_ROUNDS
        self._known_bytes_per_s = min(self._known_bytes_per_s, self.capacity_bytes_per_s)

    def raise_capacity(self, bytes_per_s: float) -> None:
        """The link was seen to carry more than was known."""
        self._size_bytes = None
        self._keep(bytes_per_s)
