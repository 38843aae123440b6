# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Random small rule files, and their meaning by looking at every state that can make a difference."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from functools import cache
from typing import cast

from hypothesis import strategies as st

from language.evaluator.naive_rules import naive_truth
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.signal import Signal, Value
from smarttestudo.language.resolved_rules import Branch
from smarttestudo.language.syntax import Condition, Operator

State = dict[Signal, float]

X = Signal("/odom", "pose_x")
AGE = Signal("/odom", "age")
LEVEL = Signal("/battery_state", "level")
LIMITS = {X: (-1e9, 1e9), AGE: (0.0, 1e9), LEVEL: (0.0, 100.0)}
THRESHOLDS = {X: ("0", "1", "2"), AGE: ("-1", "0", "3"), LEVEL: ("0", "50", "100", "120")}
VALUES = {
    signal: [
        value
        for value in (*map(float, numbers), *(float(one) + step for one in numbers for step in (-0.5, 0.5)))
        if LIMITS[signal][0] <= value <= LIMITS[signal][1]
    ]
    for signal, numbers in THRESHOLDS.items()
}


@cache
@st.composite
def checks(draw: st.DrawFn) -> str:
    signal = draw(st.sampled_from(list(THRESHOLDS)))
    comparison = draw(st.sampled_from(list(Operator)))
    return f"CheckValue {signal} {comparison.value} {draw(st.sampled_from(THRESHOLDS[signal]))}"


def _joined(parts: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    several = st.lists(parts, min_size=2, max_size=3)
    joined = st.tuples(several, st.sampled_from([" AND ", " OR "])).map(
        lambda pair: f"({pair[1].join(pair[0])})"
    )
    return joined | parts.map(lambda part: f"Not {part}")


conditions = st.recursive(checks(), _joined, max_leaves=4)


@cache
@st.composite
def settings_of(draw: st.DrawFn) -> str:
    topics = draw(st.lists(st.sampled_from(["/a", "/b"]), min_size=1, max_size=2, unique=True))
    return " ".join(
        f"SetFrequency {topic} {draw(st.sampled_from(['1', '2', 'Full', 'Off']))}" for topic in topics
    )


@cache
@st.composite
def blocks(draw: st.DrawFn) -> str:
    heading = draw(st.sampled_from(["", 'Rule "n" Priority 1 ']))
    otherwise = draw(st.none() | settings_of())
    text = f"{heading}If {draw(conditions)} Then {draw(settings_of())}"
    return f"{text} Else {otherwise} EndIf" if otherwise else f"{text} EndIf"


rule_files = st.lists(blocks(), min_size=1, max_size=4).map(lambda parts: "\n".join(["begin", *parts, "end"]))


def holds(condition: Condition, state: Mapping[Signal, float]) -> bool:
    return naive_truth(condition, state) is True


def applies(branch: Branch, state: Mapping[Signal, float]) -> bool:
    return holds(branch.block.block.condition, state) != branch.is_else


def all_states() -> Iterator[State]:
    """One state from each part of the space that the thresholds tell apart."""
    for values in itertools.product(*VALUES.values()):
        yield dict(zip(VALUES, values, strict=True))


def completions(part: Mapping[Signal, Value]) -> Iterator[State]:
    """``part`` with every combination of values for the other signals."""
    open_values = {signal: values for signal, values in VALUES.items() if signal not in part}
    for values in itertools.product(*open_values.values()):
        yield {**cast("State", part), **dict(zip(open_values, values, strict=True))}


def decider(model: RuleModel, topic: str, state: Mapping[Signal, float]) -> Branch | None:
    """The branch that decides ``topic``: the highest priority, then the highest rate, then the first."""
    setting = [branch for branch in model.branches if topic in branch.settings and applies(branch, state)]
    return max(
        setting,
        key=lambda branch: (branch.block.priority, branch.settings[topic].rate, -branch.order),
        default=None,
    )
