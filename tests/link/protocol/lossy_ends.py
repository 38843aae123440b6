# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Both ends in virtual time over a radio: rate, a short queue, jitter, loss in runs, copies, outages."""

from __future__ import annotations

import random
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

from link.protocol.simulated_link import MS, NEVER_NS, Ends, Link, S, Source
from smarttestudo.domain.link import MissedMessage, ReceivedMessage
from smarttestudo.link.protocol.messages import REPORTS, Report
from smarttestudo.link.protocol.receiver import KEEP_ALIVE_NS, LinkReceiver
from smarttestudo.link.protocol.sender import LinkSender

HEAD_BYTES = 60
"""The heads of IP and UDP, and the seal."""
RUN = 3.0
"""How many datagrams in a row are lost, on average."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """One way of a radio; where it ``reorders``, what has less jitter goes before what has more."""

    delay_ms: float
    jitter_ms: float
    lost_percent: float
    mbit_per_s: float
    queue_bytes: int = 64_000
    copied_percent: float = 0.0
    reorders: bool = False


PROFILES = {
    "starlink": Profile(delay_ms=30, jitter_ms=10, lost_percent=2, mbit_per_s=15),
    "4g": Profile(delay_ms=50, jitter_ms=15, lost_percent=3, mbit_per_s=10),
    "wifi-walls": Profile(delay_ms=15, jitter_ms=10, lost_percent=8, mbit_per_s=2),
    "severe": Profile(delay_ms=100, jitter_ms=30, lost_percent=5, mbit_per_s=2),
    "clean": Profile(delay_ms=1, jitter_ms=0, lost_percent=0, mbit_per_s=2),
}


@dataclass
class Radio:
    """One way: when copies of a datagram arrive, if any does. ``outages`` are in ns."""

    profile: Profile
    seed: int = 1
    outages: Sequence[tuple[int, int]] = ()
    free_ns: float = 0.0
    last_ns: int = 0
    is_in_run: bool = False
    sent: int = 0
    lost: int = 0
    overflowed: int = 0
    carried_bytes: int = 0

    def __post_init__(self) -> None:
        self.random = random.Random(self.seed)

    def arrivals_ns(self, size_bytes: int, now_ns: int) -> list[int]:
        one, size_bytes = self.profile, size_bytes + HEAD_BYTES
        share = one.lost_percent / 100
        ends = self.random.random() < 1 / RUN
        begins = self.random.random() < share / (1 - share) / RUN
        self.is_in_run = not ends if self.is_in_run else begins
        bytes_per_ns = one.mbit_per_s / 8_000
        self.sent += 1
        if (max(self.free_ns, now_ns) - now_ns) * bytes_per_ns + size_bytes > one.queue_bytes:
            self.overflowed += 1
            return []
        self.free_ns = max(self.free_ns, now_ns) + size_bytes / bytes_per_ns
        if self.is_in_run or any(from_ns <= now_ns < to_ns for from_ns, to_ns in self.outages):
            self.lost += 1
            return []
        self.carried_bytes += size_bytes
        copies = 1 + (self.random.random() < one.copied_percent / 100)
        return [self._arrival_ns() for _ in range(copies)]

    def _arrival_ns(self) -> int:
        one = self.profile
        jitter_ms = self.random.uniform(-one.jitter_ms, one.jitter_ms)
        at_ns = int(self.free_ns + max(one.delay_ms + jitter_ms, 0) * MS)
        if not one.reorders:
            at_ns = self.last_ns = max(at_ns, self.last_ns)
        return at_ns


class Operator:
    """One run of the operator's end, with the numbers of the messages that it received of one boot, by topic.

    ``reported`` are those of which the robot's end was told before it began another session.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.receiver = LinkReceiver("robot", number, lambda data, _most: data)
        self.arrived: dict[str, list[int]] = defaultdict(list)
        self.reported: dict[str, set[int]] = defaultdict(set)
        self.is_gone = False
        self.is_noticed = False
        """Whether the robot's end knows that it is gone."""


