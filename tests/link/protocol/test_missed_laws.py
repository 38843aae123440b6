# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator's end missed in outages is what it did not receive, and nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from link.protocol.simulated_link import Ends, Link, S, Source
from smarttestudo.domain.link import LinkNeeds, MissedMessage
from smarttestudo.link.protocol.chunks import NOTHING_RECEIVED
from smarttestudo.link.protocol.messages import Report

MS = S // 1000
END_S = 16.0
END_NS = int(END_S) * S
# The first operator's end is there by then; what comes at the end has time to arrive.
SOURCES = (
    Source(topic="/odom", size_bytes=720, rate_hz=20, from_s=0.5, to_s=END_S - 2),
    Source(topic="/image", size_bytes=20_000, rate_hz=4, from_s=0.5, to_s=END_S - 2),
    Source(topic="/joint_states", size_bytes=20_000, rate_hz=10, from_s=0.5, to_s=END_S - 2),
    Source(topic="/map", size_bytes=5_000, rate_hz=0.7, from_s=0.5, to_s=END_S - 2, transient_local=True),
)
SMALL = (SOURCES[0], SOURCES[3])
NEEDS = {"/odom": LinkNeeds(priority=2), "/joint_states": LinkNeeds(is_full=True)}


@dataclass
class CutEnds(Ends):
    """A connection that is cut at times, and made anew: what was under way either way is gone.

    ``cuts`` are when, and until when, in ns.
    """

    cuts: Sequence[tuple[int, int]] = field(default_factory=tuple)

    def run(self, seconds: float) -> None:
        for from_ns, _ in self.cuts:
            self.at(from_ns, lambda _now_ns: self.sender.disconnect())
        super().run(seconds)

    def connection(self, now_ns: int) -> int | None:
        """The number of the connection that there is; ``None`` in a cut."""
        if any(from_ns <= now_ns < to_ns for from_ns, to_ns in self.cuts):
            return None
        return sum(from_ns <= now_ns for from_ns, _ in self.cuts)

    def _pump(self, now_ns: int) -> None:
        while (data := self.sender.scheduler.next_chunk(now_ns)) is not None:
            at_ns = self.link.arrival_ns(len(data), now_ns)
            self.at(at_ns, partial(self._arrive_over, self.connection(now_ns), data))

    def _arrive_over(self, connection: int | None, data: bytes, now_ns: int) -> None:
        if connection is not None and connection == self.connection(now_ns):
            self._arrive(data, now_ns)

    def _take_report(self, report: Report, now_ns: int) -> None:
        # It was sent one delay ago.
        sent_ns = now_ns - int(self.link.delay_s * S)
        if self.connection(now_ns) is not None and self.connection(sent_ns) == self.connection(now_ns):
            super()._take_report(report, now_ns)


@dataclass(frozen=True, slots=True, kw_only=True)
class Fate:
    """What became of the messages of one topic, by their numbers, of which each once is enough."""

    offered: frozenset[int]
    received: frozenset[int]
    missed: frozenset[int]

    @property
    def gave_way(self) -> frozenset[int]:
        """Those that are neither: newer ones of a link that was there went before them."""
        return self.offered - self.received - self.missed


def fates(ends: Ends, missed: Sequence[MissedMessage]) -> dict[str, Fate]:
    found: dict[str, Fate] = {}
    for source in ends.sources:
        payloads = [one.payload for one in missed if one.origin.topic == source.topic]
        assert len(payloads) == len({*payloads})
        found[source.topic] = Fate(
            offered=numbers(ends.payloads[source.topic]),
            received=numbers(message.payload for _, message in ends.arrived[source.topic]),
            missed=numbers(payloads),
        )
    return found


def numbers(payloads: Iterable[bytes]) -> frozenset[int]:
    return frozenset(int.from_bytes(payload[:8], "little") for payload in payloads)


def run(ends: Ends) -> dict[str, Fate]:
    ends.sender.follow(NEEDS)
    ends.run(END_S)
    return fates(ends, ends.sender.take_missed(END_NS))


def cut_for(lengths_ms: Sequence[int]) -> tuple[tuple[int, int], ...]:
    return tuple((n * 6 * S + S, n * 6 * S + S + length * MS) for n, length in enumerate(lengths_ms))


@pytest.mark.parametrize(
    ("lengths_ms", "outages"), [((250,), 0), ((2_000,), 1), ((400, 5_000), 1), ((3_000, 2_500), 2)]
)
def test_a_connection_that_is_cut_for_long_is_an_outage(lengths_ms: Sequence[int], outages: int) -> None:
    ends = CutEnds(Link(((0.0, 250_000.0),), 0.02), SMALL, cuts=cut_for(lengths_ms))
    run(ends)
    assert ends.sender.state(END_NS).outages == outages


