# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``--when-slow repeat`` sends the newest message at each due time, exactly, while the source lives."""

from __future__ import annotations

import math
import random

from hypothesis import given
from hypothesis import strategies as st

from pacing.scenarios import (
    EPOCH_NS,
    S,
    jittered,
    relay,
    sample,
    samples_at,
    seeds,
    shares,
    source_rates,
    woken,
)
from smarttestudo.pacing.sample import StreamKind, WhenSlow
from smarttestudo.pacing.topic_pacer import TopicPacer


def repeating(rate_hz: float, stale_after_ns: int | None = None) -> TopicPacer:
    pacer = TopicPacer(when_slow=WhenSlow.REPEAT, stale_after_ns=stale_after_ns)
    pacer.set_rate(rate_hz, EPOCH_NS - S)
    return pacer


@given(st.floats(1, 100), st.floats(0.5, 200), seeds)
def test_the_newest_message_leaves_at_each_time_of_the_grid(
    source_hz: float, target_hz: float, seed: int
) -> None:
    times_ns = jittered(source_hz, 5, random.Random(seed))
    period_ns = math.floor(S / target_hz)
    arrivals = samples_at(times_ns)
    relayed = relay(repeating(target_hz), arrivals, drain=False)
    assert [r.at_ns for r in relayed] == list(range(times_ns[0], relayed[-1].at_ns + 1, period_ns))
    assert relayed[-1].at_ns > times_ns[-1] - period_ns
    for r in relayed[1:]:
        assert r.sample is next(s for at_ns, s in reversed(arrivals) if at_ns < r.at_ns)


@given(source_rates.filter(lambda hz: hz <= 100), shares, seeds)
def test_repetitions_are_told_apart_and_do_not_hide_a_message(
    source_hz: float, share: float, seed: int
) -> None:
    times_ns = jittered(source_hz, 5, random.Random(seed))
    relayed = relay(repeating(source_hz / share), samples_at(times_ns))
    first_time = [r.sample for r in relayed if not r.repeated]
    assert len(set(first_time)) == len(first_time)
    sent = set()
    for r in relayed:
        assert r.repeated == (r.sample in sent)
        sent.add(r.sample)


def test_it_stops_when_the_source_is_stale_and_begins_anew_with_the_next_message() -> None:
    pacer = repeating(10)
    times_ns = [EPOCH_NS + i * S // 5 for i in range(10)]
    later_ns = times_ns[-1] + 60 * S + 7
    relayed = relay(pacer, samples_at([*times_ns, later_ns]), drain=False)
    stale_ns = times_ns[-1] + 2 * S
    assert max(r.at_ns for r in relayed if r.at_ns < later_ns) == stale_ns
    assert relayed[-1].at_ns == later_ns
    assert pacer.wake_ns == later_ns + S // 10


def test_the_profile_decides_when_a_source_is_stale() -> None:
    for stale_after_ns, last_s in ((5 * S, 5), (5 * S - 1, 4)):
        pacer = repeating(1, stale_after_ns)
        relay(pacer, samples_at([EPOCH_NS]), drain=False)
        assert [r.at_ns - EPOCH_NS for r in woken(pacer, None)] == [S * i for i in range(1, last_s + 1)]


def test_a_message_that_waits_for_its_time_is_sent_even_if_its_source_is_stale_by_then() -> None:
    pacer = repeating(0.1)
    last = sample()
    arrivals = [(EPOCH_NS + i * S // 10, sample()) for i in range(5)]
    relayed = relay(pacer, [*arrivals, (EPOCH_NS + S, last)], drain=False) + woken(pacer, None)
    assert [(r.at_ns - EPOCH_NS, r.repeated) for r in relayed] == [(0, False), (10 * S, False)]
    assert relayed[-1].sample is last


def test_nothing_is_repeated_after_the_end_of_a_recording() -> None:
    pacer = repeating(10)
    relay(pacer, samples_at([EPOCH_NS, EPOCH_NS + 1]), drain=False)
    pacer.finish()
    assert [(r.at_ns - EPOCH_NS, r.repeated) for r in woken(pacer, None)] == [(S // 10, False)]


def test_full_passes_everything_and_repeats_nothing() -> None:
    times_ns = jittered(30, 5, random.Random(1))
    pacer = repeating(math.inf)
    relayed = relay(pacer, samples_at(times_ns), drain=False)
    assert [r.at_ns for r in relayed] == times_ns
    assert pacer.wake_ns is None


def test_off_stops_it_and_only_a_new_message_starts_it_again() -> None:
    pacer = repeating(10)
    relay(pacer, samples_at([EPOCH_NS + i * S // 50 for i in range(20)]), drain=False)
    pacer.set_rate(0, EPOCH_NS + S)
    assert pacer.wake_ns is None
    assert pacer.offer(sample(), EPOCH_NS + 2 * S) == ()
    pacer.set_rate(10, EPOCH_NS + 3 * S)
    assert pacer.wake_ns is None
    assert len(pacer.offer(sample(), EPOCH_NS + 4 * S)) == 1


def test_a_late_wake_up_sends_one_message_and_keeps_to_the_grid() -> None:
    pacer = repeating(10)
    relay(pacer, samples_at([EPOCH_NS]), drain=False)
    assert len(pacer.wake(EPOCH_NS + S // 2 + 5)) == 1
    assert pacer.wake_ns == EPOCH_NS + 6 * S // 10


def test_a_change_of_rate_is_followed_at_once() -> None:
    pacer = repeating(1)
    relay(pacer, samples_at([EPOCH_NS]), drain=False)
    pacer.set_rate(10, EPOCH_NS + S // 2)
    assert [r.at_ns - EPOCH_NS for r in woken(pacer, EPOCH_NS + S)] == [
        S // 2 + S * (2 * i + 1) // 20 for i in range(5)
    ]


def test_latched_topics_and_tf_are_never_repeated() -> None:
    for kind in (StreamKind.TRANSIENT_LOCAL, StreamKind.NAMED):
        pacer = TopicPacer(kind=kind, when_slow=WhenSlow.REPEAT)
        pacer.set_rate(100, EPOCH_NS)
        relay(pacer, samples_at([EPOCH_NS + i * S for i in range(5)]), drain=False)
        assert pacer.wake_ns is None


def test_a_pause_is_no_period_so_that_repeating_ends_soon_after_it_too() -> None:
    """Ten messages, years of nothing, five messages: as when a clock is set that began in 1970."""
    jump_ns = 56 * 365 * 86_400 * S
    times_ns = [start_ns + i * S // 5 for start_ns, count in ((0, 10), (jump_ns, 5)) for i in range(count)]
    for first in range(10):
        pacer = repeating(10)
        relayed = relay(pacer, samples_at(times_ns[first:]), drain=False)
        relayed += woken(pacer, None)
        assert len(relayed) < 200
        assert relayed[-1].at_ns == times_ns[-1] + 2 * S


def test_a_slow_source_is_repeated_throughout_once_its_period_is_known() -> None:
    times_ns = [EPOCH_NS + i * 3 * S for i in range(10)]
    relayed = relay(repeating(1), samples_at(times_ns), drain=False)
    assert [r.at_ns for r in relayed if r.at_ns >= times_ns[3]] == list(
        range(times_ns[3], times_ns[-1] + 1, S)
    )
