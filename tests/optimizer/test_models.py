# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Laws that hold for every model, and what each model means."""

from __future__ import annotations

import itertools
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimizer.instances import Instance, instances, requirement
from optimizer.naive import gain
from optimizer.naive import rates_of as solved
from smarttestudo.domain.profile import TopicProfile
from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.model import Model
from smarttestudo.optimizer.problem import (
    fits,
    quality_points,
    round_down,
    skipped_thresholds,
    tier_of,
    upper_envelope,
    used_kb_per_s,
)
from smarttestudo.optimizer.rule_rates import Ladder, rounded_down

models_and_instances = st.sampled_from(list(Model)).flatmap(lambda m: st.tuples(st.just(m), instances(m)))
models_and_solvable_instances = st.sampled_from(list(Model)).flatmap(
    lambda m: st.tuples(st.just(m), instances(m, has_solution=True))
)


@given(drawn=models_and_instances)
@settings(max_examples=300)
def test_no_floor_is_broken_and_the_budget_is_never_exceeded(drawn: tuple[Model, Instance]) -> None:
    model, (requirements, budget) = drawn
    found = solved(model, requirements, budget)
    least = {one.needs.topic: one.bounds_hz(model)[0] for one in requirements}
    if found is None:
        assert used_kb_per_s((one.needs.size_kb, least[one.needs.topic]) for one in requirements) > budget
        return
    rates = rounded_down(found.rates_hz, least)
    assert fits(used_kb_per_s((one.needs.size_kb, rates[one.needs.topic]) for one in requirements), budget)
    for one in requirements:
        low, high = one.bounds_hz(model)
        assert low <= rates[one.needs.topic] <= high + 1e-9
        if isinstance(one.wanted, Tier):
            assert rates[one.needs.topic] >= one.needs.floor_hz


@given(drawn=models_and_solvable_instances, more=st.floats(0, 1e5))
@settings(max_examples=200)
def test_a_larger_budget_never_lowers_the_objective(drawn: tuple[Model, Instance], more: float) -> None:
    model, (requirements, budget) = drawn
    found, richer = solved(model, requirements, budget), solved(model, requirements, budget + more)
    assert found is not None
    assert richer is not None
    if model is Model.MAXMIN:
        assert all(richer.rates_hz[topic] >= hz - 1e-9 for topic, hz in found.rates_hz.items())
        return
    demands = [one.demand(model, *one.bounds_hz(model)) for one in requirements]
    gained = gain(demands, found.rates_hz)
    assert gain(demands, richer.rates_hz) >= gained - 1e-9 * max(1.0, gained)


@given(drawn=models_and_solvable_instances, random=st.randoms(use_true_random=False))
@settings(max_examples=200)
def test_the_order_of_topics_does_not_matter(drawn: tuple[Model, Instance], random: Random) -> None:
    model, (requirements, budget) = drawn
    shuffled = list(requirements)
    random.shuffle(shuffled)
    found, again = solved(model, requirements, budget), solved(model, shuffled, budget)
    assert found is not None
    assert again is not None
    assert found.rates_hz == dict(again.rates_hz)


@given(instance=instances(Model.MAXMIN, has_solution=True))
@settings(max_examples=200)
def test_maxmin_raises_nobody_at_the_cost_of_someone_worse_off(instance: Instance) -> None:
    requirements, budget = instance
    found = solved(Model.MAXMIN, requirements, budget)
    assert found is not None
    ladders = []
    for one in requirements:
        if isinstance(one.wanted, Tier):
            low, high = one.bounds_hz(Model.MAXMIN)
            ladder = Ladder(topic="", size_kb=1, least_hz=low, most_hz=high, tiers_hz=one.needs.tiers_hz)
            ladders.append((found.rates_hz[one.needs.topic], ladder))
    below = [ladder.quality(rate) for rate, ladder in ladders if rate != pytest.approx(ladder.most_hz)]
    worst = min(below, default=5.0)
    for rate, ladder in ladders:
        assert rate == pytest.approx(ladder.least_hz) or rate <= ladder.rate_hz(worst) + 1e-6
    used = used_kb_per_s((one.needs.size_kb, found.rates_hz[one.needs.topic]) for one in requirements)
    assert worst >= 5 - 1e-9 or used == pytest.approx(budget, rel=1e-6, abs=1e-6)


