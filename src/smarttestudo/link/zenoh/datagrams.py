# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Sealed datagrams beside a link, on a socket of our own: the only importer of ``cryptography``."""

from __future__ import annotations

import secrets
import socket
import struct
import threading
from collections.abc import Callable
from contextlib import ExitStack, closing, suppress
from dataclasses import dataclass, field

from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import ChaCha20Poly1305

from smarttestudo.domain.errors import LinkError, said
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.datagrams import (
    CONNECTION_BYTES,
    FORGOTTEN_AFTER_NS,
    KEY_BYTES,
    PING_PERIOD_NS,
    PINGS,
    UNHEARD_AFTER_NS,
    DatagramOffer,
    Ping,
    PingLosses,
    Pong,
    ReplayWindow,
)
from smarttestudo.link.protocol.wire import HEAD_BYTES, Kind
from smarttestudo.link.worker import Worker
from smarttestudo.link.zenoh.security import LinkOptions, datagram_locators

MAX_PEERS = 256
_MOST_BYTES = 2_048
_BUFFER_BYTES = 2_000_000
_HEAD = struct.Struct(f">{CONNECTION_BYTES}sQ")
_NONCE = struct.Struct(">IQ")
_DSCP_SHIFT = 2
_RECEIVE_S = 0.5

Address = tuple[str, int] | tuple[str, int, int, int]


class Seal:
    """Seals datagrams of one connection, and opens those of the other end, each once.

    A datagram is the connection, its number, and what is sealed with the number as nonce: so none can be
    read, changed, made up or sent again.
    """

    def __init__(self, connection: bytes, key: bytes, *, is_robot: bool) -> None:
        self._connection = connection
        self._cipher = ChaCha20Poly1305(key)
        self._own, self._other = (0, 1) if is_robot else (1, 0)
        self._next = 0
        self._window = ReplayWindow()
        self._lock = threading.Lock()

    def seal(self, data: bytes) -> bytes:
        with self._lock:
            number, self._next = self._next, self._next + 1
        head = _HEAD.pack(self._connection, number)
        return head + self._cipher.encrypt(_NONCE.pack(self._own, number), data, head)

    def open(self, datagram: bytes) -> tuple[bytes, bool] | None:
        """The text that was sealed, and whether it is the newest; ``None`` where nobody has the seal."""
        head = datagram[: _HEAD.size]
        _, number = _HEAD.unpack(head)
        try:
            data = self._cipher.decrypt(_NONCE.pack(self._other, number), datagram[_HEAD.size :], head)
        except InvalidTag:
            return None
        is_newest = number > self._window.newest
        return (data, is_newest) if self._window.take(number) else None


@dataclass(slots=True, eq=False)
class Peer:
    """One connection. It is found at one of ``candidates``, or where its newest datagram came from."""

    name: str
    seal: Seal
    candidates: list[Address]
    added_ns: int
    address: Address | None = None
    heard_ns: int | None = None
    """When the last datagram came from it, and when it ``answered``; ``None`` before the first."""
    answered_ns: int | None = None
    pings: PingLosses = field(default_factory=PingLosses)
    is_reached: bool = False


