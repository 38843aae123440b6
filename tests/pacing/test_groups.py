# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Coded video passes in whole beginnings of groups, and no more of it than its rate."""

from __future__ import annotations

import itertools
import math
import random
from collections import Counter
from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pacing.scenarios import EPOCH_NS, Relayed, S, relay, seeds
from smarttestudo.pacing.coded_video import VideoFrame
from smarttestudo.pacing.sample import Sample, StreamKind
from smarttestudo.pacing.stream import AHEAD_AT_MOST_NS
from smarttestudo.pacing.topic_pacer import TopicPacer

KEY, DIFFERENCE, PARAMETERS, UNKNOWN = (
    VideoFrame.KEY,
    VideoFrame.DIFFERENCE,
    VideoFrame.PARAMETERS,
    VideoFrame.UNKNOWN,
)
source_hz = st.sampled_from([5.0, 10.0, 15.0, 25.0, 30.0, 60.0])
targets_hz = st.one_of(st.floats(-1, 2).map(lambda exponent: 10**exponent), st.sampled_from([0.0, math.inf]))
lengths = st.lists(st.integers(1, 90), min_size=1, max_size=12)


def sample(frame: VideoFrame | None, publisher: str = "") -> Sample:
    return Sample(payload=b"", size_bytes=0, publisher=publisher, frame=frame)


def paced(rate_hz: float = math.inf) -> TopicPacer:
    pacer = TopicPacer(kind=StreamKind.CODED_VIDEO)
    pacer.set_rate(rate_hz, EPOCH_NS - S)
    return pacer


def video(
    groups: Sequence[int], hz: float, *, jitter: float = 0.0, seed: int = 0, alone: bool = False
) -> list[tuple[int, Sample]]:
    """Frames of groups of so many; with parameters ``alone``, before each key frame in their own message."""
    rng, arrivals, number = random.Random(seed), [], 0
    for length in groups:
        for at in range(length):
            at_ns = EPOCH_NS + round(S * (number + rng.uniform(0, jitter)) / hz)
            number += 1
            if alone and at == 0:
                arrivals.append((at_ns, sample(PARAMETERS)))
            arrivals.append((at_ns, sample(DIFFERENCE if at else KEY)))
    return arrivals


def assert_decodable(arrivals: Sequence[tuple[int, Sample]], relayed: Sequence[Relayed]) -> None:
    """Of each publisher, what is relayed follows on what was before it, back to a key frame."""
    passed = {one.sample for one in relayed}
    for publisher in {one.publisher for _, one in arrivals}:
        own = [one for _, one in arrivals if one.publisher == publisher]
        decodable, has_parameters, before = False, True, None
        for one in own:
            if one.frame is UNKNOWN:
                continue
            is_first = before is not PARAMETERS
            before = one.frame
            if one.frame is PARAMETERS:
                has_parameters = one in passed and (is_first or has_parameters)
                continue
            decodable |= one.frame is KEY and (is_first or has_parameters)
            if one in passed:
                assert decodable
            else:
                decodable = False


@given(lengths, source_hz, targets_hz, st.booleans(), seeds)
def test_no_frame_passes_whose_predecessor_was_left_out(
    groups: list[int], hz: float, target_hz: float, alone: bool, seed: int
) -> None:
    arrivals = video(groups, hz, jitter=seed % 10 / 10, seed=seed, alone=alone)
    assert_decodable(arrivals, relay(paced(target_hz), arrivals))


@given(lengths, source_hz, st.lists(targets_hz, min_size=1, max_size=6), seeds)
def test_nor_does_one_whatever_the_rates_were_and_whenever_nobody_listened(
    groups: list[int], hz: float, targets: list[float], seed: int
) -> None:
    rng, pacer, arrivals = random.Random(seed), paced(), video(groups, hz)
    relayed: list[Relayed] = []
    for at_ns, one in arrivals:
        if rng.random() < 0.05:
            pacer.set_rate(rng.choice(targets), at_ns)
        if relayed and rng.random() < 0.02:
            pacer.end_groups()
            continue
        relayed += relay(pacer, [(at_ns, one)], drain=False)
    assert_decodable(arrivals, relayed)