@given(tiers=st.lists(st.floats(0, 300), min_size=6, max_size=6).map(sorted))
def test_the_envelope_is_concave_and_above_every_threshold(tiers: list[float]) -> None:
    corners = upper_envelope(quality_points(tiers))
    slopes = [
        (high - low) / (end - start)
        for (start, low), (end, high) in itertools.pairwise(corners)
        if end - start > 1e-6
    ]
    assert slopes == sorted(slopes, reverse=True) or slopes == pytest.approx(sorted(slopes, reverse=True))
    assert corners[-1] == (tiers[4], 5.0)


def test_the_envelope_skips_thresholds_below_the_line_between_their_neighbours() -> None:
    assert skipped_thresholds((10, 15, 20, 25, 30, 35)) == [0, 1, 2, 3]
    assert skipped_thresholds((2, 4, 6, 8, 10, 15)) == []


ODOM = TopicProfile(message_kb=1.0, source_hz=25.5, tiers_hz=(10, 15, 20, 25, 30, 35), min_hz=12.0)


@pytest.mark.parametrize(
    ("model", "tier", "bounds"),
    [
        (Model.QUPER, Tier.UNACCEPTABLE, (12, 12)),
        (Model.QUPER, Tier.MARGINAL, (12, 15)),
        (Model.QUPER, Tier.COMPETITIVE, (25, 30)),
        (Model.QUPER, Tier.EXCESSIVE, (35, 45)),
        (Model.BUDGET, Tier.COMPETITIVE, (12, 25.5)),
        (Model.PRIORITY, Tier.UNACCEPTABLE, (12, 25.5)),
        (Model.BENEFIT, Tier.DESIRABLE, (20, 25)),
        (Model.BENEFIT, Tier.COMPETITIVE, (25, 25.5)),
        (Model.BENEFIT, Tier.EXCESSIVE, (25.5, 25.5)),
        (Model.MAXMIN, Tier.MARGINAL, (12, 15)),
    ],
)
def test_each_model_keeps_its_own_bounds_and_the_floor(
    model: Model, tier: Tier, bounds: tuple[float, float]
) -> None:
    assert requirement("/odom", ODOM, tier).bounds_hz(model) == bounds


def test_a_tiny_topic_does_not_buy_out_useful_images_under_benefit() -> None:
    imu = TopicProfile(message_kb=0.3, source_hz=200, tiers_hz=(50, 75, 100, 150, 200, 250))
    image = TopicProfile(message_kb=1.0, source_hz=30, tiers_hz=(2, 4, 6, 8, 10, 15))
    requirements = [requirement("/imu", imu, Tier.MARGINAL), requirement("/image", image, Tier.MARGINAL)]
    by_hertz, by_benefit = solved(Model.QUPER, requirements, 19.0), solved(Model.BENEFIT, requirements, 19.0)
    assert by_hertz is not None
    assert by_benefit is not None
    assert by_hertz.rates_hz == pytest.approx({"/imu": 56.6666667, "/image": 2})
    assert by_benefit.rates_hz == pytest.approx({"/imu": 50, "/image": 4})


@pytest.mark.parametrize(
    ("rate_hz", "tier"),
    [(0, Tier.UNACCEPTABLE), (10, Tier.UNACCEPTABLE), (10.5, Tier.MARGINAL), (25.5, Tier.COMPETITIVE),
     (32, Tier.COMPETITIVE), (35, Tier.EXCESSIVE), (400, Tier.EXCESSIVE)],
)  # fmt: skip
def test_a_rate_has_the_level_whose_interval_holds_it(rate_hz: float, tier: Tier) -> None:
    assert tier_of(rate_hz, (10, 15, 20, 25, 30, 35)) is tier


@pytest.mark.parametrize(
    ("rate_hz", "rounded"), [(1.2349, 1.234), (0.3 / 0.1, 3.0), (2.9999999999999996, 3.0), (0.0009, 0.0)]
)
def test_rates_are_rounded_down_to_a_thousandth_but_not_by_float_noise(
    rate_hz: float, rounded: float
) -> None:
    assert round_down(rate_hz) == rounded
