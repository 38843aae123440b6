# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which bound is in force, against every way in which what is not known may turn out.

A topic without any bound passes everything, which is more than with any bound; two bounds pass more than one.
"""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace

from hypothesis import given, settings
from hypothesis import strategies as st

from loop.loop_driver import LoopDriver
from smarttestudo.domain.decision import BoundReason, PlannedRate, Reason
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate
from smarttestudo.loop.knowledge.knowledge import BoundHysteresis

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


@cache
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


def bounds_of(defaults: Bounds, way: Sequence[Branch]) -> Bounds:
    found = {name: decided(defaults, way, name) for name in PROPERTIES}
    return {name: bound for name, bound in found.items() if bound < math.inf}


def enough_for_all(ways: Sequence[Bounds]) -> Bounds:
    """The loosest bounds that let pass what each of ``ways`` does."""
    if {} in ways:
        return {}
    return {name: min(way[name] for way in ways if name in way) for way in ways for name in way}


@settings(max_examples=200)
@given(
    rules(),
    st.lists(st.tuples(st.sampled_from(CONDITIONS), st.sampled_from([-1.0, 1.0, NOT_KNOWN])), max_size=8),
)
def test_in_doubt_what_every_way_needs_passes_and_the_reason_says_where_doubt_decides(
    given_rules: Rules, told: list[tuple[str, float]]
) -> None:
    driver = LoopDriver(given_rules.text, AT_ONCE)
    values = dict.fromkeys(CONDITIONS, NOT_KNOWN)
    for number, (topic, value) in enumerate([("/odom", 0.0), *told]):
        driver.send(topic, number, message=SimpleNamespace(x=value))
        driver.wait_until(number)
        if topic in values:
            values[topic] = value
        possible = [bounds_of(given_rules.defaults, way) for way in ways(given_rules.branches, values)]
        planned, known = driver.loop.knowledge.plan["/odom"], possible[0]
        assert dict(planned.within) == enough_for_all(possible)
        in_doubt = {name for name, one in planned.bound_reasons.items() if one.reason is Reason.UNKNOWN}
        tightened = {name for way in possible for name in way if way[name] < known.get(name, math.inf)}
        assert in_doubt == tightened


some_requests = st.lists(
    st.tuples(st.integers(0, 4), st.dictionaries(st.sampled_from(PROPERTIES), bounds, max_size=2)),
    min_size=1,
    max_size=12,
)


@given(some_requests, st.integers(1, 5))
def test_what_was_requested_in_the_settling_time_passes(
    requested: list[tuple[int, Bounds]], settle_ns: int
) -> None:
    requests = [_planned({}), *(_planned(within) for _, within in requested)]
    settling, times_ns, now_ns = BoundHysteresis(requests[0], settle_ns), [0], 0
    for (gap_ns, _), request in zip(requested, requests[1:], strict=True):
        now_ns += gap_ns
        settling.on_request(request, now_ns)
        times_ns.append(now_ns)
        for at_ns in range(now_ns, now_ns + 2 * settle_ns):
            counting = [
                one.within
                for number, one in enumerate(requests[: len(times_ns)])
                if number == len(times_ns) - 1 or times_ns[number + 1] + settle_ns > at_ns
            ]
            copied = copy.deepcopy(settling)
            effective = copied.effective(request, at_ns)
            assert dict(effective.within) == enough_for_all([dict(one) for one in counting])
            alarm_ns = copied.next_change_ns
            assert alarm_ns is None or alarm_ns > at_ns
            if alarm_ns is None:
                assert effective.within == request.within


def _planned(within: Bounds) -> PlannedRate:
    reasons = dict.fromkeys(within, BoundReason(reason=Reason.DEFAULT))
    return PlannedRate(rate=Rate.full(), reason=Reason.DEFAULT, within=within, bound_reasons=reasons)
