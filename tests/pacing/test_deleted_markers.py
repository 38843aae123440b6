# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Markers are gone for who has the relayed messages, too, once they were deleted."""

from __future__ import annotations

import random

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from pacing.scenarios import EPOCH_NS, S, relay, seeds
from smarttestudo.pacing.cdr import DELETE, DELETE_ALL
from smarttestudo.pacing.sample import Sample, StreamKind
from smarttestudo.pacing.topic_pacer import TopicPacer

ADD = 0
KINDS = (StreamKind.NAMED, StreamKind.TRANSIENT_LOCAL)


def markers(action: int, names: tuple[str, ...]) -> Sample:
    return Sample(payload=b"", size_bytes=0, frames=names, deletion=action)


def shown(samples: list[Sample]) -> set[str]:
    there: set[str] = set()
    for one in samples:
        if one.deletion == DELETE_ALL:
            there.clear()
        else:
            there = there - set(one.frames) if one.deletion == DELETE else there | set(one.frames)
    return there


arrays = st.lists(
    st.tuples(
        st.integers(0, S // 4),
        st.sampled_from([ADD, ADD, ADD, DELETE, DELETE_ALL]),
        st.lists(st.sampled_from("abcd"), min_size=1, max_size=3, unique=True).map(tuple),
    ),
    max_size=60,
)


@pytest.mark.parametrize("kind", KINDS)
@example([(0, ADD, ("a", "b")), (1, ADD, ("a", "b")), (1, DELETE, ("a",))], 1.0)
@given(arrays, st.floats(0.05, 20))
def test_in_the_end_the_same_markers_are_there(
    kind: StreamKind, steps: list[tuple[int, int, tuple[str, ...]]], target_hz: float
) -> None:
    arrivals, at_ns = [], EPOCH_NS
    for gap_ns, action, names in steps:
        at_ns += gap_ns
        arrivals.append((at_ns, markers(action, names)))
    pacer = TopicPacer(kind=kind)
    pacer.set_rate(target_hz, EPOCH_NS - S)
    relayed = [one.sample for one in relay(pacer, arrivals)]
    assert shown(relayed) == shown([one for _, one in arrivals])
    assert {one for _, one in arrivals if one.deletion} <= set(relayed)


@given(seeds)
def test_a_deletion_counts_for_the_rate_of_its_markers(seed: int) -> None:
    chance = random.Random(seed)
    arrivals = [
        (EPOCH_NS + i * S // 20, markers(DELETE if chance.random() < 0.02 else ADD, ("a",)))
        for i in range(1200)
    ]
    pacer = TopicPacer(kind=StreamKind.NAMED)
    pacer.set_rate(5, EPOCH_NS - S)
    deletions = sum(one.deletion > 0 for _, one in arrivals)
    assert len(relay(pacer, arrivals)) <= 60 * 5 + 2 * deletions + 12


def test_off_is_obeyed() -> None:
    pacer = TopicPacer(kind=StreamKind.NAMED)
    pacer.set_rate(0, EPOCH_NS - S)
    assert relay(pacer, [(EPOCH_NS, markers(DELETE_ALL, ("a",)))]) == []
