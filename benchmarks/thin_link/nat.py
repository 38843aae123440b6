# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A router that translates a robot's address, and may give its flows other ports at any time."""

from __future__ import annotations

import itertools
import socket
from collections.abc import Iterator
from typing import NamedTuple

_TCP, _UDP = 6, 17
_CHECKSUM_AT = {_TCP: 16, _UDP: 6}
"""Where TCP and UDP have theirs."""
_FIRST_PORT = 40_000
_FRAGMENT = 0x3FFF


class _Flow(NamedTuple):
    protocol: int
    port: bytes


class Nat:
    """Flows of TCP and UDP over IPv4 from an address inside appear with an address outside.

    What comes for a port that no flow has is dropped, as all else but IPv6 is.
    """

    def __init__(self, inside: str, outside: str) -> None:
        self._inside = socket.inet_aton(inside)
        self._outside = socket.inet_aton(outside)
        self._ports: dict[_Flow, bytes] = {}
        self._flows: dict[_Flow, bytes] = {}
        self._free: Iterator[int] = itertools.count(_FIRST_PORT)

    def rebind(self) -> None:
        """Forget all flows: what goes on has another port, and what comes for an old one is dropped."""
        self._ports.clear()
        self._flows.clear()

    def outwards(self, packet: bytes) -> bytes | None:
        """A packet from inside as it goes on; ``None`` where it is dropped."""
        if (flow := _flow(packet, is_outwards=True)) is None:
            return packet if packet[0] >> 4 == 6 else None
        if flow not in self._ports:
            port = next(self._free).to_bytes(2, "big")
            self._ports[flow], self._flows[_Flow(flow.protocol, port)] = port, flow.port
        return _translated(packet, self._outside, self._ports[flow], is_outwards=True)

    def inwards(self, packet: bytes) -> bytes | None:
        """A packet from outside as it goes on; ``None`` where it is dropped."""
        if (flow := _flow(packet, is_outwards=False)) is None:
            return packet if packet[0] >> 4 == 6 else None
        port = self._flows.get(flow)
        return None if port is None else _translated(packet, self._inside, port, is_outwards=False)


def _flow(packet: bytes, *, is_outwards: bool) -> _Flow | None:
    """The flow of a packet by the port inside or outside; parts of packets name none."""
    is_part = int.from_bytes(packet[6:8], "big") & _FRAGMENT
    if packet[0] >> 4 != 4 or packet[9] not in _CHECKSUM_AT or is_part:
        return None
    at = (packet[0] & 15) * 4 + (0 if is_outwards else 2)
    return _Flow(packet[9], packet[at : at + 2])


def _translated(packet: bytes, address: bytes, port: bytes, *, is_outwards: bool) -> bytes:
    """A packet with another source, or destination where it comes in."""
    changed = bytearray(packet)
    head_bytes = (packet[0] & 15) * 4
    address_at = 12 if is_outwards else 16
    port_at = head_bytes + (0 if is_outwards else 2)
    old_address, old_port = packet[address_at : address_at + 4], packet[port_at : port_at + 2]
    changed[address_at : address_at + 4] = address
    changed[port_at : port_at + 2] = port
    _adjust(changed, 10, old_address, address)
    checksum_at = head_bytes + _CHECKSUM_AT[packet[9]]
    # UDP may go without.
    if packet[9] == _TCP or any(packet[checksum_at : checksum_at + 2]):
        _adjust(changed, checksum_at, old_address + old_port, address + port)
    return bytes(changed)


def _adjust(packet: bytearray, at: int, old: bytes, new: bytes) -> None:
    """Have the checksum at that place be right again, by RFC 1624."""
    total = ~int.from_bytes(packet[at : at + 2], "big") & 0xFFFF
    for index in range(0, len(old), 2):
        total += ~int.from_bytes(old[index : index + 2], "big") & 0xFFFF
        total += int.from_bytes(new[index : index + 2], "big")
    while total > 0xFFFF:
        total = (total & 0xFFFF) + (total >> 16)
    packet[at : at + 2] = (~total & 0xFFFF).to_bytes(2, "big")