@pytest.mark.parametrize("target_hz", [0.2, 0.5, 0.9, 1, 1.5, 2, 3, 10])
@pytest.mark.parametrize("before_key", [[], [PARAMETERS], [PARAMETERS, PARAMETERS], [PARAMETERS, UNKNOWN]])
def test_parameters_in_messages_of_their_own_take_nothing_from_their_key_frame(
    before_key: list[VideoFrame], target_hz: float
) -> None:
    arrivals = [
        (EPOCH_NS + group * S + at * S // 30, sample(frame))
        for group in range(60)
        for at in range(30)
        for frame in ((*before_key, KEY) if at == 0 else (DIFFERENCE,))
    ]
    relayed = relay(paced(target_hz), arrivals, drain=False)
    passed = Counter(one.sample.frame for one in relayed)
    # How long groups last is not known of the first one.
    assert passed[KEY] + passed[DIFFERENCE] == pytest.approx(60 * target_hz, abs=2 + target_hz)
    assert passed[KEY] == pytest.approx(60 * min(target_hz, 1), abs=2)
    assert passed[PARAMETERS] == before_key.count(PARAMETERS) * passed[KEY]
    assert_decodable(arrivals, relayed)


def test_parameters_that_are_repeated_amid_a_group_make_no_difference_decodable() -> None:
    arrivals = [
        (EPOCH_NS + at * S // 30, sample(frame))
        for at in range(3000)
        for frame in (
            (PARAMETERS, KEY)
            if at % 150 == 0
            else (PARAMETERS, DIFFERENCE)
            if at % 30 == 0
            else (DIFFERENCE,)
        )
    ]
    relayed = relay(paced(3), arrivals, drain=False)
    assert sum(one.sample.frame is KEY for one in relayed) == 20
    assert_decodable(arrivals, relayed)


@given(lengths, lengths, source_hz, targets_hz, seeds)
def test_groups_of_two_cameras_are_their_own(
    groups: list[int], others: list[int], hz: float, target_hz: float, seed: int
) -> None:
    first = video(groups, hz, jitter=0.5, seed=seed)
    second = [(at_ns, sample(one.frame, "b")) for at_ns, one in video(others, 7.0, seed=seed)]
    arrivals = sorted([*first, *second], key=lambda arrival: arrival[0])
    relayed = relay(paced(target_hz), arrivals)
    assert_decodable(arrivals, relayed)
    alone = relay(paced(target_hz), first)
    assert [one for one in relayed if not one.sample.publisher] == alone


@given(lengths, source_hz, st.floats(0.2, 60), st.floats(0, 0.9), seeds)
def test_in_no_window_pass_more_than_the_rate_and_a_group_of_two_seconds(
    groups: list[int], hz: float, target_hz: float, jitter: float, seed: int
) -> None:
    relayed = relay(paced(target_hz), video(groups, hz, jitter=jitter, seed=seed))
    slack_s = max(2 / target_hz, 0.25) + AHEAD_AT_MOST_NS / S
    times_ns = [one.at_ns for one in relayed]
    for (i, first_ns), (j, last_ns) in itertools.combinations(enumerate(times_ns), 2):
        assert j - i + 1 <= ((last_ns - first_ns) / S + slack_s) * target_hz + 2


@given(st.integers(2, 60), st.sampled_from([15.0, 30.0]), st.floats(0.02, 0.98), st.floats(0, 0.4), seeds)
def test_the_mean_is_the_rate_where_groups_last_up_to_two_seconds(
    length: int, hz: float, share: float, jitter: float, seed: int
) -> None:
    length = min(length, round(1.9 * hz))
    count = int(60 * hz / length)
    target_hz, group_s = share * hz, length / hz
    relayed = relay(paced(target_hz), video([length] * count, hz, jitter=jitter, seed=seed), drain=False)
    expected = count * group_s * target_hz
    assert expected - target_hz * 2 * group_s - 2 <= len(relayed) <= expected + target_hz * group_s + 2


@given(st.integers(2, 600), st.sampled_from([15.0, 30.0]), st.floats(0.05, 0.99), st.floats(0, 0.4), seeds)
def test_every_key_frame_passes_where_the_rate_has_two_frames_for_each_group(
    length: int, hz: float, share: float, jitter: float, seed: int
) -> None:
    group_s = length / hz
    target_hz = max(share * hz, 2 / group_s)
    arrivals = video([length] * 12, hz, jitter=jitter, seed=seed)
    passed = {one.sample for one in relay(paced(target_hz), arrivals, drain=False)}
    keys = [one for _, one in arrivals if one.frame is KEY]
    assert [one in passed for one in keys[2:]] == [True] * 10


@pytest.mark.parametrize(("target_hz", "shown"), [(1, 1), (2, 2), (10, 10), (15, 15), (25, 25), (29, 29)])
def test_of_each_second_the_first_part_is_shown(target_hz: float, shown: int) -> None:
    arrivals = video([30] * 20, 30)
    passed = {one.sample for one in relay(paced(target_hz), arrivals, drain=False)}
    counts = [sum(one in passed for _, one in arrivals[at : at + 30]) for at in range(0, 600, 30)]
    assert set(counts[12:]) == {shown}


def test_of_a_group_longer_than_that_the_first_two_seconds_worth_pass_and_then_the_next_key_frame() -> None:
    arrivals = video([300] * 4, 30)
    passed = {one.sample for one in relay(paced(10), arrivals, drain=False)}
    counts = [sum(one in passed for _, one in arrivals[at : at + 300]) for at in range(0, 1200, 300)]
    assert counts[2] == counts[3]
    assert 20 <= counts[3] <= 24


def in_lumps(frames: Sequence[tuple[int, Sample]], lump: int) -> list[tuple[int, Sample]]:
    """So many arrive together, with the last of them."""
    times_ns = [at_ns for at_ns, _ in frames]
    last = len(frames) - 1
    return [(times_ns[min(i // lump * lump + lump - 1, last)], one) for i, (_, one) in enumerate(frames)]


@pytest.mark.parametrize("length", [150, 250, 300])
@pytest.mark.parametrize(
    ("share", "lump"),
    [(0.9, 1), (0.93, 1), *((share, lump) for share in (0.97, 0.99, 0.997) for lump in (1, 8))],
)
def test_of_long_groups_a_few_percent_below_the_source_as_much_passes(
    share: float, length: int, lump: int
) -> None:
    arrivals = in_lumps(video([length] * 20, 30, jitter=0.2), lump)
    relayed = relay(paced(30 * share), arrivals, drain=False)
    assert len(relayed) == pytest.approx(30 * share * 20 * length / 30, rel=0.03)
    assert_decodable(arrivals, relayed)


@pytest.mark.parametrize("target_hz", [30, 30.5, 45])
@pytest.mark.parametrize("length", [30, 300])
def test_of_lumps_at_their_own_rate_or_above_every_frame_passes(length: int, target_hz: float) -> None:
    arrivals = in_lumps(video([length] * 6, 30), 8)
    assert len(relay(paced(target_hz), arrivals, drain=False)) == len(arrivals)


def test_at_its_own_rate_or_above_every_frame_passes() -> None:
    for target_hz in (30, 40, math.inf):
        for groups in ([30] * 10, [300, 7, 90], [1] * 50):
            arrivals = video(groups, 30, jitter=0.4)
            assert len(relay(paced(target_hz), arrivals, drain=False)) == len(arrivals)


def test_before_the_first_key_frame_all_passes_and_then_the_rate_holds() -> None:
    arrivals = [(EPOCH_NS + i * S // 30, sample(DIFFERENCE if i < 45 or i % 30 else KEY)) for i in range(300)]
    passed = {one.sample for one in relay(paced(10), arrivals, drain=False)}
    counts = [sum(one in passed for _, one in arrivals[at : at + 30]) for at in range(0, 300, 30)]
    assert counts[:2] == [30, 30]
    assert all(9 <= count <= 11 for count in counts[4:])


@pytest.mark.parametrize("frame", [UNKNOWN, DIFFERENCE])
def test_a_coder_that_is_not_known_passes_whole_but_while_off(frame: VideoFrame) -> None:
    arrivals = [(EPOCH_NS + i * S // 30, sample(frame)) for i in range(300)]
    assert len(relay(paced(0.5), arrivals)) == 300
    assert relay(paced(0), arrivals) == []


def test_after_off_it_goes_on_with_a_key_frame() -> None:
    arrivals = video([30] * 4, 30)
    changes = [(EPOCH_NS + S // 3, 0.0), (EPOCH_NS + S + S // 3, math.inf)]
    relayed = relay(paced(), arrivals, changes)
    assert [one.sample for one in relayed] == [one for _, one in [*arrivals[:10], *arrivals[60:]]]


def test_the_last_word_is_a_key_frame_that_was_held_and_never_a_difference() -> None:
    arrivals = [(EPOCH_NS, sample(KEY)), (EPOCH_NS + 1, sample(DIFFERENCE))]
    assert len(relay(paced(1), arrivals)) == 1
    late = sample(KEY)
    arrivals += [(EPOCH_NS + S // 10, late), (EPOCH_NS + S // 5, sample(DIFFERENCE))]
    last = relay(paced(1), arrivals)[-1]
    assert (last.sample, last.at_ns) == (late, EPOCH_NS + S // 5 + S)
