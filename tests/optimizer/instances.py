# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Random problems for the optimizer, degenerate ones included."""

from __future__ import annotations

import random
from collections.abc import Iterator
from functools import cache

from hypothesis import strategies as st

from smarttestudo.domain.profile import AccuracyTiers, TopicProfile
from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.model import Model, Requirement, TopicNeeds
from smarttestudo.optimizer.problem import Demand, Piece, used_kb_per_s

Instance = tuple[list[Requirement], float]


def requirement(topic: str, entry: TopicProfile, wanted: Tier | float) -> Requirement:
    needs = TopicNeeds(topic=topic, entry=entry, floor_hz=entry.min_hz or 0.0, profile_path="profile.toml")
    return Requirement(needs=needs, wanted=wanted)


def least_and_most(requirements: list[Requirement], model: Model) -> tuple[float, float]:
    """What all asks take at their lowest and at their highest rates, in KB/s."""
    bounds = [(one.needs.size_kb, one.bounds_hz(model)) for one in requirements]
    return used_kb_per_s((kb, low) for kb, (low, _) in bounds), used_kb_per_s(
        (kb, hi) for kb, (_, hi) in bounds
    )


def random_instances(model: Model, count: int, *, seed: int) -> Iterator[Instance]:
    """Of ten, one has equal tiers, two a budget met exactly, one none, one a single topic; a few have 500."""
    generator = random.Random(seed)
    for number in range(count):
        topics = 500 if number % 200 == 199 else 1 if number % 10 == 3 else generator.randint(1, 30)
        requirements = [
            _random_requirement(generator, f"/t{index}", equal=number % 10 == 0) for index in range(topics)
        ]
        least, most = least_and_most(requirements, model)
        budget = least + generator.uniform(-0.1, 1.2) * (most - least)
        exact = {1: least, 2: most, 4: 0.0}
        yield requirements, max(0.0, exact.get(number % 10, budget))


def _random_requirement(generator: random.Random, topic: str, *, equal: bool) -> Requirement:
    tiers = sorted(round(generator.uniform(0, 100), generator.choice((0, 1, 3))) for _ in Tier)
    entry = TopicProfile(
        message_kb=generator.choice((0.052, 0.1, 0.72, 3.0, 420.0, round(generator.uniform(0.001, 7000), 3))),
        tiers_hz=tuple(tiers[:1] * len(tiers) if equal else tiers),
        priority=generator.choice((0.5, 1.0, 1.0, 2.0, 10.0)),
        min_hz=generator.choice((None, None, 0.1, 1.0)),
        max_hz=generator.choice((5.0, 25.5, 200.0)),
    )
    return requirement(topic, entry, generator.choice(list(Tier)))


sizes_kb = st.sampled_from([0.052, 0.1, 0.3, 0.72, 1.0, 420.0, 6220.0]) | st.floats(0.001, 1e4)
widths_hz = st.sampled_from([0.0, 0.1, 1.0, 5.0]) | st.floats(0, 100)
gains = st.sampled_from([0.0, 0.5, 1.0]) | st.floats(0, 10)


@cache
@st.composite
def demands(draw: st.DrawFn) -> list[Demand]:
    """A few demands with concave worths."""
    return [
        Demand(
            topic=f"/t{index}",
            size_kb=draw(sizes_kb),
            least_hz=draw(widths_hz),
            pieces=tuple(
                Piece(draw(widths_hz), gain)
                for gain in sorted(draw(st.lists(gains, max_size=3)), reverse=True)
            ),
        )
        for index in range(draw(st.integers(0, 6)))
    ]


@cache
@st.composite
def accuracy_tiers(draw: st.DrawFn, *, distinct: bool = False) -> AccuracyTiers:
    """Six accuracies with measured needs; equal needs are common, and equal bounds unless ``distinct``."""
    # Bounds that differ by float noise only are one when they are rounded to be read.
    some = st.sampled_from([0.01, 0.1, 1.0]) | st.floats(1e-3, 10).map(lambda one: float(f"{one:.9g}"))
    bounds = draw(st.lists(some, min_size=6, max_size=6, unique=distinct))
    needs_hz = draw(st.lists(st.sampled_from([0.5, 1.0, 25.0]) | st.floats(0.1, 200), min_size=6, max_size=6))
    return AccuracyTiers(bounds=tuple(sorted(bounds, reverse=True)), needs_hz=tuple(sorted(needs_hz)))


@cache
@st.composite
def entries(draw: st.DrawFn) -> TopicProfile:
    """A topic's profile with all that any model reads."""
    tiers = sorted(
        draw(st.lists(st.sampled_from([0.0, 1.0, 2.5, 10.0]) | st.floats(0.001, 200), min_size=6, max_size=6))
    )
    source_hz = draw(st.floats(0.1, 300))
    return TopicProfile(
        message_kb=draw(sizes_kb),
        source_hz=source_hz,
        tiers_hz=tuple(tiers),
        priority=draw(st.sampled_from([0.5, 1.0, 3.0])),
        min_hz=draw(st.sampled_from([None, 0.5, 1.0])),
    )


@cache
@st.composite
def instances(draw: st.DrawFn, model: Model, *, has_solution: bool = False) -> Instance:
    """A few asks, at least one for a level, and a budget around what they can take.

    With ``has_solution``, the budget takes all of them at their lowest rates.
    """
    tiers = st.sampled_from(list(Tier))
    wanted = [draw(tiers), *draw(st.lists(tiers | st.sampled_from([0.0, 0.3, 10.0]), max_size=5))]
    requirements = [requirement(f"/t{index}", draw(entries()), one) for index, one in enumerate(wanted)]
    least, most = least_and_most(requirements, model)
    share = draw(st.sampled_from([0.0, 0.5, 1.0]) | st.floats(0.0 if has_solution else -0.2, 1.2))
    return requirements, max(0.0, least + share * (most - least))
