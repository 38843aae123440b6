# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The process that carries packets between two TUN devices, each direction as ``EmulatedPath`` does.

A line on its standard input is a change of the conditions as JSON, ``rebind``, or empty; each is answered by
the counts of both directions, which begin with that of the first device's packets. It ends with its standard
input.
"""

from __future__ import annotations

import json
import os
import select
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from typing import NamedTuple

from thin_link.emulated_path import EmulatedPath, PathConditions
from thin_link.nat import Nat

_MOST_PACKET_BYTES = 65_536
_PACKETS_A_TURN = 64
_UDP, _IPV6_FRAGMENT = 17, 44
_IPV6_HEADER_BYTES = 40


Translate = Callable[[bytes], bytes | None]
"""A packet as a router lets it go on; ``None`` where it drops it."""


class _Way(NamedTuple):
    """One direction, the device at its far end, and a router before or behind it."""

    path: EmulatedPath[bytes]
    far_device: int
    before: Translate
    behind: Translate


def _unchanged(packet: bytes) -> bytes:
    return packet


@dataclass(slots=True, kw_only=True)
class Emulator:
    """Carries what either device sends to the other one."""

    ways: dict[int, _Way]
    nat: Nat | None = None

    def run(self) -> None:
        """Carry packets until the standard input ends."""
        commands = sys.stdin.fileno()
        while True:
            ready, _, _ = select.select([commands, *self.ways], [], [], self._wait_s())
            for device, way in self.ways.items():
                if device in ready:
                    _read(device, way)
            for way in self.ways.values():
                _write(way)
            if commands in ready and not self._answer(sys.stdin.readline()):
                return

    def _wait_s(self) -> float | None:
        wakes_ns = [wake_ns for way in self.ways.values() if (wake_ns := way.path.wake_ns) is not None]
        return max(0, min(wakes_ns) - time.monotonic_ns()) / 1e9 if wakes_ns else None

    def _answer(self, line: str) -> bool:
        """Do as a line says; whether there was one."""
        changes = line.strip()
        if changes == "rebind":
            assert self.nat is not None
            self.nat.rebind()
        elif changes:
            for way in self.ways.values():
                conditions = replace(way.path.conditions, **json.loads(changes))
                way.path.change(conditions, time.monotonic_ns())
        print(json.dumps([asdict(way.path.counts) for way in self.ways.values()]), flush=True)
        return bool(line)


def _read(device: int, way: _Way) -> None:
    with suppress(BlockingIOError):
        for _ in range(_PACKETS_A_TURN):
            packet = way.before(os.read(device, _MOST_PACKET_BYTES))
            if packet is not None:
                way.path.put(packet, len(packet), time.monotonic_ns(), is_udp=_is_udp(packet))


def _write(way: _Way) -> None:
    for arrived in way.path.take(time.monotonic_ns()):
        packet = way.behind(arrived)
        if packet is not None:
            # A device that is down takes nothing.
            with suppress(OSError):
                os.write(way.far_device, packet)


def _is_udp(packet: bytes) -> bool:
    if packet[0] >> 4 == 4:
        return packet[9] == _UDP
    protocol = packet[6]
    return (packet[_IPV6_HEADER_BYTES] if protocol == _IPV6_FRAGMENT else protocol) == _UDP


def main() -> None:
    """Carry packets between the devices whose numbers the command line has, with conditions and a seed.

    Addresses inside and outside may follow: the first end is then behind a router that translates the one.
    """
    first, second = map(int, sys.argv[1:3])
    conditions, seed = PathConditions(**json.loads(sys.argv[3])), int(sys.argv[4])
    nat = Nat(*sys.argv[5:7]) if len(sys.argv) > 5 else None
    # Both ends would wait for a link that gets no CPU, which no radio does.
    with suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))
    outwards, inwards = (nat.outwards, nat.inwards) if nat else (_unchanged, _unchanged)
    ways = {
        first: _Way(EmulatedPath(conditions, 2 * seed), second, outwards, _unchanged),
        second: _Way(EmulatedPath(conditions, 2 * seed + 1), first, _unchanged, inwards),
    }
    Emulator(ways=ways, nat=nat).run()


if __name__ == "__main__":
    main()
