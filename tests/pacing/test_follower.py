# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``paced_with``: the stamps that a follower passes are exactly those that its leader passed."""

from __future__ import annotations

import math
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pacing.pairs import Event, Half, Pair, stamp, stamps
from pacing.scenarios import EPOCH_NS, S, sample, seeds
from smarttestudo.pacing.follower import MAX_PENDING, Follower, leaders
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.pacing.topic_pacer import TopicPacer

rates_hz = st.floats(0.3, 60)


def led_at(rate_hz: float, when_slow: WhenSlow = WhenSlow.PASS) -> Pair:
    leader = TopicPacer(when_slow=when_slow)
    leader.set_rate(rate_hz, EPOCH_NS - S)
    return Pair(leader)


def pairs(count: int, source_hz: float, rng: random.Random, lost: float = 0) -> list[Event]:
    """Pairs whose second half comes up to ten source periods before or after the first, in any order."""
    events = []
    for i in range(count):
        at_ns = EPOCH_NS + round((20 + i + rng.uniform(-0.2, 0.2)) * S / source_hz)
        apart_ns = round(rng.choice([0, 0.1, 1, 10]) * rng.uniform(-1, 1) * S / source_hz)
        events += [(at_ns, Half.LEADER, stamp(i)), (at_ns + apart_ns, Half.FOLLOWER, stamp(i))]
    rng.shuffle(events)
    return [event for event in sorted(events, key=lambda event: event[0]) if rng.random() >= lost]


@given(st.integers(1, 80), st.floats(1, 60), st.lists(rates_hz, min_size=1, max_size=5), seeds)
def test_the_stamps_passed_are_the_leader_s_exactly_in_whatever_order_the_halves_come(
    count: int, source_hz: float, targets: list[float], seed: int
) -> None:
    rng = random.Random(seed)
    pair = led_at(targets[0])
    changes = [
        (EPOCH_NS + round(rng.uniform(0, count / source_hz) * S), rng.choice([rate_hz, 0]))
        for rate_hz in targets[1:]
    ]
    pair.run(pairs(count, source_hz, rng), changes)
    pair.wake(None)
    assert sorted(stamps(pair.followed)) == sorted(stamps(pair.led))
    assert pair.follower.undecided == pair.follower.discarded == 0


@given(st.integers(1, 80), st.floats(1, 60), rates_hz, seeds)
def test_lost_halves_cost_their_own_pair_only(
    count: int, source_hz: float, target_hz: float, seed: int
) -> None:
    pair = led_at(target_hz)
    events = pairs(count, source_hz, random.Random(seed), lost=0.1)
    pair.run(events)
    pair.wake(None)
    came = {bytes_ for _, half, bytes_ in events if half is Half.FOLLOWER}
    assert sorted(stamps(pair.followed)) == sorted(s for s in stamps(pair.led) if s in came)
    unmatched = came - {bytes_ for _, half, bytes_ in events if half is Half.LEADER}
    assert pair.follower.undecided + pair.follower.discarded == len(unmatched)


@given(st.integers(5, 40), st.floats(1, 30), rates_hz, seeds)
def test_a_leader_that_repeats_a_stamp_repeats_its_partner(
    count: int, source_hz: float, target_hz: float, seed: int
) -> None:
    pair = led_at(target_hz, WhenSlow.REPEAT)
    rng = random.Random(seed)
    for i in range(count):
        at_ns = EPOCH_NS + round((i + rng.uniform(-0.2, 0.2)) * S / source_hz)
        pair.run([(at_ns, Half.FOLLOWER, stamp(i)), (at_ns, Half.LEADER, stamp(i))])
    pair.leader.finish()
    pair.wake(None)
    assert [(r.at_ns, r.sample.stamp, r.repeated) for r in pair.followed] == [
        (r.at_ns, r.sample.stamp, r.repeated) for r in pair.led
    ]


