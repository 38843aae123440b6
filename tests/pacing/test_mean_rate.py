# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The mean rate is what was asked for, whatever the source does."""

from __future__ import annotations

import math
import random
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pacing.scenarios import EPOCH_NS, Relayed, S, jittered, relay, samples_at, seeds, shares, source_rates
from smarttestudo.pacing.topic_pacer import TopicPacer

windows_s = st.floats(10, 30)


def thinned(times_ns: list[int], target_hz: float) -> list[Relayed]:
    """What passes of the arrivals while they last; the last word after them is another test's."""
    pacer = TopicPacer()
    pacer.set_rate(target_hz, times_ns[0])
    return relay(pacer, samples_at(times_ns), drain=False)


def messages_off(relayed: list[Relayed], target_hz: float) -> float:
    """How many messages more than asked for passed between the first one relayed and the last."""
    return len(relayed) - 1 - target_hz * (relayed[-1].at_ns - relayed[0].at_ns) / S


@given(source_rates, shares, windows_s, seeds)
def test_the_mean_is_exact_to_one_message_under_jitter(
    source_hz: float, share: float, seconds: float, seed: int
) -> None:
    target_hz = source_hz * share
    relayed = thinned(jittered(source_hz, seconds, random.Random(seed)), target_hz)
    assert abs(messages_off(relayed, target_hz)) <= 1


