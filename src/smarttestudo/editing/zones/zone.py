# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Zones: rectangles of a condition, and blocks with other ones, if possible only with other numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from enum import Enum
from itertools import product
from types import MappingProxyType

from smarttestudo.domain.finding import Span
from smarttestudo.editing.edits import EditError
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.syntax import (
    And,
    Block,
    Check,
    Condition,
    Group,
    Not,
    Operator,
    Or,
    Timed,
    TopicName,
)
from smarttestudo.language.syntax_walks import (
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
    {Operator.GREATER: True, Operator.GREATER_EQUAL: True, Operator.LESS: False, Operator.LESS_EQUAL: False}
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
    kept = tuple(zone for zone in zones.values() if not zone.rectangle.is_empty)
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
        if known is None or _is_tighter(side, _end(checks[number]), _end(checks[known])):
            sides[side] = number
    return [
        Zone(topic=topic, rectangle=_rectangle(sides, checks), checks=sides)
        for topic, sides in bounds.items()
    ]


def _side_of(check: Check, *, negated: bool) -> Side | None:
    """The side that a check bounds; none where it is about something else, or asks for one exact value."""
    is_from_below = _FROM_BELOW.get(check.operator)
    if is_from_below is None or check.until is not None or not isinstance(check.value, float):
        return None
    bound = (axis_of(check.property), is_from_below != negated)
    return next((side for side in Side if side.value == bound), None)


def _end(check: Check) -> float:
    """The number that a check of a side compares with."""
    return check.value if isinstance(check.value, float) else math.nan


def _is_tighter(side: Side, value: float, than: float) -> bool:
    return value > than if side.value[1] else value < than


def _rectangle(sides: Mapping[Side, int], checks: tuple[Check, ...]) -> ZoneRectangle:
    def end(side: Side) -> float | None:
        return _end(checks[sides[side]]) if side in sides else None

    return ZoneRectangle(
        min_x_m=end(Side.MIN_X), max_x_m=end(Side.MAX_X), min_y_m=end(Side.MIN_Y), max_y_m=end(Side.MAX_Y)
    )


_NOWHERE = Span(line=1, column=1, end_line=1, end_column=1)
_IN_BLOCK = "change the checks in the block"


def zone_condition(topic: str, rectangles: Sequence[ZoneRectangle]) -> Condition:
    """The condition that ``topic``'s position is in one of ``rectangles``.

    One rectangle has no border (``>`` and ``<``, as in the thesis). Of several each has its left and lower
    border, so that no gap is left where they meet.
    """
    lower = Operator.GREATER if len(rectangles) == 1 else Operator.GREATER_EQUAL
    parts = [_joined(And, tuple(_checks(topic, rectangle, lower))) for rectangle in rectangles]
    return _joined(Or, tuple(parts))


def with_zone(block: Block, zone: Condition, resolve: Resolve) -> Block:
    """``block`` in ``zone`` only, or, where it is nothing but zones already, there as well."""
    reading = zones_in(block.condition, resolve)
    if not reading.zones:
        return replace(block, condition=_joined(And, (*_operands(And, block.condition), zone)))
    if reading.others or reading.holds_elsewhere:
        raise EditError(
            f'"{block.label}" has a zone and other checks', remedy="move its zone, or make a rule of its own"
        )
    return replace(block, condition=_joined(Or, (*_operands(Or, block.condition), *_operands(Or, zone))))


def moved_zone(block: Block, topic: str, by_m: tuple[float, float], resolve: Resolve) -> Block:
    """``block`` with every check of ``topic``'s position moved by so many metres, in whole centimetres."""
    distances = {"pose_x": _centimetres(by_m[0]), "pose_y": _centimetres(by_m[1])}

    def moved(_: int, check: Check) -> Check:
        distance = distances.get(axis_of(check.property) or "")
        if not distance or resolve(check.topic.text) != topic:
            return check
        # Decimal digits stay as they are written: 5.4 and 0.1 make 5.5.
        return _with_value(check, float(Decimal(repr(check.value)) + distance))

    return replace(block, condition=_with_checks(block.condition, moved))


def resized_zone(block: Block, index: int, rectangle: ZoneRectangle, resolve: Resolve) -> Block:
    """``block`` with other sides for its zone number ``index``.

    A side that was open gets a check of its own. Raises ``EditError`` for a zone that is not there, an empty
    rectangle, a side to be opened, and where checks of the rule keep the zone from being that rectangle.
    """
    reading = zones_in(block.condition, resolve)
    if not 0 <= index < len(reading.zones):
        raise EditError(f"the rule has no zone {index + 1}", remedy="read the document again")
    if rectangle.is_empty:
        remedy = "give it a left side left of its right one, and a lower side below its upper one"
        raise EditError("this rectangle has no area", remedy=remedy)
    zone = reading.zones[index]
    wanted = _sides_of(rectangle)
    if any(wanted[side] is None for side in zone.checks):
        raise EditError("a side cannot be left out here", remedy="delete its check in the block")
    values = {number: wanted[side] for side, number in zone.checks.items()}

    def sized(number: int, check: Check) -> Check:
        value = values.get(number)
        return check if value is None or value == check.value else _with_value(check, value)

    condition = _with_checks(block.condition, sized)
    missing = {side: wanted[side] for side in Side if side not in zone.checks and wanted[side] is not None}
    if missing:
        condition = _closed(condition, missing, reading, resolve)
    done = replace(block, condition=condition)
    now = zones_in(done.condition, resolve).zones
    if index >= len(now) or now[index].rectangle != rectangle:
        raise EditError("another check of the rule bounds this zone too", remedy=_IN_BLOCK)
    return done


def _closed(
    condition: Condition, missing: Mapping[Side, float | None], reading: ZoneReading, resolve: Resolve
) -> Condition:
    """``condition`` with a check for each side that its only zone lacks."""
    topic = reading.zones[0].topic
    if len(reading.zones) > 1 or reading.holds_elsewhere:
        raise EditError("an open side of one of several zones cannot be closed here", remedy=_IN_BLOCK)
    written = next(check.topic.text for check in checks_in(condition) if resolve(check.topic.text) == topic)
    checks = [
        _check(written, side, Operator.GREATER, value) for side, value in missing.items() if value is not None
    ]
    return _joined(And, (*_operands(And, condition), *checks))


def _checks(topic: str, rectangle: ZoneRectangle, lower: Operator) -> Iterator[Check]:
    for side, value in _sides_of(rectangle).items():
        if value is not None:
            yield _check(topic, side, lower, value)


def _check(topic: str, side: Side, lower: Operator, value: float) -> Check:
    return Check(
        topic=TopicName(text=topic, span=_NOWHERE),
        property=side.property_name,
        property_span=_NOWHERE,
        operator=lower if side.value[1] else Operator.LESS,
        value=value,
        text="",
        span=_NOWHERE,
    )


def _sides_of(rectangle: ZoneRectangle) -> dict[Side, float | None]:
    return {
        Side.MIN_X: rectangle.min_x_m,
        Side.MAX_X: rectangle.max_x_m,
        Side.MIN_Y: rectangle.min_y_m,
        Side.MAX_Y: rectangle.max_y_m,
    }


def _joined(kind: type[And | Or], parts: tuple[Condition, ...]) -> Condition:
    if not parts:
        raise EditError("a zone without sides is everywhere", remedy="give it a side")
    if len(parts) == 1:
        return parts[0]
    grouped = (Group(operand=part, span=_NOWHERE) if isinstance(part, And | Or) else part for part in parts)
    return kind(operands=tuple(grouped), span=_NOWHERE)


def _operands(kind: type[And | Or], condition: Condition) -> tuple[Condition, ...]:
    """The parts of a condition of this kind, out of its parentheses; any other is one part."""
    inner = condition
    while isinstance(inner, Group):
        inner = inner.operand
    return inner.operands if isinstance(inner, kind) else (condition,)


def _with_checks(condition: Condition, change: Callable[[int, Check], Check]) -> Condition:
    """``condition`` with each check changed; ``change`` gets its number, too."""
    numbers = {id(check): number for number, check in enumerate(checks_in(condition))}

    def changed(part: Condition) -> Condition:
        match part:
            case Check():
                return change(numbers[id(part)], part)
            case Not() | Group() | Timed():
                return replace(part, operand=changed(part.operand))
            case And() | Or():
                return replace(part, operands=tuple(map(changed, part.operands)))

    return changed(condition)


def _with_value(check: Check, value: float) -> Check:
    """``check`` with another number; that of its Until stays as far from it."""
    until = check.until
    if until is not None:
        distance = Decimal(repr(value)) - Decimal(repr(check.value))
        until = replace(until, value=float(Decimal(repr(until.value)) + distance), text="")
    return replace(check, value=value, text="", until=until)


def _centimetres(metres: float) -> Decimal:
    return Decimal(repr(round(metres, 2)))
