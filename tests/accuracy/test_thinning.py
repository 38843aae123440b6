# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A recorded topic is thinned as relays thin it: with its last word, by frame, and latched."""

from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.accuracy.samples import thinned
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.sample import StreamKind

TENTH = NS_PER_S // 10


def test_the_mean_rate_is_the_one_asked_for() -> None:
    stamps_ns = [n * TENTH for n in range(1001)]
    passed = thinned(stamps_ns, 3, end_ns=stamps_ns[-1], kind=StreamKind.VOLATILE)
    assert len(passed.indices) in {300, 301}
    assert list(passed.stamps_ns) == [stamps_ns[index] for index in passed.indices]


def test_the_last_word_arrives_late_but_before_the_end() -> None:
    passed = thinned([0, TENTH, 2 * TENTH], 1, end_ns=10 * NS_PER_S, kind=StreamKind.VOLATILE)
    assert list(passed.indices) == [0, 2]
    assert 2 * TENTH < passed.stamps_ns[1] <= 2 * NS_PER_S
    assert list(thinned([0, TENTH], 1, end_ns=TENTH, kind=StreamKind.VOLATILE).indices) == [0]


def test_transforms_are_thinned_by_frame() -> None:
    stamps_ns = [n * TENTH for n in range(100)]
    frames = [("wheel",) if n % 2 else ("base",) for n in range(100)]
    passed = thinned(stamps_ns, 1, end_ns=stamps_ns[-1], kind=StreamKind.NAMED, frames=frames)
    by_frame = [sum(frames[index] == (name,) for index in passed.indices) for name in ("base", "wheel")]
    assert by_frame in ([10, 10], [11, 11])


def test_a_slow_latched_topic_passes_whole() -> None:
    stamps_ns = [n * NS_PER_S for n in range(20)]
    passed = thinned(stamps_ns, 0.1, end_ns=stamps_ns[-1], kind=StreamKind.TRANSIENT_LOCAL)
    assert list(passed.indices) == list(range(20))


@given(
    stamps_ns=st.lists(st.integers(0, 10 * NS_PER_S), max_size=30).map(sorted),
    rate_hz=st.one_of(st.just(0.0), st.just(math.inf), st.floats(0.1, 100)),
    kind=st.sampled_from(StreamKind),
)
def test_what_passes_was_sent_before_in_order_and_once(
    stamps_ns: list[int], rate_hz: float, kind: StreamKind
) -> None:
    passed = thinned(stamps_ns, rate_hz, end_ns=20 * NS_PER_S, kind=kind, frames=[()] * len(stamps_ns))
    assert list(passed.indices) == sorted(set(passed.indices))
    assert list(passed.stamps_ns) == sorted(passed.stamps_ns)
    assert all(
        stamps_ns[index] <= stamp_ns for index, stamp_ns in zip(passed.indices, passed.stamps_ns, strict=True)
    )
    if math.isinf(rate_hz):
        assert len(passed.indices) == len(stamps_ns)
    if rate_hz == 0:
        assert not passed.indices
