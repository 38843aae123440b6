# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The step agrees with a naive loop that recomputes everything from the full history."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from language.evaluator.naive_rules import TYPES, NaiveRequest
from language.evaluator.random_rules import rule_files
from loop.naive_loop import SECOND, NaiveDecision, NaiveLoop
from smarttestudo.domain.decision import Decision, PlannedRate
from smarttestudo.domain.observation import (
    Arrival,
    Observation,
    SourceChanged,
    Undecodable,
    VitalsMeasured,
)
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.language.rule_set import compile_rules
from smarttestudo.language.syntax import Constant, RuleFile
from smarttestudo.loop import Knowledge, step

START = 1_795_230_365_474_043_001
SOURCES = ("/p", "/q")
VITALS = ("@machine", "@link")
SIGNALS = (
    *(Signal(topic, name) for topic in SOURCES for name in ("x", "y", "rate", "bandwidth", "age")),
    *(Signal(source, name) for source in VITALS for name in ("cpu", "age")),
)
BORDERS = (-1.0, 0.0, 0.3, 0.5, 1.0, 1.5, 2.0, 2.7)

WORDS = (
    "dock",
    "drive",
    True,
    False,
    *(Constant(type_name="", name=name) for name in ("ONE", "DOCK", "LOST")),
)
WORD_SIGNALS = tuple(
    Signal(topic, name)
    for topic, names in (
        *((topic, ("x", "xs[*].x", 'xs["b"].x', "rate", "age")) for topic in SOURCES),
        ("@link", ("age",)),
    )
    for name in names
)

numbers = st.sampled_from([math.nan, -1.0, 0.0, 0.4, 1.0, 1.75, 3.0])
messages = st.one_of(
    st.builds(SimpleNamespace, x=numbers, y=numbers),
    st.builds(SimpleNamespace, x=numbers),
    st.sampled_from([Undecodable(), None]),
)
words = st.one_of(numbers, st.sampled_from(["dock", "drive", "other", ""]), st.booleans())
elements = st.builds(SimpleNamespace, name=st.sampled_from(["a", "b", "c"]), x=words)
word_messages = st.one_of(
    st.builds(SimpleNamespace, x=words, xs=st.lists(elements, max_size=3)),
    st.builds(SimpleNamespace, x=words),
    st.sampled_from([Undecodable(), None]),
)


def observations_of(messages: st.SearchStrategy[object]) -> st.SearchStrategy[Observation]:
    return st.one_of(
        st.builds(
            Arrival, topic=st.sampled_from(SOURCES), size_bytes=st.sampled_from([600, 1000]), message=messages
        ),
        st.builds(
            SourceChanged,
            topic=st.sampled_from(SOURCES),
            publishers=st.sampled_from([0, 1, 2]),
            transient_local=st.booleans(),
        ),
        st.builds(
            VitalsMeasured,
            source=st.sampled_from(VITALS),
            values=st.dictionaries(
                st.sampled_from(["cpu", "age"]), st.sampled_from([None, -1.0, 0.0, 0.4, 1.0, 1.75, 3.0])
            ),
        ),
    )


