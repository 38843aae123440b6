# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An operator who sends to a robot in virtual time: two clocks, a link each way with jitter and outages."""

from __future__ import annotations

import heapq
import itertools
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

from link.protocol.simulated_link import MS, Link, S
from smarttestudo.link.protocol.commands import CommandReceiver, CommandSender

PUMP_NS = 50 * MS
JOY = "/joy"
TYPE = "sensor_msgs/msg/Joy"


@dataclass(frozen=True, kw_only=True)
class Clock:
    """A clock that starts at ``from_ns`` and runs ``drift_ppm`` too fast."""

    from_ns: int = 0
    drift_ppm: int = 0

    def at(self, now_ns: int) -> int:
        return self.from_ns + now_ns + now_ns * self.drift_ppm // 1_000_000


@dataclass
class Way:
    """One direction: what ``link`` does, and up to ``jitter_s`` more, in order."""

    link: Link
    jitter_s: float = 0.0
    random: random.Random = field(default_factory=lambda: random.Random(5))
    last_ns: int = 0

    def arrival_ns(self, size_bytes: int, now_ns: int) -> int:
        late_ns = int(self.random.random() * self.jitter_s * S)
        self.last_ns = max(self.last_ns, self.link.arrival_ns(size_bytes, now_ns) + late_ns)
        return self.last_ns


@dataclass(kw_only=True)
class Driving:
    """Both ends; ``published`` and ``delivered`` are (time, publisher, number) of all messages."""

    up: Way
    down: Way
    robot_clock: Clock = field(default_factory=Clock)
    operator_clock: Clock = field(default_factory=Clock)
    pauses: Sequence[tuple[float, float]] = ()
    """When the operator's process stands still."""
    published: list[tuple[int, int, int]] = field(default_factory=list)
    delivered: list[tuple[int, int, int]] = field(default_factory=list)

    def __post_init__(self) -> None:
        numbers = itertools.count(1)
        self.sender = CommandSender((JOY,), lambda: next(numbers))
        self.receiver = CommandReceiver((JOY,))
        self.receiver.follow(JOY, TYPE)
        self._events: list[tuple[int, int, Callable[[int], None]]] = []
        self._order = itertools.count()
        self._report_ns = 2**62
        self.at(0, self._pump_again)
        self.at(0, self._look)

    def at(self, at_ns: int, act: Callable[[int], None]) -> None:
        heapq.heappush(self._events, (at_ns, next(self._order), act))

    def publish(self, at_s: float, publisher: int = 0, size_bytes: int = 60) -> None:
        """Have the operator publish a message."""
        self.at(int(at_s * S), partial(self._publish, publisher, size_bytes))

    def publish_at(self, rate_hz: float, from_s: float, to_s: float, publisher: int = 0) -> None:
        """Have the operator publish in that time."""
        for number in range(int((to_s - from_s) * rate_hz)):
            self.publish(from_s + number / rate_hz, publisher)

    def run(self, seconds: float) -> None:
        while self._events and self._events[0][0] <= seconds * S:
            at_ns, _, act = heapq.heappop(self._events)
            act(at_ns)

    def ages_s(self) -> list[float]:
        """How old the messages truly were when they were delivered, by the robot's clock."""
        at_ns = {(publisher, number): at_ns for at_ns, publisher, number in self.published}
        clock = self.robot_clock
        return [
            (clock.at(now_ns) - clock.at(at_ns[publisher, number])) / S
            for now_ns, publisher, number in self.delivered
        ]

    def numbers(self, publisher: int = 0) -> list[int]:
        """Which messages of a publisher were delivered, in that order."""
        return [number for _, whose, number in self.delivered if whose == publisher]

    def _awake_ns(self, now_ns: int) -> int:
        return max(
            [now_ns, *(int(to_s * S) for from_s, to_s in self.pauses if from_s * S <= now_ns < to_s * S)]
        )

    def _publish(self, publisher: int, size_bytes: int, now_ns: int) -> None:
        if self._awake_ns(now_ns) != now_ns:
            return
        number = len(self.published)
        self.published.append((now_ns, publisher, number))
        payload = bytes([publisher]) + number.to_bytes(4, "little") + bytes(size_bytes - 5)
        self.sender.put(JOY, publisher, payload, self.operator_clock.at(now_ns))
        self._pump(now_ns)

    def _pump_again(self, now_ns: int) -> None:
        self._pump(now_ns)
        self.at(self._awake_ns(now_ns + PUMP_NS), self._pump_again)

    def _pump(self, now_ns: int) -> None:
        while (data := self.sender.next_command(self.operator_clock.at(now_ns))) is not None:
            self.at(self.up.arrival_ns(len(data), now_ns), partial(self._arrive, data))

    def _arrive(self, data: bytes, now_ns: int) -> None:
        found = self.receiver.receive(data, self.robot_clock.at(now_ns))
        if found is not None:
            self.delivered.append((now_ns, found.payload[0], int.from_bytes(found.payload[1:5], "little")))

    def _look(self, now_ns: int) -> None:
        robot_ns = self.robot_clock.at(now_ns)
        if self.receiver.wake_ns <= robot_ns:
            data = self.receiver.next_report(robot_ns)
            self.at(self.down.arrival_ns(len(data), now_ns), partial(self._take_report, data))
        self.at(now_ns + 20 * MS, self._look)

    def _take_report(self, data: bytes, now_ns: int) -> None:
        awake_ns = self._awake_ns(now_ns)
        if awake_ns != now_ns:
            self.at(awake_ns, partial(self._take_report, data))
            return
        self.sender.handle_report(data, self.operator_clock.at(now_ns))
        self._pump(now_ns)
