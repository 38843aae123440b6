# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Both ends in virtual time over the radio of a scenario file, and what an operator observes there."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Generic, TypeVar

from link.protocol.simulated_link import NEVER_NS, Ends, Link, S, Source
from smarttestudo.domain.link import LinkNeeds
from smarttestudo.link.protocol.messages import REPORTS
from thin_link.cases import WARM_S, Arrival, Seen
from thin_link.emulated_path import EmulatedPath, PathConditions
from thin_link.scenario import Scenario

TCP_HEAD_BYTES = 52
"""Of IP and TCP with time stamps."""
At = Callable[[int, Callable[[int], None]], None]
"""How a simulation is told what is to happen when."""
_Packet = TypeVar("_Packet")


class RadioWay(Generic[_Packet]):
    """One direction of a radio whose packets the events of a simulation deliver, as its course says."""

    def __init__(
        self,
        course: Sequence[tuple[float, PathConditions]],
        seed: int,
        at: At,
        deliver: Callable[[_Packet, int], None],
    ) -> None:
        self.path = EmulatedPath[_Packet](course[0][1], seed)
        self._at = at
        self._deliver = deliver
        self._wake_ns = NEVER_NS
        for from_s, conditions in course[1:]:
            at(int(from_s * S), partial(self._change, conditions))

    def put(self, packet: _Packet, size_bytes: int, now_ns: int, *, is_udp: bool = False) -> None:
        """Have a packet of so many bytes sent, headers included."""
        self.path.put(packet, size_bytes, now_ns, is_udp=is_udp)
        self._wake_later()

    def _change(self, conditions: PathConditions, now_ns: int) -> None:
        self.path.change(conditions, now_ns)
        self._wake_later()

    def _wake_later(self) -> None:
        wake_ns = self.path.wake_ns
        if wake_ns is not None and wake_ns < self._wake_ns:
            self._wake_ns = wake_ns
            self._at(wake_ns, self._wake)

    def _wake(self, now_ns: int) -> None:
        if now_ns < self._wake_ns:
            # It was put off, as the link became slower.
            return
        self._wake_ns = NEVER_NS
        for packet in self.path.take(now_ns):
            self._deliver(packet, now_ns)
        self._wake_later()


@dataclass
class StreamEnds(Ends):
    """Both ends over a stream of segments, none of which may be lost: nothing is sent again."""

    scenario: Scenario = field(kw_only=True)
    seed: int = field(default=1, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        course = self.scenario.course
        self.up = RadioWay[bytes](course, 2 * self.seed, self.at, self._take_segment)
        self.down = RadioWay[bytes](course, 2 * self.seed + 1, self.at, self._take_report_data)

    def _pump(self, now_ns: int) -> None:
        most_bytes = self.scenario.conditions.mtu_bytes - TCP_HEAD_BYTES
        while (data := self.sender.scheduler.next_chunk(now_ns)) is not None:
            for left_bytes in range(len(data), 0, -most_bytes):
                # The chunk is there with its last segment.
                segment_bytes = min(left_bytes, most_bytes)
                is_last = left_bytes <= most_bytes
                self.up.put(data if is_last else b"", segment_bytes + TCP_HEAD_BYTES, now_ns)

    def _take_segment(self, data: bytes, now_ns: int) -> None:
        if data:
            self._arrive(data, now_ns)

    def _report(self, now_ns: int) -> None:
        if now_ns < self.receiver.wake_ns or now_ns != self._report_ns:
            return
        data = self.receiver.next_report(now_ns)
        self.down.put(data, len(data) + TCP_HEAD_BYTES, now_ns)
        self._report_ns = NEVER_NS
        self._report_soon(now_ns)

    def _take_report_data(self, data: bytes, now_ns: int) -> None:
        self._take_report(REPORTS.from_bytes(data), now_ns)


def sources_of(scenario: Scenario) -> list[Source]:
    """The topics of the robot of a scenario."""
    return [
        Source(topic=one.name, size_bytes=one.size_bytes, rate_hz=one.hz, to_s=scenario.seconds)
        for one in scenario.topics
    ]


def needs_of(scenario: Scenario) -> dict[str, LinkNeeds]:
    """How its topics are served."""
    return {
        one.name: LinkNeeds(priority=one.priority, floor_hz=one.floor_hz, is_full=one.is_full)
        for one in scenario.topics
    }


def stream_ends(scenario: Scenario, seed: int = 1) -> StreamEnds:
    """Both ends of a scenario that loses nothing, over a stream."""
    link = Link(((0.0, scenario.conditions.rate_bits_per_s / 8),))
    ends = StreamEnds(link, sources_of(scenario), scenario=scenario, seed=seed)
    ends.sender.follow(needs_of(scenario))
    return ends


def observed(ends: Ends, way: RadioWay[bytes], scenario: Scenario, grace_s: float = 1.0) -> Seen:
    """Run both ends, and give what an operator sees; ``way`` is the one to the operator."""
    ends.run(WARM_S)
    warm_bytes = way.path.counts.arrived_bytes
    ends.go_on(scenario.seconds)
    end_bytes = way.path.counts.arrived_bytes
    ends.go_on(scenario.seconds + grace_s)
    counts = ends.sender.counts(int(scenario.seconds * S))
    return Seen(
        arrived={
            topic: [
                Arrival(
                    number=int.from_bytes(one.payload[:8], "little"),
                    sent_s=one.offered_ns / S,
                    at_s=at_ns / S,
                )
                for at_ns, one in messages
            ]
            for topic, messages in ends.arrived.items()
        },
        seconds=scenario.seconds,
        used=(end_bytes - warm_bytes) / scenario.case().capacity_bytes(WARM_S, scenario.seconds),
        cpu_s_per_mb=0.0,
        published={topic: len(payloads) for topic, payloads in ends.payloads.items()},
        begun={topic: one.sent for topic, one in counts.items()},
        overflowed={topic: one.overflowed for topic, one in counts.items()},
    )
