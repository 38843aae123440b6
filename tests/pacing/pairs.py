# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A leader and its follower, offered the two halves of pairs in some order."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from enum import Enum

from pacing.scenarios import Relayed, sample
from smarttestudo.pacing.follower import Follower
from smarttestudo.pacing.sample import Pass
from smarttestudo.pacing.topic_pacer import TopicPacer


class Half(Enum):
    """Which of a pair's two messages."""

    LEADER = "leader"
    FOLLOWER = "follower"


Event = tuple[int, Half, bytes]


def stamp(number: int) -> bytes:
    return struct.pack("<iI", number // 1000, number % 1000)


class Pair:
    """Runs a leader and its follower as a runtime does: after each call on the leader, the follower wakes."""

    def __init__(self, leader: TopicPacer) -> None:
        self.leader = leader
        self.follower = Follower()
        leader.add_follower(self.follower)
        self.led: list[Relayed] = []
        self.followed: list[Relayed] = []

    def run(self, events: Sequence[Event], changes: Sequence[tuple[int, float]] = ()) -> None:
        steps: list[tuple[int, int, float | tuple[Half, bytes]]] = [
            *((at_ns, 0, rate_hz) for at_ns, rate_hz in changes),
            *((at_ns, 1, (half, bytes_)) for at_ns, half, bytes_ in events),
        ]
        for at_ns, _, what in sorted(steps, key=lambda step: step[:2]):
            self.wake(at_ns)
            if isinstance(what, tuple):
                self.offer(at_ns, *what)
            else:
                self.set_rate(at_ns, what)

    def set_rate(self, at_ns: int, rate_hz: float) -> None:
        self.leader.set_rate(rate_hz, at_ns)
        self._follow(at_ns)

    def offer(self, at_ns: int, half: Half, stamp_: bytes) -> None:
        offered = sample(stamp=stamp_)
        if half is Half.FOLLOWER:
            self.followed += relayed(at_ns, self.follower.offer(offered, at_ns))
        else:
            self.led += relayed(at_ns, self.leader.offer(offered, at_ns))
            self._follow(at_ns)

    def wake(self, until_ns: int | None) -> None:
        while (at_ns := self.leader.wake_ns) is not None and (until_ns is None or at_ns <= until_ns):
            self.led += relayed(at_ns, self.leader.wake(at_ns))
            self._follow(at_ns)

    def _follow(self, at_ns: int) -> None:
        assert self.follower.wake_ns in (None, at_ns)
        self.followed += relayed(at_ns, self.follower.wake(at_ns))


def relayed(at_ns: int, passes: Sequence[Pass]) -> list[Relayed]:
    return [Relayed(at_ns, passed.sample, passed.repeated) for passed in passes]


def stamps(of: Sequence[Relayed]) -> list[bytes]:
    found = [r.sample.stamp for r in of]
    assert None not in found
    return [one for one in found if one is not None]
