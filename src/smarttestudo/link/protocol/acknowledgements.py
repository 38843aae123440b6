# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Acknowledgements: how much of each session arrived at an operator's end."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.chunks import SESSION_OFFSETS, Chunk

MAX_LOST_SPANS = 16
"""How many spans of one session are told apart; of more, the first two become one."""
MAX_ENDED = 8
"""Of how many sessions before the newest it is told what arrived."""
ENDED_TOLD_NS = 20 * NS_PER_S
"""For how long that is told; the robot's end sends nothing for so long that is not acknowledged."""


class LostSpan(NamedTuple):
    """Messages that are lost: those whose last chunk ends after ``after_bytes`` and up to ``until_bytes``."""

    after_bytes: int
    until_bytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Acknowledgement:
    """The chunks of a session that arrived: those up to ``received_bytes``.

    Messages in ``lost`` came too late to be delivered. Where it ``is_cut``, the next chunks are missing, and
    none is taken that follows on them. ``session`` is 0 where there is none.
    """

    session: int
    received_bytes: int
    lost: Sequence[LostSpan] = ()
    is_cut: bool = False

    def has(self, end_bytes: int) -> bool:
        """Whether the message arrived whose last chunk ends there."""
        return end_bytes <= self.received_bytes and not any(
            span.after_bytes < end_bytes <= span.until_bytes for span in self.lost
        )


NOTHING_RECEIVED = Acknowledgement(session=0, received_bytes=0)
"""The state before the first session."""


class ReceivedSessions:
    """Keeps of the chunks that arrive what is to be acknowledged."""

    def __init__(self) -> None:
        self.session = 0
        """The newest session; 0 before the first."""
        self.received_bytes = 0
        """Up to where its chunks came."""
        self._begin_bytes = 0
        self._lost: list[LostSpan] = []
        self._is_cut = False
        self._ended: deque[tuple[int, Acknowledgement]] = deque(maxlen=MAX_ENDED)
        """The sessions before it, each with when the first chunk after it was sent."""

    def on_chunk(self, chunk: Chunk, size_bytes: int) -> bool:
        """A chunk of so many bytes came; whether it follows on the last one, or begins a session."""
        if chunk.session < self.session:
            return False
        if chunk.session > self.session:
            self._begin(chunk)
        while self._ended and chunk.sent_ns - self._ended[0][0] > ENDED_TOLD_NS:
            self._ended.popleft()
        ahead_bytes = (chunk.session_offset - self.received_bytes) % SESSION_OFFSETS
        self._is_cut |= 0 < ahead_bytes < SESSION_OFFSETS // 2
        if ahead_bytes or self._is_cut:
            return False
        self._begin_bytes = self.received_bytes
        self.received_bytes += size_bytes
        return True

    def lack(self) -> None:
        """The message that ends with the last chunk is lost."""
        span = LostSpan(self._begin_bytes, self.received_bytes)
        if self._lost and self._lost[-1].until_bytes == span.after_bytes:
            span = LostSpan(self._lost.pop().after_bytes, span.until_bytes)
        self._lost.append(span)
        if len(self._lost) > MAX_LOST_SPANS:
            # What arrived between them is rather kept by the robot as well than nowhere.
            first, second = self._lost[:2]
            self._lost[:2] = [LostSpan(first.after_bytes, second.until_bytes)]

    @property
    def newest(self) -> Acknowledgement:
        """The acknowledgement of the newest session."""
        return Acknowledgement(
            session=self.session,
            received_bytes=self.received_bytes,
            lost=tuple(self._lost),
            is_cut=self._is_cut,
        )

    @property
    def ended(self) -> tuple[Acknowledgement, ...]:
        """The acknowledgements of the sessions before it, the oldest first."""
        return tuple([one for _, one in self._ended])

    def _begin(self, chunk: Chunk) -> None:
        if self.session:
            self._ended.append((chunk.sent_ns, self.newest))
        # Who has heard nothing yet may come in the middle of a session.
        self.received_bytes = 0 if self.session else chunk.session_offset
        self.session, self._lost, self._is_cut = chunk.session, [], False
