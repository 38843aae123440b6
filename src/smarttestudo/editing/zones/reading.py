# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Zones as conditions mean them: rectangles in the plane."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from itertools import product
from types import MappingProxyType

from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.syntax import (
    And,
    Check,
    Condition,
    Group,
    Not,
    Operator,
    Or,
    Timed,
    checks_in,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ZoneRectangle:
    """An upright rectangle in metres; ``None`` is a side that nothing bounds."""

    min_x_m: float | None
    max_x_m: float | None
    min_y_m: float | None
    max_y_m: float | None

    @property
    def is_empty(self) -> bool:
        """Whether no place lies in it."""
        low_x, high_x, low_y, high_y = self._ends()
        return low_x >= high_x or low_y >= high_y

    def common(self, other: ZoneRectangle) -> ZoneRectangle | None:
        """The part in both, ``None`` if there is none."""
        mine, theirs = self._ends(), other._ends()
        low_x, low_y = max(mine[0], theirs[0]), max(mine[2], theirs[2])
        high_x, high_y = min(mine[1], theirs[1]), min(mine[3], theirs[3])
        found = ZoneRectangle(
            min_x_m=_side(low_x), max_x_m=_side(high_x), min_y_m=_side(low_y), max_y_m=_side(high_y)
        )
        return None if found.is_empty else found

    def _ends(self) -> tuple[float, float, float, float]:
        return (
            -math.inf if self.min_x_m is None else self.min_x_m,
            math.inf if self.max_x_m is None else self.max_x_m,
            -math.inf if self.min_y_m is None else self.min_y_m,
            math.inf if self.max_y_m is None else self.max_y_m,
        )


def _side(end: float) -> float | None:
    return None if math.isinf(end) else end


MAX_ALTERNATIVES = 64


class Side(Enum):
    """A side of a rectangle: the property that bounds it, and whether from below."""

    MIN_X = ("pose_x", True)
    MAX_X = ("pose_x", False)
    MIN_Y = ("pose_y", True)
    MAX_Y = ("pose_y", False)

    @property
    def property_name(self) -> str:
        """``pose_x`` or ``pose_y``."""
        return self.value[0]


_FIELDS = MappingProxyType(
    {
        "pose.pose.position.x": "pose_x",
        "pose.pose.position.y": "pose_y",
        "pose.position.x": "pose_x",
        "pose.position.y": "pose_y",
    }
)


def axis_of(property_name: str) -> str | None:
    """``pose_x`` or ``pose_y``, also for the field of the message; ``None`` for others."""
    name = _FIELDS.get(property_name, property_name)
    return name if name in _FIELDS.values() else None


_FROM_BELOW = MappingProxyType(
    {
        Operator.GREATER: True,
        Operator.GREATER_EQUAL: True,
        Operator.LESS: False,
        Operator.LESS_EQUAL: False,
    }
)

_Literal = tuple[int, bool]
"""The number of a check in its condition, and whether it is negated."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Zone:
    """A rectangle of ``topic``'s positions; ``checks`` are the numbers of the checks that bound its sides.

    Numbers count the checks of the condition in the order of the text.
    """

    topic: str
    rectangle: ZoneRectangle
    checks: Mapping[Side, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class ZoneReading:
    """The zones of a condition, any of which may hold; ``others`` are the checks that bound none of them.

    ``holds_elsewhere`` is whether it can hold without any zone, ``is_too_mixed`` whether it was given up.
    """

    zones: tuple[Zone, ...] = ()
    others: tuple[Check, ...] = ()
    holds_elsewhere: bool = False
    is_too_mixed: bool = False


def zones_in(condition: Condition, resolve: Resolve) -> ZoneReading:
    """The zones of ``condition``; ``resolve`` gives the full name of a topic."""
    checks = tuple(checks_in(condition))
    numbers = {id(check): number for number, check in enumerate(checks)}
    alternatives = _alternatives(condition, numbers, negated=False)
    if alternatives is None:
        return ZoneReading(others=checks, holds_elsewhere=True, is_too_mixed=True)
    zones: dict[tuple[object, ...], Zone] = {}
    holds_elsewhere = False
    for alternative in alternatives:
        found = _zones_of(alternative, checks, resolve)
        holds_elsewhere = holds_elsewhere or not found
        zones.update(((one.topic, tuple(sorted(one.checks.values()))), one) for one in found)
    kept = tuple(one for one in zones.values() if not one.rectangle.is_empty)
    bounding = {number for zone in zones.values() for number in zone.checks.values()}
    return ZoneReading(
        zones=kept,
        others=tuple(
            check
            for number, check in enumerate(checks)
            if number not in bounding and _side_of(check, negated=False) is None
        ),
        holds_elsewhere=holds_elsewhere,
    )


def _alternatives(
    condition: Condition, numbers: Mapping[int, int], *, negated: bool
) -> list[tuple[_Literal, ...]] | None:
    """The condition as an OR of ANDs of checks; ``None`` where that has too many parts."""
    match condition:
        case Check():
            return [((numbers[id(condition)], negated),)]
        case Group() | Timed():
            return _alternatives(condition.operand, numbers, negated=negated)
        case Not():
            return _alternatives(condition.operand, numbers, negated=not negated)
        case And() | Or():
            parts = [_alternatives(part, numbers, negated=negated) for part in condition.operands]
            known = [part for part in parts if part is not None]
            if len(known) < len(parts):
                return None
            is_and = isinstance(condition, And) != negated
            return _crossed(known) if is_and else _bounded([one for part in known for one in part])


def _crossed(parts: Iterable[list[tuple[_Literal, ...]]]) -> list[tuple[_Literal, ...]] | None:
    crossed: list[tuple[_Literal, ...]] | None = [()]
    for part in parts:
        if crossed is None or len(crossed) * len(part) > MAX_ALTERNATIVES:
            return None
        crossed = [(*one, *other) for one, other in product(crossed, part)]
    return crossed


def _bounded(alternatives: list[tuple[_Literal, ...]]) -> list[tuple[_Literal, ...]] | None:
    return alternatives if len(alternatives) <= MAX_ALTERNATIVES else None


def _zones_of(alternative: Iterable[_Literal], checks: tuple[Check, ...], resolve: Resolve) -> list[Zone]:
    """The rectangle of each topic whose position the checks of one AND bound."""
    bounds: dict[str, dict[Side, int]] = {}
    for number, negated in alternative:
        side = _side_of(checks[number], negated=negated)
        if side is None:
            continue
        sides = bounds.setdefault(resolve(checks[number].topic.text), {})
        known = sides.get(side)
        if known is None or _is_tighter(side, checks[number].value, checks[known].value):
            sides[side] = number
    return [
        Zone(topic=topic, rectangle=_rectangle(sides, checks), checks=sides)
        for topic, sides in bounds.items()
    ]


def _side_of(check: Check, *, negated: bool) -> Side | None:
    """The side that a check bounds; none where it is about something else, or asks for one exact value."""
    is_from_below = _FROM_BELOW.get(check.operator)
    if is_from_below is None or check.until is not None:
        return None
    bound = (axis_of(check.property), is_from_below != negated)
    return next((side for side in Side if side.value == bound), None)


def _is_tighter(side: Side, value: float, than: float) -> bool:
    return value > than if side.value[1] else value < than


def _rectangle(sides: Mapping[Side, int], checks: tuple[Check, ...]) -> ZoneRectangle:
    def end(side: Side) -> float | None:
        return checks[sides[side]].value if side in sides else None

    return ZoneRectangle(
        min_x_m=end(Side.MIN_X), max_x_m=end(Side.MAX_X), min_y_m=end(Side.MIN_Y), max_y_m=end(Side.MAX_Y)
    )