class Datagrams:
    """The datagrams of one end. A thread receives them; another asks whether they come through.

    ``on_data`` is given what peers sent, ``on_reached`` the names of those who answer, each time that this
    changes, ``on_pings`` how many asked since the last answer and how many of them were lost; all from these
    threads. Raises ``LinkError`` where the socket cannot be opened.
    """

    def __init__(
        self,
        options: LinkOptions,
        clock: Callable[[], int],
        on_data: Callable[[Peer, bytes], None],
        on_reached: Callable[[frozenset[str]], None],
        warn: Callable[[str], None],
        *,
        is_robot: bool,
        on_pings: Callable[[int, int], None] | None = None,
    ) -> None:
        self.refused = 0
        """Datagrams that nobody here has the key for, or that came before."""
        self._clock = clock
        self._on_data = on_data
        self._on_reached = on_reached
        self._on_pings = on_pings
        self._warn = warn
        self._said_unreached = False
        self._is_robot = is_robot
        self._hosts = [locator.host for locator in datagram_locators(options, options.connect)]
        self._peers: dict[bytes, Peer] = {}
        self._lock = threading.Lock()
        listening = datagram_locators(options, options.listen)
        host, port = (listening[0].host, int(listening[0].port)) if listening else ("", 0)
        self._socket = _open_socket(
            host or (self._hosts[0] if self._hosts else ""),
            host,
            options.datagrams_port or port,
            options.dscp,
        )
        self.port: int | None = self._socket.getsockname()[1] if listening else None
        """Where others send to; ``None`` where this end only connects."""
        self._is_closed = False
        self._thread = threading.Thread(target=self._receive, name="link-datagrams", daemon=True)
        self._pings = Worker("link-pings", lambda error: warn(f"no datagrams: {said(error)}"), self._ping)
        self._thread.start()
        self._pings.start()

    def offer(self, name: str, version: int, port: int | None) -> DatagramOffer:
        """A key for a peer that takes datagrams at ``port`` of where this end connects to."""
        connection, key = secrets.token_bytes(CONNECTION_BYTES), secrets.token_bytes(KEY_BYTES)
        self.add(name, connection, key, port)
        return DatagramOffer(version=version, connection=connection, key=key, port=self.port)

    def add(self, name: str, connection: bytes, key: bytes, port: int | None) -> None:
        """Have a peer, instead of what was known by that name."""
        seal = Seal(connection, key, is_robot=self._is_robot)
        candidates = [] if port is None else self._addresses(port)
        self.remove(name)
        with self._lock:
            if len(self._peers) < MAX_PEERS:
                self._peers[connection] = Peer(name, seal, candidates, self._clock())
        self._pings.wake()

    def remove(self, name: str) -> None:
        """Forget a peer."""
        with self._lock:
            gone = [(connection, peer) for connection, peer in self._peers.items() if peer.name == name]
            for connection, _ in gone:
                del self._peers[connection]
        if any(peer.is_reached for _, peer in gone):
            self._tell()

    def peer(self, name: str) -> Peer | None:
        with self._lock:
            return next((peer for peer in self._peers.values() if peer.name == name), None)

    def is_heard(self, name: str, within_ns: int) -> bool:
        """Whether a datagram came from a peer lately."""
        peer = self.peer(name)
        return peer is not None and peer.heard_ns is not None and self._clock() - peer.heard_ns <= within_ns

    def send(self, peer: Peer, data: bytes) -> None:
        """Send it to where the peer was heard; what the system does not take is lost, as on a radio."""
        if peer.address is not None:
            self._send_to(peer, data, peer.address)

    def close(self) -> None:
        self._is_closed = True
        self._pings.close()
        self._thread.join(2 * _RECEIVE_S)
        self._socket.close()

    def _addresses(self, port: int) -> list[Address]:
        found: list[Address] = []
        for host in self._hosts:
            with suppress(OSError):
                known = socket.getaddrinfo(host, port, self._socket.family, socket.SOCK_DGRAM)
                found.append(known[0][4])  # type: ignore[arg-type]
        return found

    def _send_to(self, peer: Peer, data: bytes, address: Address) -> None:
        with suppress(OSError):
            self._socket.sendto(peer.seal.seal(data), socket.MSG_DONTWAIT, address)

    def _receive(self) -> None:
        while not self._is_closed:
            try:
                datagram, address = self._socket.recvfrom(_MOST_BYTES)
            except TimeoutError:
                continue
            except OSError:
                if self._is_closed:
                    return
                # On some systems what an earlier datagram met is told here.
                continue
            peer = self._peers.get(datagram[:CONNECTION_BYTES]) if len(datagram) > _HEAD.size else None
            opened = None if peer is None else peer.seal.open(datagram)
            if peer is None or opened is None:
                self.refused += 1
                continue
            data, is_newest = opened
            peer.heard_ns = self._clock()
            if is_newest or peer.address is None:
                # Whoever moves, or whose router gives it another port, is followed.
                peer.address = address
            if data[HEAD_BYTES - 1 : HEAD_BYTES] == bytes((Kind.PING,)):
                self._on_ping(peer, data)
            else:
                self._on_data(peer, data)

    def _on_ping(self, peer: Peer, data: bytes) -> None:
        try:
            ping = PINGS.from_bytes(data)
        except LinkError:
            return
        if isinstance(ping, Ping):
            self.send(peer, PINGS.to_bytes(Pong(sent_ns=ping.sent_ns)))
            return
        peer.answered_ns = self._clock()
        sent, lost = peer.pings.answer(ping.sent_ns)
        if sent and self._on_pings is not None:
            self._on_pings(sent, lost)
        if not peer.is_reached:
            peer.is_reached = True
            self._tell()
            if self._said_unreached:
                self._said_unreached = False
                self._warn("datagrams come through again")

    def _ping(self) -> float:
        now_ns = self._clock()
        with self._lock:
            peers = list(self._peers.values())
        ping = PINGS.to_bytes(Ping(sent_ns=now_ns))
        for peer in peers:
            addresses = self._to_ping(peer)
            for address in addresses:
                self._send_to(peer, ping, address)
            if addresses:
                peer.pings.ask(now_ns)
            silent_ns = now_ns - (peer.added_ns if peer.answered_ns is None else peer.answered_ns)
            if silent_ns > UNHEARD_AFTER_NS:
                self._miss(peer)
            if self._is_robot and silent_ns > FORGOTTEN_AFTER_NS:
                # Whoever is there still asks for another key.
                self.remove(peer.name)
        return PING_PERIOD_NS / NS_PER_S

    def _to_ping(self, peer: Peer) -> set[Address]:
        if peer.address is None:
            return set(peer.candidates)
        # The robot's end must know whether they come through; another that connects keeps its way open.
        is_to_ping = self._is_robot or peer.candidates
        return {peer.address, *([] if peer.is_reached else peer.candidates)} if is_to_ping else set()

    def _miss(self, peer: Peer) -> None:
        """Nothing came back from a peer for long."""
        if peer.is_reached:
            peer.is_reached = False
            self._tell()
        if self._is_robot and not self._said_unreached:
            self._said_unreached = True
            where = f" to {peer.candidates[0][0]} port {peer.candidates[0][1]}" if peer.candidates else ""
            self._warn(
                f"no datagrams come through{where}: what is relayed goes over the reliable link meanwhile; "
                "does a firewall let UDP pass?"
            )

    def _tell(self) -> None:
        with self._lock:
            reached = frozenset(peer.name for peer in self._peers.values() if peer.is_reached)
        self._on_reached(reached)


