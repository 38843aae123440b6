# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The final value of every stream arrives, and steady streams do not notice."""

from __future__ import annotations

import itertools
import math
import random

import pytest
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

gaps_ns = st.one_of(st.just(0), st.integers(0, S // 100), st.integers(0, S), st.integers(0, 20 * S))
arrivals_ns = st.lists(gaps_ns, min_size=1, max_size=80).map(
    lambda gaps: [EPOCH_NS + sum(gaps[: i + 1]) for i in range(len(gaps))]
)
targets_hz = st.floats(-1, 3).map(lambda exponent: 10**exponent)


def paced(
    rate_hz: float, kind: StreamKind = StreamKind.VOLATILE, when_slow: WhenSlow = WhenSlow.PASS
) -> TopicPacer:
    pacer = TopicPacer(kind=kind, when_slow=when_slow)
    pacer.set_rate(rate_hz, EPOCH_NS - S)
    return pacer


def naive_relay(times_ns: list[int], target_hz: float) -> list[tuple[int, int]]:
    """A second opinion that sees the future: when something is relayed, and which arrival."""
    period_ns = math.floor(S / target_hz)
    due_ns = times_ns[0] - period_ns // 2
    relayed = []
    for i, at_ns in enumerate(times_ns):
        newer_ns = times_ns[i + 1] if i + 1 < len(times_ns) else math.inf
        since_ns = (at_ns // (10 * S) - 6) * 10 * S
        gaps = [min(b - a, 2 * S) for a, b in itertools.pairwise(times_ns[: i + 1]) if b >= since_ns]
        slack_ns = max(2 * period_ns, S // 4, max(gaps, default=0))
        squares_us2 = sum((gap // 1000) ** 2 for gap in gaps)
        burst_ns = squares_us2 // (sum(gaps) // 1000) * 1000 if sum(gaps) >= 1000 else 0
        last_word_ns = at_ns + max(period_ns, 2 * burst_ns)
        passed_ns = at_ns if at_ns >= due_ns else last_word_ns
        if passed_ns == at_ns or last_word_ns <= newer_ns:
            relayed.append((passed_ns, i))
            due_ns = max(due_ns, passed_ns - slack_ns) + period_ns
    return relayed


@given(arrivals_ns, targets_hz)
def test_one_thing_is_relayed_as_by_a_naive_pacer_with_foresight(
    times_ns: list[int], target_hz: float
) -> None:
    """Images by themselves on a topic of coded video: streams whose phase does not move."""
    arrivals = samples_at(times_ns)
    index_of = {offered: i for i, (_, offered) in enumerate(arrivals)}
    pacer = paced(target_hz, StreamKind.CODED_VIDEO)
    relayed = [(r.at_ns, index_of[r.sample]) for r in relay(pacer, arrivals)]
    assert relayed == naive_relay(times_ns, target_hz)


@given(
    arrivals_ns,
    st.lists(targets_hz, min_size=1, max_size=4),
    st.sampled_from(StreamKind),
    st.sampled_from(WhenSlow),
    seeds,
)
def test_the_newest_message_is_relayed_in_the_end_whatever_the_rates_were(
    times_ns: list[int], targets: list[float], kind: StreamKind, when_slow: WhenSlow, seed: int
) -> None:
    rng = random.Random(seed)
    changes_ns = sorted(rng.randint(EPOCH_NS, times_ns[-1]) for _ in targets[1:])
    changes = [(EPOCH_NS - S, targets[0]), *zip(changes_ns, targets[1:], strict=True)]
    arrivals = samples_at(times_ns)
    relayed = relay(TopicPacer(kind=kind, when_slow=when_slow), arrivals, changes)
    assert relayed[-1].sample is arrivals[-1][1]
    assert all(a.at_ns <= b.at_ns for a, b in itertools.pairwise(relayed))


@given(arrivals_ns, targets_hz, st.sampled_from(StreamKind))
def test_without_repeating_nothing_is_relayed_twice_or_before_it_came(
    times_ns: list[int], target_hz: float, kind: StreamKind
) -> None:
    arrivals = samples_at(times_ns)
    came_ns = {offered: at_ns for at_ns, offered in arrivals}
    relayed = relay(paced(target_hz, kind), arrivals)
    assert len({r.sample for r in relayed}) == len(relayed)
    assert all(r.at_ns >= came_ns[r.sample] and not r.repeated for r in relayed)


@given(source_rates, shares, seeds)
def test_no_last_word_interrupts_a_steady_stream(source_hz: float, share: float, seed: int) -> None:
    """With two intervals known; the first alone may be as short as 0.6 periods."""
    times_ns = jittered(source_hz, 10, random.Random(seed))
    relayed = relay(paced(source_hz * share), samples_at(times_ns), drain=False)
    came_ns = set(times_ns)
    assert all(r.at_ns in came_ns for r in relayed if r.at_ns > times_ns[2])


def test_an_emergency_stop_that_turned_true_and_fell_silent_arrives_one_period_later() -> None:
    pacer = paced(1)
    stop = sample()
    assert len(pacer.offer(sample(), EPOCH_NS)) == 1
    assert pacer.offer(stop, EPOCH_NS + S // 10) == ()
    (word,) = woken(pacer, None)
    assert (word.sample, word.at_ns) == (stop, EPOCH_NS + S // 10 + S)


def test_the_last_word_waits_for_two_source_periods_where_they_are_longer_or_for_two_bursts() -> None:
    pacer = paced(1.5)
    relay(pacer, samples_at([EPOCH_NS, EPOCH_NS + S, EPOCH_NS + 2 * S]), drain=False)
    burst = [sample() for _ in range(4)]
    passed = [bool(pacer.offer(offered, EPOCH_NS + 3 * S)) for offered in burst]
    assert passed == [True, True, True, False]
    assert [(r.sample, r.at_ns) for r in woken(pacer, None)] == [(burst[-1], EPOCH_NS + 3 * S + 2 * S)]


def test_what_arrives_while_off_is_not_relayed_later() -> None:
    pacer = paced(0)
    pacer.offer(sample(), EPOCH_NS)
    pacer.set_rate(10, EPOCH_NS + S)
    assert pacer.wake_ns is None


def test_off_lets_go_of_what_was_held() -> None:
    pacer = paced(1)
    pacer.offer(sample(), EPOCH_NS)
    pacer.offer(sample(), EPOCH_NS + 1)
    pacer.set_rate(0, EPOCH_NS + 2)
    pacer.set_rate(1, EPOCH_NS + 3)
    assert pacer.wake_ns is None


def test_each_publisher_has_its_own_grid_and_its_own_last_word() -> None:
    pacer = paced(1)
    a, b = [sample("a") for _ in range(3)], [sample("b") for _ in range(3)]
    arrivals = [(EPOCH_NS + i, offered) for i, offered in enumerate([a[0], b[0], a[1], b[1], a[2], b[2]])]
    assert [r.sample for r in relay(pacer, arrivals)] == [a[0], b[0], a[2], b[2]]


@given(
    st.lists(st.tuples(gaps_ns, st.sampled_from("abc")), min_size=1, max_size=60),
    targets_hz,
    st.sampled_from([StreamKind.VOLATILE, StreamKind.TRANSIENT_LOCAL]),
    st.sampled_from(WhenSlow),
)
def test_publishers_do_not_change_what_is_relayed_of_each_other(
    steps: list[tuple[int, str]], target_hz: float, kind: StreamKind, when_slow: WhenSlow
) -> None:
    times_ns = [EPOCH_NS + sum(gap for gap, _ in steps[: i + 1]) for i in range(len(steps))]
    arrivals = [(at_ns, sample(publisher)) for at_ns, (_, publisher) in zip(times_ns, steps, strict=True)]
    together = relay(paced(target_hz, kind, when_slow), arrivals)
    end_ns = times_ns[-1]
    for publisher in "abc":
        own = [arrival for arrival in arrivals if arrival[1].publisher == publisher]
        pacer = paced(target_hz, kind, when_slow)
        alone = relay(pacer, own, drain=False) + woken(pacer, end_ns)
        pacer.finish()
        assert alone + woken(pacer, None) == [r for r in together if r.sample.publisher == publisher]


def test_a_publisher_is_not_starved_by_a_faster_one() -> None:
    fast = [(EPOCH_NS + i * S // 100, sample("fast")) for i in range(1000)]
    slow = [(EPOCH_NS + i * S // 5, sample("slow")) for i in range(50)]
    relayed = relay(paced(5), sorted(fast + slow, key=lambda arrival: arrival[0]), drain=False)
    assert [r.sample for r in relayed if r.sample.publisher == "slow"] == [offered for _, offered in slow]
    assert len(relayed) - 50 == 51


@pytest.mark.parametrize("rate_hz", [-1.0, math.nan])
def test_a_rate_that_is_none_is_refused(rate_hz: float) -> None:
    with pytest.raises(ValueError, match="a rate is not negative"):
        TopicPacer().set_rate(rate_hz, 0)


def test_the_slowest_rates_that_a_rule_can_ask_for_are_rates() -> None:
    relayed = relay(paced(1e-9), samples_at([EPOCH_NS, EPOCH_NS + S]))
    assert [r.at_ns for r in relayed] == [EPOCH_NS, EPOCH_NS + S + 10**18]
    assert relay(paced(5e-324), samples_at([EPOCH_NS])) == []
