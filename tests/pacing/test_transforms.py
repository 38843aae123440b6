# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""/tf is thinned by child frame: each at its rate, none starved, each last word once."""

from __future__ import annotations

import random
from itertools import pairwise

from hypothesis import given, settings
from hypothesis import strategies as st

from pacing.scenarios import EPOCH_NS, S, jittered, relay, sample, seeds
from smarttestudo.pacing.sample import Sample, StreamKind
from smarttestudo.pacing.topic_pacer import TopicPacer

SECONDS = 10
broadcasters = st.lists(
    st.tuples(
        st.floats(1, 100), st.lists(st.sampled_from("abcdef"), min_size=1, max_size=4, unique=True).map(tuple)
    ),
    min_size=1,
    max_size=4,
)
"""Rates in Hz with the frames that each message holds; frames may come from several broadcasters."""


def transforms(rate_hz: float) -> TopicPacer:
    pacer = TopicPacer(kind=StreamKind.NAMED)
    pacer.set_rate(rate_hz, EPOCH_NS - S)
    return pacer


def broadcast(parts: list[tuple[float, tuple[str, ...]]], seed: int) -> list[tuple[int, Sample]]:
    rng = random.Random(seed)
    arrivals = [(t, sample(frames=frames)) for hz, frames in parts for t in jittered(hz, SECONDS, rng)]
    return sorted(arrivals, key=lambda arrival: arrival[0])


@settings(max_examples=50)
@given(broadcasters, st.floats(0.5, 60), seeds)
def test_no_frame_gets_less_than_its_rate_nor_all_of_them_more_than_theirs(
    parts: list[tuple[float, tuple[str, ...]]], target_hz: float, seed: int
) -> None:
    """Less by two messages: the end of its window, and what jitter leaves owed there."""
    arrivals = broadcast(parts, seed)
    relayed = relay(transforms(target_hz), arrivals, drain=False)
    frames = {frame for _, held in parts for frame in held}
    for frame in frames:
        steadiest_hz = max(hz for hz, held in parts if frame in held)
        passed = sum(frame in r.sample.frames for r in relayed)
        assert passed >= min(target_hz, steadiest_hz) * (SECONDS - 2 / steadiest_hz) - 2
    slack_s = max(2 / target_hz, 0.25)
    assert len(relayed) <= len(frames) * ((SECONDS + 2 + slack_s) * target_hz + 2)


@settings(max_examples=50)
@given(st.lists(st.integers(0, S), min_size=1, max_size=60), st.floats(0.1, 100))
def test_one_broadcaster_of_many_frames_is_thinned_like_one_of_a_single_frame(
    gaps_ns: list[int], target_hz: float
) -> None:
    times_ns = [EPOCH_NS + sum(gaps_ns[:i]) for i in range(len(gaps_ns))]
    many, single = (
        relay(
            transforms(target_hz),
            [(at_ns, sample(stamp=b"%d" % i, frames=frames)) for i, at_ns in enumerate(times_ns)],
        )
        for frames in (("a", "b", "c"), ("a",))
    )
    assert [(r.at_ns, r.sample.stamp) for r in many] == [(r.at_ns, r.sample.stamp) for r in single]


@settings(max_examples=50)
@given(broadcasters, st.floats(0.5, 60), seeds)
def test_the_last_transform_of_every_frame_arrives(
    parts: list[tuple[float, tuple[str, ...]]], target_hz: float, seed: int
) -> None:
    arrivals = broadcast(parts, seed)
    relayed = relay(transforms(target_hz), arrivals)
    samples = {r.sample for r in relayed}
    assert len(samples) == len(relayed)
    for frame in {frame for _, held in parts for frame in held}:
        assert next(s for _, s in reversed(arrivals) if frame in s.frames) in samples


def test_a_frame_that_travelled_with_others_is_not_starved_once_they_are_gone() -> None:
    together = [(EPOCH_NS + i * S // 400, sample(frames=("a", f"b{i % 8}"))) for i in range(4000)]
    alone = [(EPOCH_NS + 10 * S + i * S // 100, sample(frames=("a",))) for i in range(100)]
    relayed = relay(transforms(10), together + alone, drain=False)
    passed_ns = [r.at_ns for r in relayed if "a" in r.sample.frames]
    assert max(b - a for a, b in pairwise(passed_ns)) <= S // 10 + S // 100


def test_a_last_word_of_several_frames_passes_once() -> None:
    held = sample(frames=("a", "b"))
    arrivals = [
        (EPOCH_NS, sample(frames=("a",))),
        (EPOCH_NS + 1, sample(frames=("b",))),
        (EPOCH_NS + 2, held),
    ]
    relayed = relay(transforms(1), arrivals)
    assert [r.sample for r in relayed].count(held) == 1
    assert relayed[-1].sample is held


def test_a_last_word_waits_until_its_frame_is_due_again() -> None:
    """b's frame is paid for by a's last word, which holds it too."""
    word_of_a, word_of_b = sample(frames=("a", "b")), sample(frames=("b",))
    arrivals = [
        (EPOCH_NS, sample(frames=("a", "b"))),
        (EPOCH_NS + S // 10, word_of_a),
        (EPOCH_NS + S // 5, word_of_b),
    ]
    first, last = relay(transforms(1), arrivals)[1:]
    assert (first.sample, first.at_ns - EPOCH_NS) == (word_of_a, 11 * S // 10)
    # The phase of b's rate moves by up to a tenth of the period, as something was held back.
    assert last.sample is word_of_b
    assert 3 * S // 2 <= last.at_ns - EPOCH_NS <= 16 * S // 10


def test_messages_without_frames_are_thinned_as_one_stream() -> None:
    relayed = relay(transforms(10), [(EPOCH_NS + i * S // 100, sample()) for i in range(1000)], drain=False)
    assert abs(len(relayed) - 100) <= 1
