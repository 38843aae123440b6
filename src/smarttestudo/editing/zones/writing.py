# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Blocks with another zone, as far as possible only with other numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal

from smarttestudo.domain.finding import Span
from smarttestudo.editing.edits import EditError
from smarttestudo.editing.zones.reading import Side, ZoneReading, ZoneRectangle, axis_of, zones_in
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
    checks_in,
)

_NOWHERE = Span(line=1, column=1, end_line=1, end_column=1)
_IN_BLOCK = "change the checks in the block"


def zone_condition(topic: str, rectangles: Sequence[ZoneRectangle]) -> Condition:
    """The condition that ``topic``'s position is in one of ``rectangles``.

    One rectangle has no border (``>`` and ``<``, as in the thesis). Of several each has its left and lower
    border, so that no gap is left where they meet.
    """
    lower = Operator.GREATER if len(rectangles) == 1 else Operator.GREATER_EQUAL
    parts = [_joined(And, tuple(_checks(topic, one, lower))) for one in rectangles]
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
    written = next(one.topic.text for one in checks_in(condition) if resolve(one.topic.text) == topic)
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
    grouped = (Group(operand=one, span=_NOWHERE) if isinstance(one, And | Or) else one for one in parts)
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