# In ms; eighths of a second are whole in floats.
lengths = st.lists(st.integers(1, 40).map(lambda eighths: 125 * eighths), min_size=1, max_size=2)


def gave_way_within(source: Source, fate: Fate, spans: Iterable[tuple[int, int]]) -> list[int]:
    """Which messages gave way that were offered within ``spans`` of time in ns."""
    offered_ns = {number: int((source.from_s + number / source.rate_hz) * S) for number in fate.gave_way}
    return [
        number
        for number, at_ns in offered_ns.items()
        if any(from_ns <= at_ns < to_ns for from_ns, to_ns in spans)
    ]


@settings(max_examples=30)
@given(lengths)
@example([500, 500])
def test_each_message_of_a_cut_was_either_received_or_missed(lengths_ms: list[int]) -> None:
    cuts = cut_for(lengths_ms)
    ends = CutEnds(Link(((0, 1_000_000),)), SOURCES, cuts=cuts)
    found = run(ends)
    for source in SOURCES:
        fate = found[source.topic]
        assert fate.received & fate.missed == frozenset()
        assert gave_way_within(source, fate, cuts) == []


@settings(max_examples=30)
@given(lengths, st.lists(st.integers(200, 1_000), min_size=1, max_size=3))
def test_who_comes_while_another_is_served_changes_nothing_for_that_one(
    lengths_ms: list[int], joins_ms: list[int]
) -> None:
    cuts = cut_for(lengths_ms)
    ends = CutEnds(Link(((0, 1_000_000),)), SOURCES, cuts=cuts)
    for number, join_ms in enumerate(joins_ms):
        report = Report(receiver=100 + number, received=NOTHING_RECEIVED)
        for cycle in range(len(cuts)):
            ends.at(cycle * 6 * S + join_ms * MS, partial(ends.sender.handle_report, report))
    found = run(ends)
    for source in SOURCES:
        fate = found[source.topic]
        assert fate.received & fate.missed == frozenset()
        assert gave_way_within(source, fate, cuts) == []
        got = [message.payload for _, message in ends.arrived[source.topic]]
        assert len(got) == len({*got})


@settings(max_examples=30)
@given(lengths)
def test_each_message_of_a_link_that_stands_still_for_longer_was_received_or_missed(
    lengths_ms: list[int],
) -> None:
    steps, still = [(0.0, 1_000_000.0)], cut_for(lengths_ms)
    for from_ns, to_ns in still:
        steps += [(from_ns / S, 0.0), (to_ns / S, 1_000_000.0)]
    found = run(Ends(Link(tuple(steps)), SOURCES))
    outages = [(from_ns, to_ns) for from_ns, to_ns in still if to_ns - from_ns > 1_500 * MS]
    for source in SOURCES:
        assert gave_way_within(source, found[source.topic], outages) == []
        # What stands still for less than a second is no outage: newer messages replace those that wait.
        if max(lengths_ms) < 900:
            assert found[source.topic].missed == frozenset()


def test_of_a_topic_that_queues_what_overflowed_in_an_outage_is_missed() -> None:
    ends = CutEnds(Link(((0, 1_000_000),)), SOURCES, cuts=((2 * S, 12 * S),))
    fate = run(ends)["/joint_states"]
    assert len(fate.missed) == ends.sender.counts(0)["/joint_states"].overflowed > 0
    assert fate.gave_way == frozenset()


def test_a_link_that_is_never_cut_misses_nothing_though_it_carries_half() -> None:
    ends = Ends(Link(((0, 120_000),)), SOURCES)
    found = run(ends)
    assert ends.sender.counts(0)["/image"].replaced > 0
    assert {topic: fate.missed for topic, fate in found.items() if fate.missed} == {}


def test_before_the_first_operator_nothing_is_missed_and_at_the_end_what_waits_is() -> None:
    alone = CutEnds(Link(((0, 1_000_000),)), SOURCES, cuts=((0, int(END_S) * S),))
    alone.run(END_S)
    assert alone.sender.take_missed(END_NS, is_last=True) == []
    left = CutEnds(Link(((0, 1_000_000),)), SMALL, cuts=((2 * S, int(END_S) * S),))
    left.sender.follow(NEEDS)
    left.run(END_S)
    found = fates(left, left.sender.take_missed(END_NS, is_last=True))
    assert {topic: fate.gave_way for topic, fate in found.items() if fate.gave_way} == {}


def test_at_the_end_nothing_is_missed_of_what_is_on_its_way_to_somebody() -> None:
    ends = Ends(Link(((0, 1_000_000),)), SOURCES)
    ends.sender.follow(NEEDS)
    ends.run(6.0)
    assert ends.sender.take_missed(6 * S, is_last=True) == []
