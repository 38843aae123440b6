# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates and sizes equal those of a naive count over all messages."""

from __future__ import annotations

import statistics
from collections import Counter
from itertools import groupby

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.bags.statistics import LatencyAccumulator, RecordingSpan, TraceAccumulator, topic_statistics
from smarttestudo.domain.record import to_json
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.report.run_report import MAX_POINTS, bandwidth_series, coarser, rate_series

Message = tuple[int, int]

stamps = st.integers(1_700_000_000 * NS_PER_S, 1_700_000_012 * NS_PER_S)
traces = st.lists(st.tuples(stamps, st.integers(0, 7_000_000)), max_size=60)


def trace_of(messages: list[Message]) -> TraceAccumulator:
    trace = TraceAccumulator()
    for stamp_ns, size_bytes in messages:
        trace.add(stamp_ns, size_bytes)
    return trace


def span_of(messages: list[Message]) -> RecordingSpan:
    stamps_ns = [stamp_ns for stamp_ns, _ in messages]
    return RecordingSpan(start_ns=min(stamps_ns, default=0), end_ns=max(stamps_ns, default=0))


@given(traces)
def test_bins_are_those_of_a_count_by_whole_seconds_in_any_order_of_arrival(messages: list[Message]) -> None:
    seconds = Counter(stamp_ns // NS_PER_S for stamp_ns, _ in messages)
    sizes: Counter[int] = Counter()
    for stamp_ns, size_bytes in messages:
        sizes[stamp_ns // NS_PER_S] += size_bytes
    found = [(one.second, one.messages, one.size_bytes) for one in trace_of(messages).bins()]
    assert found == [(second, seconds[second], sizes[second]) for second in sorted(seconds)]


@given(batches=st.lists(traces, max_size=4), is_in_order=st.booleans())
def test_messages_counted_at_once_are_counted_as_one_by_one(
    batches: list[list[Message]], is_in_order: bool
) -> None:
    one_by_one, at_once = TraceAccumulator(), TraceAccumulator()
    for batch in batches:
        messages = sorted(batch) if is_in_order else batch
        for stamp_ns, size_bytes in messages:
            one_by_one.add(stamp_ns, size_bytes)
        at_once.add_all([stamp_ns for stamp_ns, _ in messages], [size for _, size in messages])
    assert [*at_once.bins()] == [*one_by_one.bins()]
    assert (at_once.first_ns, at_once.last_ns) == (one_by_one.first_ns, one_by_one.last_ns)


@given(traces.filter(bool))
def test_statistics_equal_a_naive_count(messages: list[Message]) -> None:
    span = span_of(messages)
    found = topic_statistics(trace_of(messages), span)
    stamps_ns = sorted(stamp_ns for stamp_ns, _ in messages)
    size_bytes = sum(size for _, size in messages)
    bins = range(stamps_ns[0] // NS_PER_S, stamps_ns[-1] // NS_PER_S + 1)
    counts = [sum(stamp_ns // NS_PER_S == second for stamp_ns in stamps_ns) for second in bins]
    duration_s = (stamps_ns[-1] - stamps_ns[0]) / 1e9

    assert (found.messages, found.size_bytes) == (len(messages), size_bytes)
    assert found.start_s == 0
    assert found.end_s == duration_s
    assert found.binned_hz == pytest.approx(sum(counts) / len(counts), rel=1e-12)
    if duration_s == 0:
        assert found.mean_hz is None
        assert found.kb_per_s is None
        assert found.kbit_per_s is None
    else:
        assert found.mean_hz == pytest.approx((len(messages) - 1) / duration_s, rel=1e-12)
        assert found.kb_per_s == pytest.approx(size_bytes / 1000 / duration_s, rel=1e-12)
        assert found.kbit_per_s == pytest.approx(size_bytes * 8 / 1000 / duration_s, rel=1e-12)


def test_one_message_has_no_mean_rate_but_a_binned_one() -> None:
    span = RecordingSpan(start_ns=0, end_ns=10 * NS_PER_S)
    found = topic_statistics(trace_of([(3 * NS_PER_S, 500)]), span)
    assert to_json(found) == {
        "messages": 1,
        "bytes": 500,
        "start_s": 3.0,
        "end_s": 3.0,
        "mean_hz": None,
        "binned_hz": 1.0,
        "kb_per_s": 0.05,
        "kbit_per_s": 0.4,
        "declared": False,
    }


def test_a_topic_without_a_message_carried_nothing_at_no_known_time() -> None:
    found = topic_statistics(TraceAccumulator(), RecordingSpan(start_ns=0, end_ns=NS_PER_S))
    assert (found.messages, found.binned_hz, found.kb_per_s) == (0, 0.0, 0.0)
    assert (found.start_s, found.end_s, found.mean_hz) == (None, None, None)


def test_bandwidth_counts_over_the_whole_recording_not_over_the_topic() -> None:
    burst = trace_of([(second * NS_PER_S, 1000) for second in range(5)])
    found = topic_statistics(burst, RecordingSpan(start_ns=0, end_ns=100 * NS_PER_S))
    assert found.kb_per_s == 0.05


@given(traces, stamps, stamps, st.integers(1, 15))
def test_a_chart_shows_the_least_and_the_greatest_rate_of_each_stretch(
    messages: list[Message], one_ns: int, other_ns: int, max_points: int
) -> None:
    span = RecordingSpan(start_ns=min(one_ns, other_ns), end_ns=max(one_ns, other_ns))
    first, end = -(-span.start_ns // NS_PER_S), span.end_ns // NS_PER_S
    counts = [sum(stamp_ns // NS_PER_S == second for stamp_ns, _ in messages) for second in range(first, end)]
    width = max(1, -(-len(counts) // max_points))
    groups = [list(group) for _, group in groupby(range(len(counts)), key=lambda index: index // width)]

    found = rate_series(trace_of(messages), span, max_points=max_points)

    assert len(found) <= max_points
    in_groups = [[counts[index] for index in group] for group in groups]
    assert [(point.lowest, point.highest) for point in found] == [
        (min(values), max(values)) for values in in_groups
    ]
    assert [point.mean for point in found] == pytest.approx([statistics.fmean(one) for one in in_groups])
    for point, group in zip(found, groups, strict=True):
        middle_s = first + (group[0] + group[-1] + 1) / 2 - span.start_ns / NS_PER_S
        assert point.t_s == pytest.approx(middle_s, abs=1e-5)


def test_a_jump_of_the_clock_over_decades_costs_no_memory_and_no_time() -> None:
    trace = trace_of([(0, 1), (1_700_000_000 * NS_PER_S, 1), (1_700_000_003 * NS_PER_S, 1)])
    span = RecordingSpan(start_ns=0, end_ns=1_700_000_003 * NS_PER_S)
    assert len(list(trace.bins())) == 3
    assert len(rate_series(trace, span)) <= MAX_POINTS
    assert topic_statistics(trace, span).binned_hz == 3 / 1_700_000_004


@given(traces, st.integers(1, 15))
def test_joining_neighbours_keeps_the_extremes(messages: list[Message], max_points: int) -> None:
    points = rate_series(trace_of(messages), span_of(messages))
    joined = coarser(points, max_points)
    assert len(joined) <= max_points
    if points:
        assert max(point.highest for point in joined) == max(point.highest for point in points)
        assert min(point.lowest for point in joined) == min(point.lowest for point in points)


@given(traces, traces)
def test_the_bandwidth_of_several_topics_is_their_sum_in_each_second(
    one: list[Message], other: list[Message]
) -> None:
    span = span_of([*one, *other])
    parts = [bandwidth_series([trace_of(messages)], span) for messages in (one, other)]
    together = bandwidth_series([trace_of(one), trace_of(other)], span)
    assert [point.mean for point in together] == [
        pytest.approx(first.mean + second.mean) for first, second in zip(*parts, strict=True)
    ]


@given(st.lists(st.none() | st.integers(-(2**65), 2**65) | st.integers(-(10**11), 10**11), min_size=1))
def test_latencies_that_none_can_be_are_counted_and_in_no_number(latencies_ns: list[int | None]) -> None:
    latencies = LatencyAccumulator()
    for latency_ns in latencies_ns:
        latencies.add(latency_ns)
    stamped = [one for one in latencies_ns if one is not None]
    possible = [one for one in stamped if -NS_PER_S // 10 <= one <= 60 * NS_PER_S]
    assert latencies.used == len(possible)
    assert latencies.used + latencies.unset + latencies.early + latencies.late == len(latencies_ns)
    assert (latencies.notice() is None) == (len(possible) == len(latencies_ns) or not stamped)
    if possible:
        assert latencies.latency().max_s == pytest.approx(max(possible) / NS_PER_S)