def test_a_repeated_stamp_without_a_partner_repeats_nobody_else() -> None:
    pair = led_at(1, WhenSlow.REPEAT)
    pair.run([(EPOCH_NS, half, stamp(0)) for half in Half])
    pair.run([(EPOCH_NS + S // 2, Half.LEADER, stamp(1))])
    pair.wake(EPOCH_NS + 5 * S)
    assert stamps(pair.led) == [stamp(0)] + 5 * [stamp(1)]
    assert stamps(pair.followed) == [stamp(0)]


def test_drivers_that_leave_all_stamps_at_zero_have_their_pairs_thinned_alike() -> None:
    pair = led_at(10)
    pair.run([(EPOCH_NS + i * S // 30, half, stamp(0)) for i in range(300) for half in Half])
    assert len(pair.followed) == len(pair.led)


def test_a_partner_follows_the_leader_s_last_word_when_it_is_spoken() -> None:
    pair = led_at(1)
    pair.run([(EPOCH_NS + i, half, stamp(i)) for i in range(3) for half in Half])
    assert stamps(pair.followed) == [stamp(0)]
    pair.wake(None)
    assert [(r.at_ns, r.sample.stamp) for r in pair.followed[1:]] == [(EPOCH_NS + 2 + S, stamp(2))]


def test_the_partner_of_a_held_stamp_is_the_last_to_make_room() -> None:
    pair = led_at(1)
    pair.run([(EPOCH_NS + i, half, stamp(i)) for i in range(2) for half in Half])
    strays = 10 * MAX_PENDING
    pair.run([(EPOCH_NS + 10 + i, Half.FOLLOWER, stamp(100 + i)) for i in range(strays)])
    assert pair.follower.undecided == MAX_PENDING
    pair.wake(None)
    assert stamps(pair.followed) == [stamp(0), stamp(1)]
    assert pair.follower.discarded + pair.follower.undecided == strays


def test_everything_passes_while_the_leader_is_full() -> None:
    pair = led_at(math.inf)
    pair.run([(EPOCH_NS + i, Half.FOLLOWER, stamp(i)) for i in range(50)])
    assert len(pair.followed) == 50
    pair.set_rate(EPOCH_NS + 50, 1)
    pair.run([(EPOCH_NS + 51, Half.FOLLOWER, stamp(51))])
    assert len(pair.followed) == 50


def test_a_follower_that_is_off_passes_nothing_whatever_its_leader_does() -> None:
    pair = led_at(1000)
    pair.offer(EPOCH_NS, Half.FOLLOWER, stamp(0))
    pair.follower.set_rate(0, EPOCH_NS)
    pair.run([(EPOCH_NS + i, half, stamp(i)) for i in range(50) for half in Half])
    pair.wake(None)
    assert (pair.followed, pair.follower.undecided) == ([], 0)
    pair.follower.set_rate(3, EPOCH_NS + S)
    pair.run([(EPOCH_NS + S, half, stamp(50)) for half in Half])
    assert stamps(pair.followed) == [stamp(50)]


def test_a_message_without_a_readable_stamp_is_counted() -> None:
    pair = led_at(1)
    assert pair.follower.offer(sample(), EPOCH_NS) == ()
    assert pair.follower.discarded == 1


def test_a_leader_may_have_several_followers() -> None:
    pair = led_at(1)
    second = Follower()
    pair.leader.add_follower(second)
    second.offer(sample(stamp=stamp(0)), EPOCH_NS)
    pair.run([(EPOCH_NS, half, stamp(0)) for half in Half])
    assert stamps(pair.followed) == [stamp(0)]
    assert [passed.sample.stamp for passed in second.wake(EPOCH_NS)] == [stamp(0)]


@pytest.mark.parametrize(
    ("paced_with", "expected"),
    [
        ({"/info": "/image"}, {"/info": "/image"}),
        ({"/info": "/elsewhere"}, {}),
        ({"/info": "/right", "/right": "/image"}, {"/info": "/image", "/right": "/image"}),
        ({"/info": "/right", "/right": "/elsewhere"}, {"/info": "/right"}),
        ({"/right": "/image", "/image": "/right"}, {"/right": "/image"}),
        (
            {"/info": "/right", "/right": "/image", "/image": "/right"},
            {"/info": "/image", "/right": "/image"},
        ),
        ({"/info": "/info"}, {}),
        ({"/elsewhere": "/image"}, {}),
    ],
)
def test_chains_and_circles_have_one_relayed_leader(
    paced_with: dict[str, str], expected: dict[str, str]
) -> None:
    assert leaders(paced_with, {"/info", "/image", "/right"}) == expected
