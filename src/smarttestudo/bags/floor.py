# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where on the floor a robot was, and the zones of its rules."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from smarttestudo.domain.floor_plan import FloorZone, Rectangle
from smarttestudo.language.normal_form import Every, Form, InRegion, Some, merged, over_states
from smarttestudo.language.region import Region
from smarttestudo.language.rule_set import RuleSet


@dataclass(frozen=True, slots=True, kw_only=True)
class PathPoint:
    """Where the robot was, ``t_s`` seconds after the run's start."""

    t_s: float
    x_m: float
    y_m: float


_X = ("pose_x", "pose.pose.position.x", "pose.position.x")
_Y = ("pose_y", "pose.pose.position.y", "pose.position.y")
_ANYWHERE = (-math.inf, math.inf)


def rule_zones(rule_set: RuleSet) -> tuple[FloorZone, ...]:
    """A zone for each stretch of floor that a block's condition bounds by the x and y of a robot's place.

    A condition may ask for more than the place: its zone is where it can hold. Of an OR, the parts that
    bound both x and y have a zone each. What says the place in another way has none.
    """
    return tuple(
        FloorZone(name=block.label, area=area)
        for block in rule_set.blocks
        for area in _areas(merged(over_states(block.form)))
    )


def _areas(form: Form) -> Iterator[Rectangle]:
    is_choice = isinstance(form, Some)
    for part in form.parts if isinstance(form, Some) else (form,):
        x, y = _bounds(part, _X), _bounds(part, _Y)
        is_bound = x and y if is_choice else x or y
        if is_bound:
            (min_x_m, max_x_m), (min_y_m, max_y_m) = x or _ANYWHERE, y or _ANYWHERE
            yield Rectangle(min_x_m=min_x_m, max_x_m=max_x_m, min_y_m=min_y_m, max_y_m=max_y_m)


def _bounds(form: Form, names: Sequence[str]) -> tuple[float, float] | None:
    """From where to where ``form`` lets the properties of ``names`` be; ``None`` where it says no stretch."""
    parts = form.parts if isinstance(form, Every) else (form,)
    regions = [part.region for part in parts if isinstance(part, InRegion) and part.signal.property in names]
    common = Region.intersection_of(regions)
    if not regions or len(common.pieces) != 1:
        return None
    ((low, high),) = common.pieces
    return low[0], high[0]
