# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""transient_local topics: sparse samples pass whole, fast ones are thinned, the newest always follows."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import example, given
from hypothesis import strategies as st

from pacing.scenarios import EPOCH_NS, Relayed, S, relay, sample
from smarttestudo.pacing.sample import Sample, StreamKind
from smarttestudo.pacing.topic_pacer import TopicPacer


def latched(rate_hz: float) -> TopicPacer:
    pacer = TopicPacer(kind=StreamKind.TRANSIENT_LOCAL)
    pacer.set_rate(rate_hz, EPOCH_NS - S)
    return pacer


def every(period_s: float, count: int, publisher: str = "a", start_s: float = 0) -> list[tuple[int, Sample]]:
    return [(EPOCH_NS + round((start_s + i * period_s) * S), sample(publisher)) for i in range(count)]


def merged(*arrivals: list[tuple[int, Sample]]) -> list[tuple[int, Sample]]:
    return sorted((arrival for part in arrivals for arrival in part), key=lambda arrival: arrival[0])


def of(publisher: str, relayed: list[Relayed]) -> list[int]:
    return [r.at_ns for r in relayed if r.sample.publisher == publisher]


def test_all_that_each_publisher_says_in_its_first_two_seconds_passes() -> None:
    arrivals = merged(every(0.1, 21), every(0.1, 21, "b", start_s=5))
    relayed = relay(latched(0.1), arrivals)
    assert [r.sample for r in relayed] == [offered for _, offered in arrivals]


@example(gaps_ns=[S] * 10, target_hz=0.1)
@given(st.lists(st.integers(S, 100 * S), min_size=1, max_size=30), st.floats(0.001, 0.5))
def test_up_to_one_sample_a_second_passes_whatever_the_target(gaps_ns: list[int], target_hz: float) -> None:
    times_ns = [EPOCH_NS + sum(gaps_ns[:i]) for i in range(len(gaps_ns))]
    relayed = relay(latched(target_hz), [(at_ns, sample()) for at_ns in times_ns])
    assert [r.at_ns for r in relayed] == times_ns


def test_a_fast_one_is_thinned_to_its_target_and_the_newest_follows_as_soon_as_it_is_due() -> None:
    arrivals = every(0.1, 101)
    relayed = relay(latched(1), arrivals)
    assert relayed[-1].sample is arrivals[-1][1]
    thinned_ns = [r.at_ns for r in relayed if r.at_ns > EPOCH_NS + 2 * S]
    assert all(later - earlier == S for earlier, later in pairwise(thinned_ns))
    assert len(thinned_ns) == 9


def test_two_publishers_are_thinned_apart_and_each_has_its_newest_relayed() -> None:
    fast, slow = every(0.05, 200, "fast"), every(1.5, 7, "slow")
    relayed = relay(latched(0.5), merged(fast, slow))
    assert of("slow", relayed) == [at_ns for at_ns, _ in slow]
    assert next(r.sample for r in reversed(relayed) if r.sample.publisher == "fast") is fast[-1][1]
    assert sum(at_ns > EPOCH_NS + 2 * S for at_ns in of("fast", relayed)) <= 5


def test_off_passes_nothing_and_the_newest_of_each_publisher_follows_when_it_ends() -> None:
    pacer = latched(0)
    arrivals = merged(every(0.1, 5, "a"), every(0.1, 5, "b"))
    assert relay(pacer, arrivals) == []
    pacer.set_rate(2, EPOCH_NS + S)
    assert pacer.wake_ns == EPOCH_NS + S
    assert [passed.sample for passed in pacer.wake(EPOCH_NS + S)] == [arrivals[-2][1], arrivals[-1][1]]
    assert pacer.wake_ns is None


def test_off_keeps_the_newest_of_however_many_publishers() -> None:
    pacer = latched(0)
    arrivals = [(EPOCH_NS + i * S, sample(str(i))) for i in range(300)]
    relay(pacer, arrivals)
    pacer.set_rate(1, EPOCH_NS + 1000 * S)
    assert len(pacer.wake(EPOCH_NS + 1000 * S)) == 300


def test_after_the_clock_jumped_back_each_publisher_begins_anew() -> None:
    pacer = latched(0.1)
    relay(pacer, every(0.1, 100, start_s=100), drain=False)
    again = every(0.1, 50)
    relayed = [r for r in relay(pacer, again, drain=False) if r.sample in {offered for _, offered in again}]
    assert [r.at_ns for r in relayed] == [at_ns for at_ns, _ in again[:21]]


def test_a_topic_found_to_be_latched_keeps_what_was_held() -> None:
    pacer = TopicPacer()
    pacer.set_rate(1, EPOCH_NS)
    held = sample()
    pacer.offer(sample(), EPOCH_NS)
    pacer.offer(held, EPOCH_NS + 1)
    assert [p.sample for p in pacer.set_kind(StreamKind.TRANSIENT_LOCAL, EPOCH_NS + 2)] == [held]
    assert pacer.set_kind(StreamKind.TRANSIENT_LOCAL, EPOCH_NS + 2) == ()


def test_tf_static_is_latched_before_it_is_tf() -> None:
    tf = "tf2_msgs/msg/TFMessage"
    assert StreamKind.of(type_name=tf, transient_local=True) is StreamKind.TRANSIENT_LOCAL
    assert StreamKind.of(type_name=tf, transient_local=False) is StreamKind.NAMED
    assert StreamKind.of(type_name="", transient_local=False) is StreamKind.VOLATILE
