# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which bound is in force, against every way in which what is not known may turn out."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from types import SimpleNamespace

from hypothesis import given
from hypothesis import strategies as st

from runtime.loop_driver import LoopDriver
from smarttestudo.domain.profile import Profile

PROPERTIES = ("position", "orientation")
CONDITIONS = ("/p", "/q", "/r")
"""Each block looks at one of these topics: it holds where the topic's ``x`` is positive."""
NOT_KNOWN = math.nan
AT_ONCE = Profile(settle_s=0.0)

Bounds = dict[str, float]


@dataclass(frozen=True)
class Branch:
    """What a block says where its condition is ``holds``."""

    topic: str
    holds: bool
    priority: int
    bounds: Bounds


@dataclass(frozen=True)
class Rules:
    """Rules as text, and as what they mean."""

    text: str
    defaults: Bounds
    branches: Sequence[Branch]


bounds = st.sampled_from([0.0, 0.1, 0.5, 0.5, 2.0])
some_bounds = st.dictionaries(st.sampled_from(PROPERTIES), bounds, max_size=2)
at_least_one = st.dictionaries(st.sampled_from(PROPERTIES), bounds, min_size=1, max_size=2)


def spoken(within: Bounds) -> str:
    return " ".join(f"KeepWithin /odom {name} {bound}" for name, bound in within.items())


@st.composite
def rules(draw: st.DrawFn) -> Rules:
    defaults = draw(some_bounds)
    text, branches = [f"begin SetFrequency /odom Full {spoken(defaults)}"], []
    for number in range(draw(st.integers(1, 5))):
        topic, priority = draw(st.sampled_from(CONDITIONS)), draw(st.sampled_from([0, 0, 1]))
        then, otherwise = draw(at_least_one), draw(some_bounds)
        text.append(f'Rule "{number}" Priority {priority} If CheckValue {topic} x > 0 Then {spoken(then)}')
        text.append(f"Else {spoken(otherwise)} EndIf" if otherwise else "EndIf")
        branches += [Branch(topic, True, priority, then), Branch(topic, False, priority, otherwise)]
    return Rules(" ".join([*text, "end"]), defaults, branches)


def ways(branches: Sequence[Branch], values: dict[str, float]) -> Iterator[list[Branch]]:
    """The branches that apply, in every way in which those that are not known may do so."""
    known = [one for one in branches if (values[one.topic] > 0) is one.holds and not unknown(one, values)]
    open_ones = [one for one in branches if unknown(one, values)]
    for applies in itertools.product((False, True), repeat=len(open_ones)):
        yield [*known, *itertools.compress(open_ones, applies)]


def unknown(branch: Branch, values: dict[str, float]) -> bool:
    return math.isnan(values[branch.topic])


def decided(defaults: Bounds, branches: Sequence[Branch], name: str) -> float:
    """The tightest of the highest priority; without a branch the default, without one nothing."""
    named = [one for one in branches if name in one.bounds]
    if not named:
        return defaults.get(name, math.inf)
    highest = max(one.priority for one in named)
    return min(one.bounds[name] for one in named if one.priority == highest)


@given(
    rules(),
    st.lists(st.tuples(st.sampled_from(CONDITIONS), st.sampled_from([-1.0, 1.0, NOT_KNOWN])), max_size=8),
)
def test_the_tightest_of_the_highest_priority_is_in_force_and_in_doubt_the_tightest(
    given_rules: Rules, told: list[tuple[str, float]]
) -> None:
    driver = LoopDriver(given_rules.text, AT_ONCE)
    values = dict.fromkeys(CONDITIONS, NOT_KNOWN)
    for number, (topic, value) in enumerate([("/odom", 0.0), *told]):
        driver.send(topic, number, message=SimpleNamespace(x=value))
        driver.wait_until(number)
        if topic in values:
            values[topic] = value
        possible = list(ways(given_rules.branches, values))
        expected = {
            name: min(decided(given_rules.defaults, way, name) for way in possible) for name in PROPERTIES
        }
        within = driver.loop.knowledge.plan["/odom"].within
        assert {name: within.get(name, math.inf) for name in PROPERTIES} == expected
