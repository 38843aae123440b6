# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The order in which the operator's end asks for an incident, and for what got lost."""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from dataclasses import dataclass

from smarttestudo.domain.units import NS_PER_MS
from smarttestudo.link.transfer.messages import MAX_ASK_BYTES, TransferPiece

_FIRST_ASK_BYTES = 1_200
_FIRST_WIDTH = 2
_MOST_WIDTH = 64
_ENOUGH_WAITING = 3
"""So many asks that wait at the robot's end are never all answered before the next one is there."""
_AGAIN_AFTER_NS = 500 * NS_PER_MS


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RangeAsk:
    """A question under way, for ``size_bytes`` of the order from ``start`` on."""

    start: int
    size_bytes: int
    asked_ns: int


class Fetching:
    """The state of one fetch, in the time that is passed in: bytes up to ``cursor`` are there.

    The driver sends what ``asks`` gives, tells of each ask once what came of it (``answered``), and takes
    what follows on the bytes that are there (``pieces``). As many asks are under way as keep some waiting at
    the robot's end, whatever the round trip.
    """

    def __init__(self, total_bytes: int, cursor: int = 0) -> None:
        self.cursor = cursor
        self.total_bytes = total_bytes
        self.got_bytes = 0
        """Bytes that travelled, of all answers."""
        self._said_bytes = 0
        self._next = cursor
        self._gaps: list[tuple[int, int]] = []
        self._under_way = 0
        self._ready: dict[int, TransferPiece] = {}
        self._width = _FIRST_WIDTH
        self._ask_bytes = _FIRST_ASK_BYTES
        self._hold_until_ns = 0

    @property
    def is_complete(self) -> bool:
        """Whether all is there."""
        return self.cursor >= self.total_bytes

    @property
    def is_unanswered(self) -> bool:
        """Whether the last ask got no answer."""
        return self._hold_until_ns > 0

    @property
    def waiting_bytes(self) -> int:
        """Bytes that arrived before those that they follow on."""
        return sum(piece.covered_bytes for piece in self._ready.values())

    @property
    def wake_ns(self) -> int | None:
        """When to ask again though nothing arrived; ``None`` while an answer is waited for."""
        return self._hold_until_ns if self._under_way == 0 and not self.is_complete else None

    def asks(self, now_ns: int) -> Iterator[RangeAsk]:
        """The ranges to ask for now."""
        while now_ns >= self._hold_until_ns and self._under_way < self._width:
            if self._gaps:
                start, size_bytes = heapq.heappop(self._gaps)
            elif self._next < self.total_bytes and self._under_way + len(self._ready) < _MOST_WIDTH:
                start, size_bytes = self._next, min(self._ask_bytes, self.total_bytes - self._next)
                self._next += size_bytes
            else:
                return
            self._under_way += 1
            self._said_bytes = self.got_bytes
            yield RangeAsk(start=start, size_bytes=size_bytes, asked_ns=now_ns)

    def unsaid(self) -> bool:
        """Whether the robot's end is to be told of ``got_bytes`` though nothing is asked; to be told then."""
        is_unsaid, self._said_bytes = self._said_bytes != self.got_bytes, self.got_bytes
        return is_unsaid

    def answered(self, ask: RangeAsk, piece: TransferPiece | None, travelled_bytes: int, now_ns: int) -> None:
        """Note what came of an ask; ``None`` where nothing did, which is asked again soon."""
        self._under_way -= 1
        if piece is None:
            heapq.heappush(self._gaps, (ask.start, ask.size_bytes))
            self._hold_until_ns = now_ns + _AGAIN_AFTER_NS
            self._width = _FIRST_WIDTH
            return
        self._hold_until_ns = 0
        self.got_bytes += travelled_bytes
        covered = piece.covered_bytes
        if covered < ask.size_bytes:
            heapq.heappush(self._gaps, (ask.start + covered, ask.size_bytes - covered))
        self._ready[ask.start] = piece
        self._ask_bytes = min(piece.advised_bytes, MAX_ASK_BYTES)
        if piece.waiting < _ENOUGH_WAITING:
            self._width = min(self._width + 1, _MOST_WIDTH)
        elif piece.waiting > 2 * _ENOUGH_WAITING:
            self._width = max(self._width - 1, _FIRST_WIDTH)

    def pieces(self) -> Iterator[TransferPiece]:
        """The pieces that follow on the bytes that are there, which they then belong to."""
        while (piece := self._ready.pop(self.cursor, None)) is not None:
            self.cursor += piece.covered_bytes
            yield piece