@given(source_rates, shares, windows_s, seeds)
def test_the_mean_is_exact_to_two_messages_with_a_clock_of_ten_hertz(
    source_hz: float, share: float, seconds: float, seed: int
) -> None:
    target_hz = source_hz * share
    ticks_ns = [t - t % (S // 10) for t in jittered(source_hz, seconds, random.Random(seed))]
    whole_ticks_ns = [t for t in ticks_ns if t < ticks_ns[-1]]
    assert abs(messages_off(thinned(whole_ticks_ns, target_hz), target_hz)) <= 2


@given(source_rates, shares, windows_s)
def test_the_mean_is_exact_to_two_messages_in_bursts_of_four(
    source_hz: float, share: float, seconds: float
) -> None:
    slowest_hz = 4 / max(0.25, 2 / (source_hz * share))
    source_hz = max(source_hz, slowest_hz)
    target_hz = source_hz * share
    if 4 / source_hz > max(0.25, 2 / target_hz):
        target_hz = source_hz / 2
    bursts_ns = [EPOCH_NS + round(S * 4 * i / source_hz) for i in range(int(seconds * source_hz / 4) + 1)]
    relayed = thinned([t for t in bursts_ns for _ in range(4)], target_hz)
    assert abs(messages_off(relayed, target_hz)) <= 2


@given(source_rates, st.floats(0.01, 0.9), windows_s, seeds)
def test_the_mean_is_exact_to_two_messages_when_every_tenth_is_lost(
    source_hz: float, share: float, seconds: float, seed: int
) -> None:
    target_hz = 0.9 * source_hz * share
    arrived_ns = [t for i, t in enumerate(jittered(source_hz, seconds, random.Random(seed))) if i % 10 != 7]
    assert abs(messages_off(thinned(arrived_ns, target_hz), target_hz)) <= 2


@given(source_rates.filter(lambda hz: hz >= 14), st.floats(0.01, 0.9), windows_s, seeds)
def test_the_mean_is_exact_to_two_messages_and_a_permille_when_one_of_ten_is_lost_at_random(
    source_hz: float, share: float, seconds: float, seed: int
) -> None:
    """From 14 Hz on the slack covers two lost in a row with their jitter, 3.4 source periods."""
    rng = random.Random(seed)
    target_hz = 0.9 * source_hz * share
    times_ns = jittered(source_hz, seconds, rng)
    lost = {tenth + rng.randrange(10) for tenth in range(0, len(times_ns), 10)}
    relayed = thinned([t for i, t in enumerate(times_ns) if i not in lost], target_hz)
    assert abs(messages_off(relayed, target_hz)) <= 2 + 0.001 * len(relayed)


@given(source_rates, st.one_of(st.just(1.0), st.floats(1, 100), st.just(math.inf)), seeds)
def test_a_target_at_or_above_the_source_passes_everything(
    source_hz: float, factor: float, seed: int
) -> None:
    times_ns = jittered(source_hz, 10, random.Random(seed))
    assert [r.at_ns for r in thinned(times_ns, source_hz * factor)] == times_ns


gaps_ns = st.one_of(st.just(0), st.integers(0, S // 100), st.integers(0, S), st.integers(0, 20 * S))


@given(st.lists(gaps_ns, min_size=2, max_size=60), st.floats(0.05, 1000))
def test_no_window_passes_more_than_the_rate_and_the_slack_allow(gaps: list[int], target_hz: float) -> None:
    times_ns = [EPOCH_NS + sum(gaps[:i]) for i in range(len(gaps))]
    pacer = TopicPacer()
    pacer.set_rate(target_hz, EPOCH_NS)
    passed_ns = [r.at_ns for r in relay(pacer, samples_at(times_ns))]
    longest_s = min(max(b - a for a, b in pairwise(times_ns)) / S, 2)
    slack_s = max(2 / target_hz, 0.25, longest_s)
    for first, start_ns in enumerate(passed_ns):
        for last in range(first, len(passed_ns)):
            window_s = (passed_ns[last] - start_ns) / S
            assert last - first + 1 <= (window_s + slack_s) * target_hz + 2


@pytest.mark.parametrize(
    ("silence_s", "made_up_s"), [(0.1, 0.1), (0.25, 0.25), (0.6, 0.6), (2, 2), (2.5, 2), (100, 2)]
)
def test_after_a_silence_as_much_is_made_up_for_as_it_was_long_up_to_two_seconds(
    silence_s: float, made_up_s: float
) -> None:
    burst_ns = [EPOCH_NS + round(silence_s * S)] * 1000
    assert len(thinned([EPOCH_NS, *burst_ns], 100)) == pytest.approx(1 + 100 * made_up_s, abs=1)


def test_a_gap_counts_for_a_minute() -> None:
    """One of a second at the start: as long as it counts, so much credit is kept."""
    for seconds, made_up_s in ((55, 1), (75, 0.25)):
        times_ns = [EPOCH_NS, *(EPOCH_NS + S + i * S // 10 for i in range(10 * seconds))]
        burst = samples_at([*times_ns, *[times_ns[-1]] * 1000])
        passed = relay(TopicPacer(), burst, [(EPOCH_NS, 100)], drain=False)
        assert len(passed) - len(times_ns) == pytest.approx(100 * made_up_s, abs=1)


def test_after_a_silence_a_slow_target_makes_up_for_two_messages_also_when_it_then_rises() -> None:
    burst = samples_at([EPOCH_NS, *[EPOCH_NS + 100 * S] * 1000])
    assert len(relay(TopicPacer(), burst, [(EPOCH_NS, 1)], drain=False)) == 1 + 2 + 1
    raised = [(EPOCH_NS, 1), (EPOCH_NS + 99 * S, 100)]
    assert len(relay(TopicPacer(), burst, raised, drain=False)) == 1 + 2 + 100 + 1
    raised_late = [(EPOCH_NS, 1), (EPOCH_NS + 100 * S, 100)]
    assert len(relay(TopicPacer(), burst, raised_late, drain=False)) == 1 + 2 + 1


def test_full_earns_no_credit() -> None:
    burst = samples_at([EPOCH_NS, *[EPOCH_NS + 100 * S] * 1000])
    changes = [(EPOCH_NS, math.inf), (EPOCH_NS + 100 * S, 100)]
    assert len(relay(TopicPacer(), burst, changes, drain=False)) == 1 + 1


def changing(rng: random.Random, seconds: float, rates_hz: list[float]) -> list[tuple[int, float]]:
    """Changes at random times, the first before the first message; often several between two messages."""
    count = int(rng.expovariate(1 / 20)) + 1
    times_ns = sorted(EPOCH_NS + round(rng.uniform(0, seconds) * S) for _ in range(count))
    return [(EPOCH_NS - S, rng.choice(rates_hz)), *((t, rng.choice(rates_hz)) for t in times_ns)]


def asked_for(changes: list[tuple[int, float]], start_ns: int, end_ns: int) -> float:
    """The integral of the target from start to end, in messages."""
    ends_ns = [t for t, _ in changes[1:]] + [end_ns]
    pieces = zip(changes, ends_ns, strict=True)
    return sum(max(0, min(to, end_ns) - max(at, start_ns)) * rate_hz / S for (at, rate_hz), to in pieces)


@given(source_rates, st.lists(shares, min_size=2, max_size=4), st.floats(5, 20), seeds)
def test_the_mean_follows_a_changing_target_to_two_messages_however_often_it_changes(
    source_hz: float, targets: list[float], seconds: float, seed: int
) -> None:
    rng = random.Random(seed)
    times_ns = jittered(source_hz, seconds, rng)
    changes = changing(rng, seconds, [source_hz * share for share in targets])
    relayed = relay(TopicPacer(), samples_at(times_ns), changes, drain=False)
    assert abs(len(relayed) - asked_for(changes, times_ns[0], times_ns[-1])) <= 2


@given(source_rates, st.lists(st.one_of(st.floats(1, 5), st.just(math.inf)), min_size=2, max_size=4), seeds)
def test_changing_targets_at_or_above_the_source_pass_everything(
    source_hz: float, targets: list[float], seed: int
) -> None:
    rng = random.Random(seed)
    times_ns = jittered(source_hz, 10, rng)
    changes = changing(rng, 10, [source_hz, *(source_hz * factor for factor in targets)])
    assert [r.at_ns for r in relay(TopicPacer(), samples_at(times_ns), changes)] == times_ns


@settings(max_examples=50)
@given(source_rates, st.lists(st.floats(1, 5), min_size=1, max_size=3), seeds)
def test_off_passes_nothing_and_afterwards_everything_passes_again(
    source_hz: float, targets: list[float], seed: int
) -> None:
    rng = random.Random(seed)
    times_ns = jittered(source_hz, 10, rng)
    changes = changing(rng, 10, [0, *(source_hz * factor for factor in targets)])
    passed_ns = {r.at_ns for r in relay(TopicPacer(), samples_at(times_ns), changes)}
    rate_at = {t: next(rate for at, rate in reversed(changes) if at <= t) for t in times_ns}
    assert passed_ns == {t for t in times_ns if rate_at[t] > 0}


def test_silence_between_two_rates_does_not_owe_the_messages_of_a_slow_period_at_once() -> None:
    times_ns = [EPOCH_NS + i * S // 200 for i in range(200 * 20)]
    changes = [(EPOCH_NS + i * S // 2, (1, 100)[i % 2]) for i in range(40)]
    relayed = relay(TopicPacer(), samples_at(times_ns), changes, drain=False)
    assert abs(len(relayed) - 20 * 101 / 2) <= 2