gaps_ns = st.one_of(
    st.sampled_from(
        [
            0,
            1,
            40_000_000,
            499_999_999,
            500_000_000,
            2 * SECOND,
            2 * SECOND + 1,
            5 * SECOND,
            11 * SECOND,
            -SECOND,
        ]
    ),
    st.integers(0, SECOND),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Moment:
    """After ``gap_ns``, which may be negative, something is seen; wakes on the way happen or are missed."""

    gap_ns: int
    seen: list[Observation]
    wakes: bool
    probe: float


def moments(messages: st.SearchStrategy[object]) -> st.SearchStrategy[list[Moment]]:
    moment = st.builds(
        Moment,
        gap_ns=gaps_ns,
        seen=st.lists(observations_of(messages), max_size=3),
        wakes=st.booleans(),
        probe=st.floats(0, 1),
    )
    return st.lists(moment, min_size=1, max_size=14)


def naive(planned: PlannedRate, place: int | None) -> NaiveRequest:
    return NaiveRequest(
        hz=planned.rate.hz,
        off=planned.rate == Rate.off(),
        reason=planned.reason.value,
        rule=planned.rule,
        place=place,
    )


class BothLoops:
    """The loop and the naive one, stepped side by side and compared after each step."""

    def __init__(self, files: list[RuleFile], profile: Profile) -> None:
        rule_set = compile_rules(files, lambda name: name, types=TYPES)
        self.knowledge = Knowledge(rule_set, profile, START)
        self.second = NaiveLoop(
            files=files,
            topics=rule_set.relayed,
            settle_ns=round(profile.settle_s * SECOND),
            stale_after_ns={
                name: round(topic.stale_after_s * SECOND)
                for name, topic in profile.topics.items()
                if topic.stale_after_s is not None
            },
        )
        self.clock_ns = START
        self.elapsed_ns = 0
        self.effective: dict[str, NaiveRequest] = {}
        self.decisions: list[Decision] = []

    def step(self, seen: list[Observation], gap_ns: int) -> None:
        self.clock_ns += gap_ns
        self.elapsed_ns += max(gap_ns, 0)
        result = step(self.knowledge, seen, self.clock_ns)
        expected = self.second.step(seen, self.elapsed_ns)
        places = {topic: request.block for topic, request in self.knowledge.effective.items()}
        assert [self.as_naive(one, places) for one in result.decisions] == expected
        self.decisions += result.decisions
        assert all(one.stamp_ns == self.clock_ns for one in result.decisions)
        self.effective = {topic: naive(planned, places[topic]) for topic, planned in result.plan.items()}
        assert self.effective == self.second.effective
        assert result.next_wake_ns is None or result.next_wake_ns > self.clock_ns

    def as_naive(self, decision: Decision, places: Mapping[str, int | None]) -> NaiveDecision:
        before = self.effective.get(decision.topic)
        assert decision.from_rate == (None if before is None else Rate(before.hz, not before.off))
        return NaiveDecision(
            t_ns=round(decision.t_s * SECOND),
            topic=decision.topic,
            before=before,
            after=naive(decision.planned, places[decision.topic]),
            values=dict(decision.values),
        )

    def wait(self, gap_ns: int, probe: float) -> int:
        """Step whenever the loop asks for it within ``gap_ns``; returns what is left of the gap."""
        while (wake_ns := self.knowledge.next_wake_ns) is not None and wake_ns <= self.clock_ns + gap_ns:
            gap_ns -= wake_ns - self.clock_ns
            self.wake_early(wake_ns - self.clock_ns, probe)
            self.step([], wake_ns - self.clock_ns)
        self.wake_early(gap_ns, 0)
        return gap_ns

    def wake_early(self, gap_ns: int, probe: float) -> None:
        """Before the loop asks to be woken nothing changes by itself, and a step finds nothing to do."""
        if gap_ns > 1:
            assert self.second.peek(self.elapsed_ns + gap_ns - 1) == self.effective
            decisions = len(self.decisions)
            self.step([], int((gap_ns - 1) * probe))
            assert len(self.decisions) == decisions


profiles = st.builds(
    lambda settle_s, stale_after_s: Profile(
        settle_s=settle_s, topics={"/q": TopicProfile(stale_after_s=stale_after_s)}
    ),
    st.sampled_from([0.0, 0.5]),
    st.sampled_from([None, 0.7]),
)


@settings(max_examples=200)
@given(rule_files(SIGNALS, BORDERS, max_blocks=5), profiles, moments(messages))
def test_plans_and_decisions_agree_with_a_naive_loop(
    files: list[RuleFile], profile: Profile, scenario: list[Moment]
) -> None:
    step_both(files, profile, scenario)


@pytest.mark.full
@settings(max_examples=2000)
@given(rule_files(WORD_SIGNALS, BORDERS, max_blocks=5, words=WORDS), profiles, moments(word_messages))
def test_plans_of_texts_states_and_elements_agree_with_a_naive_loop(
    files: list[RuleFile], profile: Profile, scenario: list[Moment]
) -> None:
    step_both(files, profile, scenario)


def step_both(files: list[RuleFile], profile: Profile, scenario: list[Moment]) -> None:
    both = BothLoops(files, profile)
    both.step([], 0)
    for moment in scenario:
        gap_ns = moment.gap_ns
        if moment.wakes and gap_ns > 0:
            gap_ns = both.wait(gap_ns, moment.probe)
        both.step(moment.seen, gap_ns)
    both.wait(6 * SECOND, 0.5)
