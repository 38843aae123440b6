# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The thesis's models against a plain formulation of them in scipy, on 1000 random instances each."""

from __future__ import annotations

import math

import numpy as np
import pytest

from optimizer.instances import Instance, random_instances
from optimizer.naive import rates_of
from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.model import Model

THESIS_MODELS = (Model.QUPER, Model.BUDGET, Model.PRIORITY)


def columns(model: Model, instance: Instance) -> list[tuple[float, float, float, float]]:
    """Weight, size, lowest and highest rate of each topic, written out anew from DESIGN's formulas."""
    rows = []
    for one in instance[0]:
        entry, wanted = one.needs.entry, one.wanted
        assert isinstance(wanted, Tier)
        assert entry.tiers_hz is not None
        assert entry.message_kb is not None
        if model is Model.QUPER:
            tiers = [0.0, *entry.tiers_hz, entry.tiers_hz[5] + 10]
            low, high = tiers[wanted.level], tiers[wanted.level + 1]
            if wanted is Tier.EXCESSIVE:
                low, high = tiers[6], tiers[7]
        else:
            low, high = 0.0, entry.max_hz or 0.0
        low = max(low, entry.min_hz or 0.0)
        weight = entry.priority if model is Model.PRIORITY else 1.0
        rows.append((weight, entry.message_kb, low, max(low, high)))
    return rows


def objective_by_scipy(model: Model, instance: Instance) -> float | None:
    from scipy.optimize import linprog  # noqa: PLC0415  only full tests need it

    weights, sizes, lows, highs = (np.array(column) for column in zip(*columns(model, instance), strict=True))
    budget = instance[1]
    # scipy's own tolerance is 1e-7 absolute; a budget of 1 keeps that small in KB/s, too.
    scale = max(budget, 1.0)
    done = linprog(
        -weights, A_ub=[sizes / scale], b_ub=[budget / scale + 1e-12], bounds=np.column_stack([lows, highs])
    )
    return -done.fun if done.status == 0 else None


def our_objective(model: Model, instance: Instance) -> float | None:
    found = rates_of(model, instance[0], instance[1])
    if found is None:
        return None
    weights = [row[0] for row in columns(model, instance)]
    return math.fsum(
        weight * found.rates_hz[one.needs.topic] for weight, one in zip(weights, instance[0], strict=True)
    )


@pytest.mark.full
@pytest.mark.parametrize("model", THESIS_MODELS, ids=lambda model: model.value)
def test_the_objective_equals_scipy_s_on_1000_instances(model: Model) -> None:
    answered = 0
    for number, instance in enumerate(random_instances(model, 1000, seed=4)):
        ours, theirs = our_objective(model, instance), objective_by_scipy(model, instance)
        assert (ours is None) == (theirs is None), f"instance {number}"
        if ours is not None:
            answered += 1
            assert ours == pytest.approx(theirs, rel=1e-6, abs=1e-6), f"instance {number}"
    assert answered > 600
