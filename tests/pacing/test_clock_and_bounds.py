# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Clocks jump, publishers come and go: no stream stalls, and no state grows."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pacing.scenarios import EPOCH_NS, S, relay, sample, samples_at, woken
from smarttestudo.pacing.sample import StreamKind, WhenSlow
from smarttestudo.pacing.streams import MAX_STREAMS
from smarttestudo.pacing.topic_pacer import TopicPacer


def paced(
    rate_hz: float, kind: StreamKind = StreamKind.VOLATILE, when_slow: WhenSlow = WhenSlow.PASS
) -> TopicPacer:
    pacer = TopicPacer(kind=kind, when_slow=when_slow)
    pacer.set_rate(rate_hz, EPOCH_NS - S)
    return pacer


@given(
    st.floats(0.01, 100), st.integers(1, 10**6 * S), st.sampled_from(StreamKind), st.sampled_from(WhenSlow)
)
def test_after_a_jump_back_the_next_message_passes_at_once_and_the_rate_holds(
    target_hz: float, back_ns: int, kind: StreamKind, when_slow: WhenSlow
) -> None:
    pacer = paced(target_hz, kind, when_slow)
    relay(pacer, samples_at([EPOCH_NS + i * S // 50 for i in range(100)]), drain=False)
    start_ns = EPOCH_NS + 99 * S // 50 - back_ns
    relayed = relay(pacer, samples_at([start_ns + i * S // 50 for i in range(500)]), drain=False)
    assert relayed[0].at_ns == start_ns
    if kind is not StreamKind.TRANSIENT_LOCAL and when_slow is WhenSlow.PASS:
        assert abs(len(relayed) - 1 - min(target_hz, 50) * 499 / 50) <= 1


def test_what_is_held_when_the_clock_jumps_back_still_arrives() -> None:
    for kind in StreamKind:
        pacer = paced(1, kind)
        relay(pacer, samples_at([EPOCH_NS + i * S // 20 for i in range(200)]), drain=False)
        held = sample()
        pacer.offer(sample(), EPOCH_NS + 10 * S)
        pacer.offer(held, EPOCH_NS + 10 * S)
        at_once = [passed.sample for passed in pacer.wake(EPOCH_NS - 1000 * S)]
        assert [*at_once, *(r.sample for r in woken(pacer, EPOCH_NS - 999 * S))] == [held]


def test_repeating_waits_for_a_message_after_a_jump_back() -> None:
    pacer = paced(10, when_slow=WhenSlow.REPEAT)
    relay(pacer, samples_at([EPOCH_NS, EPOCH_NS + S]), drain=False)
    pacer.wake(EPOCH_NS + S + S // 10)
    pacer.wake(EPOCH_NS)
    assert pacer.wake_ns is None


def test_a_message_never_sent_is_sent_once_after_a_jump_back() -> None:
    pacer = paced(1, when_slow=WhenSlow.REPEAT)
    held = sample()
    arrivals = [*samples_at([EPOCH_NS + i * S // 4 for i in range(30)]), (EPOCH_NS + 30 * S // 4, held)]
    relay(pacer, arrivals, drain=False)
    at_once = pacer.wake(EPOCH_NS - 1000 * S)
    assert [(passed.sample, passed.repeated) for passed in at_once] == [(held, False)]
    assert pacer.wake_ns is None


@pytest.mark.parametrize("kind", StreamKind)
@pytest.mark.parametrize("rate_hz", [0, 0.001, 10, math.inf])
def test_publishers_and_frames_that_never_return_do_not_pile_up(kind: StreamKind, rate_hz: float) -> None:
    pacer = paced(rate_hz, kind)
    count = 3 * MAX_STREAMS
    arrivals = [(EPOCH_NS + i * S // 10, sample(publisher=i, frames=(f"f{i}",))) for i in range(count)]
    relayed = relay(pacer, arrivals)
    assert len(pacer._streams._streams) <= MAX_STREAMS + 1
    assert len(relayed) <= count
    if rate_hz >= 10:
        assert len(relayed) == count
        assert len(pacer._streams._streams) < 200


def test_a_last_word_of_the_shared_stream_is_spoken_once_even_if_its_frame_has_its_own_by_then() -> None:
    pacer = paced(10, StreamKind.NAMED)
    streams = pacer._streams
    count = 0
    while len(streams._streams) <= MAX_STREAMS or streams._opens_to_prune > 1:
        count += 1
        pacer.offer(sample(frames=(f"f{count}",)), EPOCH_NS)
    pacer.offer(sample(frames=("prunes",)), EPOCH_NS + 10 * S)
    assert [passed.sample.frames for passed in pacer.wake(EPOCH_NS + 10 * S)] == [(f"f{count}",)]
    assert pacer.wake_ns is None


def test_keys_beyond_the_limit_share_one_stream_and_still_have_a_last_word() -> None:
    pacer = paced(0.001, StreamKind.NAMED)
    last = sample(frames=("last",))
    arrivals = [(EPOCH_NS + i, sample(frames=(f"f{i}",))) for i in range(2 * MAX_STREAMS)]
    relayed = relay(pacer, [*arrivals, (EPOCH_NS + S, last)])
    assert relayed[-1].sample is last
    assert len(relayed) == MAX_STREAMS + 2
