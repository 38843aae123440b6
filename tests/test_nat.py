# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A router between a robot and an operator translates addresses, and its checksums are right."""

from __future__ import annotations

import socket

from hypothesis import given
from hypothesis import strategies as st

from thin_link.nat import Nat

INSIDE, OUTSIDE, FAR = "192.168.99.1", "10.99.0.1", "10.99.0.2"
UDP, TCP, ICMP = 17, 6, 1


def checksum(data: bytes) -> int:
    """The Internet checksum, the long way."""
    words = [int.from_bytes(data[at : at + 2].ljust(2, b"\0"), "big") for at in range(0, len(data), 2)]
    total = sum(words)
    while total > 0xFFFF:
        total = (total & 0xFFFF) + (total >> 16)
    return ~total & 0xFFFF


def packet(
    protocol: int, source: tuple[str, int], destination: tuple[str, int], body: bytes = b"", part: int = 0
) -> bytes:
    ports = source[1].to_bytes(2, "big") + destination[1].to_bytes(2, "big")
    if protocol == UDP:
        head, at = ports + (8 + len(body)).to_bytes(2, "big") + bytes(2), 6
    else:
        head, at = ports + bytes(8) + b"\x50\x10\x01\x00" + bytes(4), 16
    addresses = socket.inet_aton(source[0]) + socket.inet_aton(destination[0])
    size = len(head) + len(body)
    pseudo = addresses + bytes((0, protocol)) + size.to_bytes(2, "big")
    filled = head[:at] + checksum(pseudo + head + body).to_bytes(2, "big") + head[at + 2 :]
    ip = b"\x45\0" + (20 + size).to_bytes(2, "big") + bytes(2) + part.to_bytes(2, "big")
    ip += bytes((64, protocol)) + bytes(2) + addresses
    return ip[:10] + checksum(ip).to_bytes(2, "big") + ip[12:] + filled + body


@given(st.sampled_from([UDP, TCP]), st.integers(1, 65_535), st.integers(1, 65_535), st.binary(max_size=40))
def test_a_packet_that_goes_out_is_that_of_the_router_and_the_answer_finds_back(
    protocol: int, inside_port: int, far_port: int, body: bytes
) -> None:
    nat = Nat(INSIDE, OUTSIDE)
    out = nat.outwards(packet(protocol, (INSIDE, inside_port), (FAR, far_port), body))
    assert out == packet(protocol, (OUTSIDE, 40_000), (FAR, far_port), body)
    back = nat.inwards(packet(protocol, (FAR, far_port), (OUTSIDE, 40_000), body))
    assert back == packet(protocol, (FAR, far_port), (INSIDE, inside_port), body)


def test_after_a_rebinding_a_flow_has_another_port_and_the_old_one_leads_nowhere() -> None:
    nat = Nat(INSIDE, OUTSIDE)
    sent, answer = packet(UDP, (INSIDE, 5_000), (FAR, 7)), packet(UDP, (FAR, 7), (OUTSIDE, 40_000))
    assert nat.outwards(sent) == packet(UDP, (OUTSIDE, 40_000), (FAR, 7))
    nat.rebind()
    assert nat.inwards(answer) is None
    assert nat.outwards(sent) == packet(UDP, (OUTSIDE, 40_001), (FAR, 7))
    assert nat.inwards(answer) is None


def test_it_lets_nothing_in_that_was_not_asked_for_and_no_parts_of_packets() -> None:
    nat = Nat(INSIDE, OUTSIDE)
    assert nat.inwards(packet(TCP, (FAR, 7), (OUTSIDE, 40_000))) is None
    assert nat.outwards(packet(UDP, (INSIDE, 5_000), (FAR, 7), part=1)) is None
    assert nat.outwards(packet(ICMP, (INSIDE, 5_000), (FAR, 7))) is None
    assert nat.outwards(b"\x60" + bytes(39)) == b"\x60" + bytes(39)
