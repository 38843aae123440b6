# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The rule behind each moment of a run."""

from __future__ import annotations

from collections import Counter
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.rate import Rate
from smarttestudo.report.document import rule_legend
from smarttestudo.report.rule_timeline import (
    DecidingBlock,
    RuleSpan,
    RuleStyle,
    block_at,
    deciding_spans,
    most_topics,
    styles_of,
)

CORRIDOR = DecidingBlock(rule="Corridor", line=14)
HALL = DecidingBlock(rule="Hall", line=25)


def _reason(block: DecidingBlock | None) -> Reason:
    if block is None:
        return Reason.DEFAULT
    return Reason.UNKNOWN if block.is_in_doubt else Reason.BLOCK


def decided(t_s: float, topic: str, block: DecidingBlock | None) -> Decision:
    planned = PlannedRate(
        rate=Rate(1.0),
        reason=_reason(block),
        rule=block.rule if block else None,
        line=block.line if block else None,
    )
    return Decision(t_s=t_s, stamp_ns=0, topic=topic, from_rate=None, planned=planned, values={})


def test_the_block_that_decides_most_topics_decides() -> None:
    decisions = [decided(0.0, "/a", HALL), decided(0.0, "/b", CORRIDOR), decided(4.0, "/c", HALL)]
    assert deciding_spans(decisions, 10.0) == (
        RuleSpan(start_s=0.0, end_s=4.0, block=CORRIDOR),
        RuleSpan(start_s=4.0, end_s=10.0, block=HALL),
    )


def test_any_block_counts_before_the_defaults() -> None:
    decisions = [decided(0.0, "/a", None), decided(0.0, "/b", None), decided(3.0, "/b", HALL)]
    assert deciding_spans(decisions, 5.0) == (
        RuleSpan(start_s=0.0, end_s=3.0, block=None),
        RuleSpan(start_s=3.0, end_s=5.0, block=HALL),
    )


def test_a_block_in_doubt_is_another_one_and_comes_after_all_that_decided() -> None:
    doubt = DecidingBlock(rule="Docking", line=3, is_in_doubt=True)
    decisions = [decided(0.0, topic, doubt) for topic in ("/a", "/b")] + [decided(4.0, "/c", HALL)]
    spans = deciding_spans(decisions, 10.0)
    assert spans == (
        RuleSpan(start_s=0.0, end_s=4.0, block=doubt),
        RuleSpan(start_s=4.0, end_s=10.0, block=HALL),
    )
    styles = styles_of(decisions, 10.0)
    assert styles.of(doubt) == RuleStyle(css_class="by-doubt", name="Docking (in doubt)")
    assert [style.name for style in styles.all] == ["Hall", "Docking (in doubt)", "Defaults"]
    assert "Docking (in doubt)" in str(rule_legend(spans, styles))


def test_the_most_topics_of_a_block_are_counted() -> None:
    decisions = [decided(0.0, topic, None) for topic in "abcdefghijklm"]
    assert most_topics(decisions) == 0
    decisions += [decided(1.0, "a", HALL), decided(2.0, "a", None), decided(3.0, "b", HALL)]
    assert most_topics(decisions) == 1
    assert most_topics([*decisions, decided(4.0, "c", HALL)]) == 2


def test_a_run_without_decisions_has_no_spans_and_no_block() -> None:
    assert deciding_spans([], 5.0) == ()
    assert block_at((), 1.0) is None


times = st.integers(0, 20).map(float)
blocks = st.sampled_from([None, CORRIDOR, HALL, DecidingBlock(rule="Hall", line=40)])
histories = st.lists(st.builds(decided, times, st.sampled_from(["/a", "/b", "/c"]), blocks), max_size=12)


@given(histories)
def test_spans_agree_with_a_count_at_every_moment(decisions: list[Decision]) -> None:
    spans = deciding_spans(decisions, 20.0)
    ordered = sorted(decisions, key=lambda one: one.t_s)
    for tick in range(20):
        at_s = tick + 0.5
        latest = {one.topic: one for one in ordered if one.t_s <= at_s}
        counts = Counter(
            (one.planned.line, one.planned.rule) for one in latest.values() if one.planned.rule is not None
        )
        most = max(counts.values(), default=0)
        first = min((block for block, count in counts.items() if count == most), default=None)
        expected = None if first is None else DecidingBlock(rule=str(first[1]), line=first[0])
        assert block_at(spans, at_s) == expected


@given(histories)
def test_spans_leave_no_gap_and_no_two_neighbours_are_alike(decisions: list[Decision]) -> None:
    spans = deciding_spans(decisions, 20.0)
    for before, after in pairwise(spans):
        assert before.end_s == after.start_s
        assert before.block != after.block
    if spans:
        assert (spans[0].start_s, spans[-1].end_s) == (min(one.t_s for one in decisions), 20.0)
