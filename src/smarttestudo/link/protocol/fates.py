# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages with an origin that are not sent, or not known to arrive: which of them were missed."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from smarttestudo.domain.link import MissedMessage
from smarttestudo.link.protocol.chunks import Acknowledgement
from smarttestudo.link.protocol.outgoing_stream import OutgoingMessage

MAX_GIVEN_UP_BYTES = 16_000_000
"""The size of all messages kept that gave way, until something arrives; the oldest beyond it are missed."""
MAX_UNSETTLED_BYTES = 16_000_000
"""The size of all messages of ended sessions of which it is not known whether they arrived."""

Ends = Sequence[Sequence[int]]
"""Where each part of a message ends in its session, each time that it was sent."""


class _EndedSession(NamedTuple):
    number: int
    messages: list[tuple[Ends, OutgoingMessage]]


class Fates:
    """Messages that gave way, or were under way as a session ended, until it is known who missed them.

    What gives way while nothing arrives at the other end is ``missed`` there, and so is what was under way
    as a session ended and had not arrived by then, as the other end says in the next (``settle``).
    """

    def __init__(self) -> None:
        self.had_session = False
        self.missed: deque[MissedMessage] = deque()
        """Missed messages with an origin, to be taken from here."""
        self._ended: deque[_EndedSession] = deque()
        self._ended_bytes = 0
        self._given_up: deque[OutgoingMessage] = deque()
        self._given_up_bytes = 0
        self.is_cut = False
        """Whether nothing arrives at the other end now."""
        self._waited_before_ns = 0

    def give_up(self, *messages: OutgoingMessage) -> None:
        """Count messages that are not sent, or not known to arrive, as given up."""
        for message in messages:
            if message.origin is None or not self.had_session:
                continue
            if self.is_cut or message.offered_ns < self._waited_before_ns:
                self.miss(message)
                continue
            self._given_up.append(message)
            self._given_up_bytes += len(message.payload)
        self._miss_given_up(MAX_GIVEN_UP_BYTES)

    def miss(self, *messages: OutgoingMessage) -> None:
        for message in messages:
            if message.unsettled:
                # It may have arrived; it is not sent again.
                message.is_kept = False
            elif message.origin is not None:
                self.missed.append(MissedMessage(origin=message.origin, payload=message.payload))
                message.origin = None

    def cut(self) -> None:
        """Count as missed what gave way since something arrived, and what does until the next."""
        if self.had_session:
            self.is_cut = True
            self._miss_given_up()

    def on_arrival(self) -> None:
        """Something arrived: newer messages went before what gave way until now."""
        self.is_cut = False
        self._given_up.clear()
        self._given_up_bytes = 0

    def end_session(
        self, number: int, under_way: Iterable[tuple[Ends, OutgoingMessage]], now_ns: int
    ) -> None:
        """A session is over, in which these messages were under way."""
        self._miss_given_up()
        ended = _EndedSession(number, [])
        for ends, message in under_way:
            if message.origin is not None:
                ended.messages.append((ends, message))
                message.unsettled += 1
                self._ended_bytes += len(message.payload)
        if ended.messages:
            self._ended.append(ended)
        while self._ended_bytes > MAX_UNSETTLED_BYTES:
            self._settle_first(None)
        # What waited in the outage, and gives way because so much did, was missed as well.
        self._waited_before_ns = now_ns if self.had_session else 0
        self.had_session, self.is_cut = True, False

    def settle(self, session: int, ended: Iterable[Acknowledgement]) -> None:
        """The other end is in ``session``; of those before it has what ``ended`` says, of others nothing."""
        arrived = {one.session: one for one in ended}
        while self._ended and self._ended[0].number < session:
            self._settle_first(arrived.get(self._ended[0].number))

    def settle_all(self) -> None:
        """Count all of ended sessions as lost: no report of them will come."""
        while self._ended:
            self._settle_first(None)

    @property
    def is_settled(self) -> bool:
        """Whether it is known what arrived of ended sessions."""
        return not self._ended

    def _settle_first(self, arrived: Acknowledgement | None) -> None:
        for ends, message in self._ended.popleft().messages:
            self._ended_bytes -= len(message.payload)
            message.unsettled -= 1
            if arrived is not None and all(any(map(arrived.has, copies)) for copies in ends):
                message.origin = None
            elif not message.is_kept:
                self.miss(message)

    def _miss_given_up(self, most_bytes: int = -1) -> None:
        """The oldest beyond so many bytes were missed, or all."""
        while self._given_up and self._given_up_bytes > most_bytes:
            message = self._given_up.popleft()
            self._given_up_bytes -= len(message.payload)
            self.miss(message)
