# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Of each name in the messages of a topic, the last that is relayed is the last that was sent."""

from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from pacing.scenarios import EPOCH_NS, S, relay, sample
from smarttestudo.pacing.cdr import DELETE, DELETE_ALL
from smarttestudo.pacing.sample import Sample, StreamKind
from smarttestudo.pacing.topic_pacer import TopicPacer

kinds = st.sampled_from([StreamKind.NAMED, StreamKind.TRANSIENT_LOCAL])
gaps_s = st.sampled_from([0.001, 0.01, 0.1, 0.5, 1.0, 3.0])
names = st.lists(st.sampled_from("abc"), min_size=1, max_size=3, unique=True).map(tuple)


@given(
    kinds,
    st.lists(st.tuples(gaps_s, names), min_size=1, max_size=12),
    st.sampled_from([0.1, 0.2, 1, 2, 5]),
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


def test_of_what_names_nothing_no_part_of_a_burst_starves() -> None:
    arrivals = [
        (EPOCH_NS + second * S + part * S // 500, part) for second in range(300) for part in range(10)
    ]
    parts = {sample(): part for _, part in arrivals}
    pacer = TopicPacer(kind=StreamKind.NAMED)
    pacer.set_rate(1, EPOCH_NS)
    times = [at_ns for at_ns, _ in arrivals]
    passed = Counter(
        parts[one.sample] for one in relay(pacer, list(zip(times, parts, strict=True)), drain=False)
    )
    assert min(passed[part] for part in range(10)) >= 20
    assert sum(passed.values()) == pytest.approx(300, abs=2)