@dataclass
class Boot:
    """One run of the robot's end, with what it was given to send, and the operator's ends that it had."""

    sender: LinkSender[None]
    payloads: dict[str, list[bytes]]
    operators: list[Operator] = field(default_factory=list)
    missed: list[MissedMessage] = field(default_factory=list)


@dataclass
class LossyEnds(Ends):
    """Both ends: what goes as a datagram goes over the radios, the rest over ``link``. Either may restart."""

    up: Radio = field(default_factory=lambda: Radio(PROFILES["clean"]))
    down: Radio = field(default_factory=lambda: Radio(PROFILES["clean"], seed=2))
    has_datagrams: bool = True
    wake_ns: int = NEVER_NS

    def __post_init__(self) -> None:
        super().__post_init__()
        self.boots = [Boot(self.sender, self.payloads)]
        self._said_ns = 0
        self._connection = 0
        self._connected_ns = 0
        """When the connection of that number is there."""
        self._begin_operator(7)

    @property
    def operator(self) -> Operator:
        return self.boots[-1].operators[-1]

    def run(self, seconds: float) -> None:
        if self.has_datagrams:
            self.sender.allow_datagrams(frozenset({7}))
        super().run(seconds)

    def allow(self, now_ns: int, *, has_datagrams: bool = True) -> None:
        """Have datagrams come through to the operator's end that is there, or no more."""
        self.has_datagrams = has_datagrams
        if not self.operator.is_gone:
            self.sender.allow_datagrams(frozenset({self.operator.number} if has_datagrams else ()))

    def restart_operator(self, now_ns: int, *, back_ns: int, key_ns: int, is_noticed: bool) -> None:
        """Have the operator's end killed, and another there after a while, with datagrams later."""
        number = self.operator.number + 1
        self.operator.is_gone, self.operator.is_noticed = True, is_noticed
        self._report_ns = NEVER_NS
        if is_noticed:
            self.sender.disconnect()

        def come(now_ns: int) -> None:
            if self.operator.is_gone:
                self._begin_operator(number)
                self._report_soon(now_ns)

        self.at(now_ns + back_ns, come)
        self.at(
            now_ns + back_ns + key_ns, lambda now_ns: self.allow(now_ns, has_datagrams=self.has_datagrams)
        )

    def cut(self, now_ns: int, *, back_ns: int) -> None:
        """Have the reliable link cut for a while; what is under way on it is gone."""
        self._connection += 1
        self._connected_ns = now_ns + back_ns
        self.sender.disconnect()

    def restart_robot(self, now_ns: int, *, key_ns: int) -> None:
        """Have the robot's end stop, and another begin that knows nothing of it."""
        before = self.boots[-1]
        before.missed += self.sender.take_missed(now_ns, is_last=True)
        self.sender, self.payloads = LinkSender(start_ns=now_ns), defaultdict(list)
        self.boots.append(Boot(self.sender, self.payloads))
        self.open_streams(now_ns)
        number, is_gone = before.operators[-1].number, before.operators[-1].is_gone
        self._begin_operator(number)
        self.operator.is_gone = is_gone
        self._report_ns = NEVER_NS
        if not is_gone:
            self._report_soon(now_ns)
        self.at(now_ns + key_ns, lambda now_ns: self.allow(now_ns, has_datagrams=self.has_datagrams))

    def _begin_operator(self, number: int) -> None:
        self.boots[-1].operators.append(Operator(number))
        self.receiver = self.operator.receiver

    def _pump(self, now_ns: int) -> None:
        scheduler, operator = self.sender.scheduler, self.operator
        while (data := scheduler.next_chunk(now_ns)) is not None:
            if scheduler.is_by_datagrams:
                for at_ns in self.up.arrivals_ns(len(data), now_ns):
                    self.at(at_ns, partial(self._arrive_at, operator, data, True))
            else:
                at_ns = self.link.arrival_ns(len(data), now_ns)
                self.at(at_ns, self._over_link(partial(self._arrive_at, operator, data, False), now_ns))
        wake_ns = scheduler.wake_ns(now_ns)
        if wake_ns is not None and (wake_ns < self.wake_ns or self.wake_ns <= now_ns):
            self.wake_ns = max(wake_ns, now_ns + 1)
            self.at(self.wake_ns, lambda _now_ns: None)

    def _over_link(self, act: Callable[[int], None], sent_ns: int) -> Callable[[int], None]:
        """Act on what was sent then over the connection that there was, if it is there still."""
        connection = self._connection if sent_ns >= self._connected_ns else -1

        def arrive(now_ns: int) -> None:
            if connection == self._connection:
                act(now_ns)

        return arrive

    def _arrive_at(self, operator: Operator, data: bytes, is_datagram: bool, now_ns: int) -> None:
        """What comes for an end that is gone has no seal that another one opens."""
        if operator.is_gone:
            return
        receiver = operator.receiver
        found = receiver.receive_datagram(data, now_ns) if is_datagram else [receiver.receive(data, now_ns)]
        for got in found:
            if isinstance(got, ReceivedMessage):
                self.arrived[got.stream.topic].append((now_ns, got))
                operator.arrived[got.stream.topic].append(int.from_bytes(got.payload[:8], "little"))
        if operator is self.operator:
            self._report_soon(now_ns)

    def _report(self, now_ns: int) -> None:
        operator = self.operator
        if operator.is_gone or now_ns < self.receiver.wake_ns or now_ns != self._report_ns:
            return
        data = self.receiver.next_report(now_ns)
        report: Report = REPORTS.from_bytes(data)
        told = partial(self._tell, self.boots[-1].sender, operator, _copied(operator.arrived), report)
        if self.receiver.is_by_datagrams:
            for at_ns in self.down.arrivals_ns(len(data), now_ns):
                self.at(at_ns, partial(told, is_datagram=True))
        if not self.receiver.is_by_datagrams or now_ns - self._said_ns >= KEEP_ALIVE_NS:
            self._said_ns = now_ns
            if self.link.rate(now_ns) > 0:
                self.at(now_ns + int(self.link.delay_s * S), self._over_link(told, now_ns))
        self._report_ns = NEVER_NS
        self._report_soon(now_ns)

    def _tell(
        self,
        sender: LinkSender[None],
        operator: Operator,
        arrived: dict[str, list[int]],
        report: Report,
        now_ns: int,
        *,
        is_datagram: bool = False,
    ) -> None:
        if sender is not self.sender or (operator.is_noticed and not is_datagram):
            return
        is_news = report.received.session == sender.scheduler.session and not operator.is_noticed
        if is_datagram:
            sender.handle_datagram_report(report, now_ns)
        else:
            self._take_report(report, now_ns)
        if not is_news:
            return
        for topic, numbers in arrived.items():
            operator.reported[topic].update(numbers)


def _copied(arrived: dict[str, list[int]]) -> dict[str, list[int]]:
    return {topic: list(numbers) for topic, numbers in arrived.items()}


def lossy_ends(
    profile: Profile, sources: Sequence[Source], seed: int = 1, outages: Sequence[tuple[int, int]] = ()
) -> LossyEnds:
    """Both ends over a radio that is alike either way; the reliable link beside it loses nothing."""
    bytes_per_s = profile.mbit_per_s * 125_000
    steps = {0.0: bytes_per_s}
    for from_ns, to_ns in outages:
        steps |= {from_ns / S: 0.0, to_ns / S: bytes_per_s}
    link = Link(tuple(sorted(steps.items())), profile.delay_ms / 1_000)
    up, down = (Radio(profile, seed + one, outages) for one in range(2))
    return LossyEnds(link, sources, up=up, down=down)
