# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One direction of a radio as a model of time: rate, queue, delay, jitter, and packets lost in runs.

The model reads no clock. Laws drive it in virtual time, the emulator of links in real time.
"""

from __future__ import annotations

import heapq
import itertools
import math
import random
from collections import deque
from dataclasses import dataclass
from typing import Generic, TypeVar

_NS_PER_MS = 1e6
_BIT_NS = 8e9
_LATE_NS = 20e6
"""By up to so much a packet comes later than its turn, if it is out of order or a copy."""
_QUEUE_S = 0.4
_Packet = TypeVar("_Packet")


@dataclass(frozen=True, slots=True, kw_only=True)
class PathConditions:
    """The conditions of a path, which are those of one direction.

    Packets wait in a queue of ``queue_bytes``, and what does not fit is dropped. At rate 0 they wait on. Each
    takes ``delay_ms`` give or take up to ``jitter_ms``, and stays behind those before it, but for the share
    ``reordered``. Losses are a Gilbert model: the share ``loss`` of the packets, in runs of
    ``loss_run_packets`` on the average, which take the radio's time all the same. A loss of 1 is a dead spot.
    """

    rate_bits_per_s: float
    queue_bytes: int = 64_000
    delay_ms: float = 0.0
    jitter_ms: float = 0.0
    loss: float = 0.0
    loss_run_packets: float = 3.0
    reordered: float = 0.0
    duplicated: float = 0.0
    mtu_bytes: int = 1_500
    blocks_udp: bool = False


def wire(bits_per_s: float) -> PathConditions:
    """A path that loses nothing and is as short as it can be, with a queue of 400 ms."""
    return PathConditions(rate_bits_per_s=bits_per_s, queue_bytes=int(bits_per_s / 8 * _QUEUE_S))


@dataclass(slots=True, kw_only=True)
class PathCounts:
    """Packets of one direction so far, by what became of them, and the bytes that arrived."""

    arrived: int = 0
    arrived_bytes: int = 0
    lost: int = 0
    overflowed: int = 0
    duplicated: int = 0
    too_large: int = 0
    blocked: int = 0


class EmulatedPath(Generic[_Packet]):
    """Carries packets as ``PathConditions`` say, the same ones again for the same ``seed``. Times never fall.

    The driver puts packets, waits until ``wake_ns`` and takes what has arrived.
    """

    def __init__(self, conditions: PathConditions, seed: int = 1) -> None:
        self.conditions = conditions
        self.counts = PathCounts()
        self._random = random.Random(seed)
        self._queue: deque[tuple[_Packet, int]] = deque()
        self._queued_bytes = 0
        self._left_bytes = 0.0
        """The bytes still to be sent of the first of the queue, as of ``_from_ns``."""
        self._from_ns = 0.0
        self._under_way: list[tuple[float, int, _Packet, int]] = []
        self._order = itertools.count()
        self._last_ns = 0.0
        """When the last packet arrives that keeps the order."""
        self._is_losing = False

    @property
    def wake_ns(self) -> int | None:
        """When the next packet leaves the queue or arrives; ``None`` while none ever will."""
        times = [self._sent_ns] if self._queue else []
        if self._under_way:
            times.append(self._under_way[0][0])
        next_ns = min(times, default=math.inf)
        return None if next_ns == math.inf else math.ceil(next_ns)

    def change(self, conditions: PathConditions, now_ns: int) -> None:
        """Let other conditions hold from now on, also for what waits."""
        self._send(now_ns)
        if self._queue:
            self._left_bytes -= (now_ns - self._from_ns) * self.conditions.rate_bits_per_s / _BIT_NS
            self._from_ns = now_ns
        self.conditions = conditions

    def put(self, packet: _Packet, size_bytes: int, now_ns: int, *, is_udp: bool = False) -> None:
        """Have a packet of so many bytes sent, headers included."""
        self._send(now_ns)
        if is_udp and self.conditions.blocks_udp:
            self.counts.blocked += 1
        elif size_bytes > self.conditions.mtu_bytes:
            self.counts.too_large += 1
        elif self._queued_bytes + size_bytes > self.conditions.queue_bytes:
            self.counts.overflowed += 1
        else:
            self._queue.append((packet, size_bytes))
            self._queued_bytes += size_bytes
            if len(self._queue) == 1:
                self._left_bytes, self._from_ns = size_bytes, now_ns

    def take(self, now_ns: int) -> list[_Packet]:
        """All packets that have arrived by now and were not taken before, in the order of their arrival."""
        self._send(now_ns)
        arrived = []
        while self._under_way and self._under_way[0][0] <= now_ns:
            _, _, packet, size_bytes = heapq.heappop(self._under_way)
            self.counts.arrived += 1
            self.counts.arrived_bytes += size_bytes
            arrived.append(packet)
        return arrived

    @property
    def _sent_ns(self) -> float:
        """When the last byte of the first packet in the queue is sent."""
        rate = self.conditions.rate_bits_per_s
        return self._from_ns + self._left_bytes * _BIT_NS / rate if rate else math.inf

    def _send(self, now_ns: int) -> None:
        while self._queue and (sent_ns := self._sent_ns) <= now_ns:
            packet, size_bytes = self._queue.popleft()
            self._queued_bytes -= size_bytes
            if self._queue:
                self._left_bytes, self._from_ns = self._queue[0][1], sent_ns
            self._leave(packet, size_bytes, sent_ns)

    def _leave(self, packet: _Packet, size_bytes: int, sent_ns: float) -> None:
        if self._loses():
            self.counts.lost += 1
            return
        conditions = self.conditions
        jitter_ms = self._random.uniform(-conditions.jitter_ms, conditions.jitter_ms)
        at_ns = sent_ns + max(0.0, conditions.delay_ms + jitter_ms) * _NS_PER_MS
        if self._random.random() < conditions.reordered:
            at_ns += self._random.uniform(0, _LATE_NS)
        else:
            at_ns = self._last_ns = max(self._last_ns, at_ns)
        self._arrive_at(at_ns, packet, size_bytes)
        if self._random.random() < conditions.duplicated:
            self.counts.duplicated += 1
            self._arrive_at(at_ns + self._random.uniform(0, _LATE_NS), packet, size_bytes)

    def _loses(self) -> bool:
        """Whether the next packet is lost, by a Gilbert model."""
        loss = self.conditions.loss
        if loss >= 1:
            self._is_losing = True
            return True
        # Packets that are lost independently of each other are lost in runs of this length, too.
        run_packets = max(self.conditions.loss_run_packets, 1 / (1 - loss))
        begins = loss / (1 - loss) / run_packets
        drawn = self._random.random()
        self._is_losing = drawn >= 1 / run_packets if self._is_losing else drawn < begins
        return self._is_losing

    def _arrive_at(self, at_ns: float, packet: _Packet, size_bytes: int) -> None:
        heapq.heappush(self._under_way, (at_ns, next(self._order), packet, size_bytes))
