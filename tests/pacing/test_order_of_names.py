# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Of each name in the messages of a topic, the last that is relayed is the last that was sent."""

from __future__ import annotations

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from pacing.scenarios import EPOCH_NS, S, relay, sample
from smarttestudo.pacing.cdr import DELETE, DELETE_ALL
from smarttestudo.pacing.sample import Sample, StreamKind
from smarttestudo.pacing.streams import MAX_STREAMS
from smarttestudo.pacing.topic_pacer import TopicPacer

kinds = st.sampled_from([StreamKind.NAMED, StreamKind.TRANSIENT_LOCAL])
gaps_s = st.sampled_from([0.001, 0.01, 0.1, 0.5, 1.0, 3.0])
names = st.lists(st.sampled_from("abc"), min_size=1, max_size=3, unique=True).map(tuple)


@given(
    kinds, st.lists(st.tuples(gaps_s, names), min_size=1, max_size=12), st.sampled_from([0.1, 0.2, 1, 2, 5])
)
@example(StreamKind.NAMED, [(0.001, ("a", "b")), (0.01, ("b", "a")), (3.0, ("b", "c"))], 0.2)
def test_nothing_passes_behind_a_newer_message_of_a_name_in_it(
    kind: StreamKind, sent: list[tuple[float, tuple[str, ...]]], target_hz: float
) -> None:
    arrivals: list[tuple[int, Sample]] = []
    at_ns = EPOCH_NS
    for gap_s, frames in sent:
        at_ns += round(gap_s * S)
        arrivals.append((at_ns, sample(frames=frames)))
    pacer = TopicPacer(kind=kind)
    pacer.set_rate(target_hz, EPOCH_NS)
    shown = {name: one.sample for one in relay(pacer, arrivals) for name in one.sample.frames}
    assert shown == {name: one for _, one in arrivals for name in one.frames}


def marker(action: int, *frames: str) -> Sample:
    return Sample(payload=b"", size_bytes=0, frames=frames, deletion=action)


@pytest.mark.parametrize(
    ("before", "meanwhile", "shown"),
    [
        ([(DELETE_ALL, "/0")], [(0, "a"), (DELETE_ALL, "/0")], [(DELETE_ALL, "/0")]),
        ([(0, "a"), (0, "b")], [(0, "a", "b"), (DELETE, "a")], [(0, "a", "b"), (DELETE, "a")]),
        ([(0, "b"), (0, "a")], [(0, "a", "b"), (0, "a")], [(0, "a", "b"), (0, "a")]),
    ],
)
def test_what_came_while_off_follows_in_its_order(
    before: list[tuple[int, str]], meanwhile: list[tuple[int, str]], shown: list[tuple[int, str]]
) -> None:
    pacer = TopicPacer(kind=StreamKind.TRANSIENT_LOCAL)
    pacer.set_rate(1, EPOCH_NS - S)
    for second, one in enumerate(before):
        pacer.offer(marker(*one), EPOCH_NS + second * S)
    pacer.set_rate(0, EPOCH_NS + 5 * S)
    for second, one in enumerate(meanwhile):
        pacer.offer(marker(*one), EPOCH_NS + (6 + second) * S)
    pacer.set_rate(1, EPOCH_NS + 10 * S)
    passed = [one.sample for _, passes in pacer.wake_until(EPOCH_NS + 30 * S) for one in passes]
    assert [(one.deletion, *one.frames) for one in passed] == shown


@pytest.mark.parametrize("held", [[("a", "b"), ("b", "c")], [("b", "c"), ("a", "b")]])
def test_of_one_time_the_first_to_come_passes_first(held: list[tuple[str, ...]]) -> None:
    """Whatever names were there before, in their order."""
    for known in (("a", "b", "c"), ("c", "b", "a"), ("b", "c", "a")):
        arrivals = [(EPOCH_NS, sample(frames=(name,))) for name in known]
        arrivals += [(EPOCH_NS + S // 10, sample(frames=frames)) for frames in held]
        pacer = TopicPacer(kind=StreamKind.NAMED)
        pacer.set_rate(1, EPOCH_NS)
        relayed = [one.sample for one in relay(pacer, arrivals)]
        assert relayed == [one for _, one in arrivals]


@pytest.mark.parametrize("frames", [(), ("camera",), ("camera", "lens")])
@pytest.mark.parametrize(("parts", "target_hz"), [(2, 1), (10, 1), (10, 3), (30, 5)])
def test_of_one_name_or_none_no_part_of_a_burst_starves(
    parts: int, target_hz: float, frames: tuple[str, ...]
) -> None:
    """As where ten devices send a status of the same name."""
    seconds = round(30 * parts / target_hz)
    arrivals = [
        (EPOCH_NS + second * S + part * S // 500, sample(frames=frames))
        for second in range(seconds)
        for part in range(parts)
    ]
    pacer = TopicPacer(kind=StreamKind.NAMED)
    pacer.set_rate(target_hz, EPOCH_NS)
    part_of = {one: number % parts for number, (_, one) in enumerate(arrivals)}
    passed = [part_of[one.sample] for one in relay(pacer, arrivals, drain=False)]
    assert len(passed) == pytest.approx(target_hz * seconds, abs=2 + target_hz)
    # The first two bursts show that they are some.
    length = max(30, 3 * parts)
    for start in range(int(2 * target_hz), len(passed) - length, length):
        assert set(passed[start : start + length]) == set(range(parts))


def test_of_more_names_than_are_told_apart_none_starves() -> None:
    known = [(EPOCH_NS - 1, sample(frames=(f"known {number}",))) for number in range(MAX_STREAMS)]
    more = [
        (EPOCH_NS + second * S + part * S // 500, sample(frames=(f"more {part}",)))
        for second in range(120)
        for part in range(10)
    ]
    pacer = TopicPacer(kind=StreamKind.NAMED)
    pacer.set_rate(1, EPOCH_NS - S)
    relayed = relay(pacer, [*known, *more], drain=False)[MAX_STREAMS:]
    for start_ns in range(EPOCH_NS, EPOCH_NS + 90 * S, 10 * S):
        passed = {r.sample.frames for r in relayed if start_ns <= r.at_ns < start_ns + 30 * S}
        assert len(passed) == 10


def test_a_message_of_several_names_that_share_a_stream_counts_once() -> None:
    names = [tuple(f"{number} {i}" for i in range(3)) for number in range(MAX_STREAMS // 3 + 20)]
    arrivals = [(EPOCH_NS + tenth * S // 10, sample(frames=names[-1])) for tenth in range(200)]
    pacer = TopicPacer(kind=StreamKind.NAMED)
    pacer.set_rate(2, EPOCH_NS - S)
    relay(pacer, [(EPOCH_NS - 1, sample(frames=frames)) for frames in names], drain=False)
    assert len(relay(pacer, arrivals, drain=False)) == pytest.approx(40, abs=2)
