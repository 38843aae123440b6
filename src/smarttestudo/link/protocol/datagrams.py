# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of both ends about datagrams: who asks for a key, the key, and whether they come through."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.wire import FrameType, Kind

DATAGRAM_VERSION = 1
"""Ends of other versions have no datagrams with each other."""
CONNECTION_BYTES = 8
KEY_BYTES = 32
PING_PERIOD_NS = NS_PER_S // 2
UNHEARD_AFTER_NS = 3 * NS_PER_S
"""A path from which nothing came back for so long carries no datagrams."""
FORGOTTEN_AFTER_NS = 60 * NS_PER_S
"""A robot's end forgets who answered nothing for so long; whoever heard nothing asks for another key."""
_MOST_PINGS = 64
_MOST_LOST = 2
"""More pings that are lost one after the other met an outage."""
WINDOW = 4_096
"""A datagram that comes after so many later ones is refused, as is one that came before."""

_MAX_PORT = 65_535


@dataclass(frozen=True, slots=True, kw_only=True)
class DatagramRequest:
    """An operator's end asks for a key; it takes datagrams at ``port`` of where it listens, if it does."""

    receiver: int
    version: int
    port: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class DatagramOffer:
    """The key of one connection, and at which ``port`` the robot's end takes datagrams where it listens."""

    version: int
    connection: bytes
    key: bytes
    port: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Ping:
    """Asks whether datagrams come through; the other end says the same in a ``Pong``."""

    sent_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Pong:
    """The answer to the ``Ping`` that was sent then."""

    sent_ns: int


def _check_request(request: DatagramRequest) -> None:
    _require_port(request.port)


def _check_offer(offer: DatagramOffer) -> None:
    _require_port(offer.port)
    if len(offer.connection) != CONNECTION_BYTES or len(offer.key) != KEY_BYTES:
        raise ValueError("no key")


def _require_port(port: int | None) -> None:
    if port is not None and not 0 < port <= _MAX_PORT:
        raise ValueError("no port")


DATAGRAM_REQUESTS: FrameType[DatagramRequest] = FrameType(
    Kind.DATAGRAM_REQUEST, DatagramRequest, _check_request, most_bytes=100
)
DATAGRAM_OFFERS: FrameType[DatagramOffer] = FrameType(
    Kind.DATAGRAM_OFFER, DatagramOffer, _check_offer, most_bytes=200
)
PINGS: FrameType[Ping | Pong] = FrameType(Kind.PING, Ping | Pong, most_bytes=50)


class PingLosses:
    """The pings to one peer that have no answer, and how many of them are lost."""

    def __init__(self) -> None:
        self._sent_ns: deque[int] = deque(maxlen=_MOST_PINGS)

    def ask(self, sent_ns: int) -> None:
        self._sent_ns.append(sent_ns)

    def answer(self, sent_ns: int) -> tuple[int, int]:
        """How many were sent up to the one that is answered, and how many of them are lost.

        Many in a row met an outage, which is no loss: they are not counted.
        """
        asked = sum(one <= sent_ns for one in self._sent_ns)
        for _ in range(asked):
            self._sent_ns.popleft()
        return (asked, asked - 1) if 0 < asked <= _MOST_LOST + 1 else (0, 0)


class ReplayWindow:
    """The numbers of datagrams that came: each is taken once, and none that is too old to know."""

    def __init__(self) -> None:
        self.newest = -1
        self._seen = 0

    def take(self, number: int) -> bool:
        """Whether the datagram of that number came for the first time; it is authentic."""
        if number > self.newest:
            ahead = number - self.newest
            self._seen = (self._seen << ahead | 1) & ((1 << WINDOW) - 1) if ahead < WINDOW else 1
            self.newest = number
            return True
        behind = self.newest - number
        if behind >= WINDOW or self._seen >> behind & 1:
            return False
        self._seen |= 1 << behind
        return True