def _open_socket(towards: str, host: str, port: int, dscp: int) -> socket.socket:
    try:
        family, _, _, _, address = socket.getaddrinfo(
            towards or None, port, type=socket.SOCK_DGRAM, flags=socket.AI_PASSIVE
        )[0]
        any_host = "::" if family == socket.AF_INET6 else "0.0.0.0"  # noqa: S104
        with ExitStack() as on_error:
            opened = on_error.enter_context(closing(socket.socket(family, socket.SOCK_DGRAM)))
            opened.settimeout(_RECEIVE_S)
            for option in (socket.SO_RCVBUF, socket.SO_SNDBUF):
                opened.setsockopt(socket.SOL_SOCKET, option, _BUFFER_BYTES)
            if family == socket.AF_INET6:
                opened.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_TCLASS, dscp << _DSCP_SHIFT)
            else:
                opened.setsockopt(socket.IPPROTO_IP, socket.IP_TOS, dscp << _DSCP_SHIFT)
            opened.bind(address if host else (any_host, port))
            on_error.pop_all()
            return opened
    except OSError as error:
        raise LinkError(
            f"datagrams cannot be sent: {error.strerror or error}",
            place=f"udp {host or '*'}:{port}",
            remedy="give another port with --datagrams PORT, or --datagrams off",
        ) from error
