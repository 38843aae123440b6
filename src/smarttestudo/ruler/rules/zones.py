# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The zones of a rule file, where they clash, and the edits that a map makes. Lengths are metres."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from msgspec import Struct

from smarttestudo.checks.blocks import blocks_clash
from smarttestudo.domain.finding import Span
from smarttestudo.domain.names import resolve_topic
from smarttestudo.editing import (
    CollectionPart,
    Document,
    EditError,
    NewStatement,
    inserted,
    replaced,
)
from smarttestudo.editing.zones import (
    PolygonError,
    Zone,
    ZoneReading,
    ZoneRectangle,
    covering_rectangles,
    moved_zone,
    resized_zone,
    with_zone,
    zone_condition,
    zones_in,
)
from smarttestudo.editing.zones.cover import MAX_RECTANGLES
from smarttestudo.language.formatter import check_text
from smarttestudo.language.syntax import (
    Block,
    RateExpression,
    RateWord,
    SetFrequency,
    TopicName,
)
from smarttestudo.language.syntax_walks import (
    sets_in,
)
from smarttestudo.ruler.job import job
from smarttestudo.ruler.rules.document import CheckedText, CheckedTexts, Draft


class PlacedZone(Struct, frozen=True, kw_only=True):
    """A rectangle of a rule. ``is_shared`` is whether a check of it bounds another rectangle as well."""

    topic: str
    rectangle: ZoneRectangle
    is_shared: bool


class RuleZones(Struct, frozen=True, kw_only=True):
    """The zones of the rule ``id``, in any of which it may hold.

    ``others`` are its checks that bound no zone, as text; ``holds_elsewhere`` is whether it can hold outside
    its zones; ``is_too_mixed`` says that its condition is too mixed to be drawn.
    """

    id: str
    label: str
    zones: tuple[PlacedZone, ...]
    others: tuple[str, ...]
    holds_elsewhere: bool
    is_too_mixed: bool


class ZoneClash(Struct, frozen=True, kw_only=True):
    """Two rules that clash with a zone in ``common``; ``message`` and ``hint`` are the checker's."""

    first: str
    second: str
    message: str
    hint: str
    common: tuple[ZoneRectangle, ...]


class ZonesAnswer(Struct, frozen=True, kw_only=True):
    """The zones of a draft; ``label`` is a name for a new zone that no rule has."""

    rules: tuple[RuleZones, ...]
    clashes: tuple[ZoneClash, ...]
    label: str


@dataclass(frozen=True, slots=True, kw_only=True)
class _Rule:
    """A rule, which is statement ``id`` of its text, and what it says about places."""

    id: str
    block: Block
    reading: ZoneReading


@job("POST /api/zones", reads=True)
def zones(draft: Draft, texts: CheckedTexts) -> ZonesAnswer:
    """The zones of a text that can be read, and which clash."""
    checked = texts.checked(draft)
    rules = [
        _Rule(id=entry.id, block=entry.statement, reading=zones_in(entry.statement.condition, resolve_topic))
        for entry in checked.document.entries
        if isinstance(entry.statement, Block)
    ]
    return ZonesAnswer(
        rules=tuple(map(_rule_zones, rules)),
        clashes=tuple(_clashes(checked, rules)),
        label=_unused_label(checked.document),
    )


def _rule_zones(rule: _Rule) -> RuleZones:
    reading = rule.reading
    return RuleZones(
        id=rule.id,
        label=f"{rule.block.label} (switched off)" if rule.block.is_disabled else rule.block.label,
        zones=tuple(
            PlacedZone(topic=one.topic, rectangle=one.rectangle, is_shared=_is_shared(one, reading))
            for one in reading.zones
        ),
        others=tuple(map(check_text, reading.others)),
        holds_elsewhere=reading.holds_elsewhere,
        is_too_mixed=reading.is_too_mixed,
    )


def _is_shared(zone: Zone, reading: ZoneReading) -> bool:
    """Whether a check that bounds ``zone`` bounds another one as well."""
    uses = Counter(number for one in reading.zones for number in one.checks.values())
    return any(uses[number] > 1 for number in zone.checks.values())


def _clashes(checked: CheckedText, rules: Sequence[_Rule]) -> Iterator[ZoneClash]:
    """The clashes among the checker's findings in which zones overlap."""
    by_id = {rule.id: rule for rule in rules}
    document = checked.document
    for finding in checked.findings:
        if finding.code != blocks_clash.code:
            continue
        second = _rule_at(document, finding.span, by_id)
        for span in finding.related:
            first = _rule_at(document, span, by_id)
            if first is None or second is None or not _differ(first.block, second.block):
                continue
            common = tuple(_common(first, second))
            if common:
                yield ZoneClash(
                    first=first.id,
                    second=second.id,
                    message=finding.message,
                    hint=finding.hint,
                    common=common,
                )


def _unused_label(document: Document) -> str:
    """``Zone 1``, or the next number that no rule has."""
    taken = {entry.statement.label for entry in document.entries if isinstance(entry.statement, Block)}
    number = next(number for number in range(1, len(taken) + 2) if f"Zone {number}" not in taken)
    return f"Zone {number}"


def _differ(first: Block, second: Block) -> bool:
    """Whether the rules differ where their conditions hold; an Else holds outside the zones."""
    rates = {resolve_topic(one.topic.text): one.rate.rate for one in sets_in(first.then)}
    others = ((rates.get(resolve_topic(one.topic.text)), one.rate.rate) for one in sets_in(second.then))
    return any(one is not None and other is not None and one != other for one, other in others)


def _common(first: _Rule, second: _Rule) -> Iterator[ZoneRectangle]:
    for one in first.reading.zones:
        for other in second.reading.zones:
            common = one.rectangle.common(other.rectangle) if one.topic == other.topic else None
            if common is not None:
                yield common


def _rule_at(document: Document, span: Span, by_id: dict[str, _Rule]) -> _Rule | None:
    entry = document.entry_at(document.places.range(span)[0])
    return None if entry is None else by_id.get(entry.id)


_NOWHERE = Span(line=1, column=1, end_line=1, end_column=1)
_USUAL_RATE_HZ = 10.0
_FAR_M = 1e6
_CM_PER_M = 100
_CM2_PER_M2 = 10_000


class NewZone(Struct, frozen=True, kw_only=True, tag_field="kind", tag="zone_new"):
    """An edit: make ``rectangles`` the condition of rule ``into``, or, if that is null, of a new one."""

    topic: str
    rectangles: tuple[ZoneRectangle, ...]
    into: str | None = None
    label: str = "Zone"


class MoveZone(Struct, frozen=True, kw_only=True, tag_field="kind", tag="zone_move"):
    """An edit: move all zones of rule ``id`` on ``topic``, in whole centimetres."""

    id: str
    topic: str
    dx: float
    dy: float


class ResizeZone(Struct, frozen=True, kw_only=True, tag_field="kind", tag="zone_resize"):
    """An edit: give zone number ``index`` of rule ``id`` other sides."""

    id: str
    index: int
    rectangle: ZoneRectangle


class CoverRequest(Struct, frozen=True, kw_only=True):
    """The corners of a polygon, in its order."""

    corners: tuple[tuple[float, float], ...]
    max_rectangles: int = 8


class CoverAnswer(Struct, frozen=True, kw_only=True):
    """Rectangles that share no area and hold the polygon; ``over_m2`` is what they cover beside it."""

    rectangles: tuple[ZoneRectangle, ...]
    polygon_m2: float
    over_m2: float


def zone_edited(document: Document, change: NewZone | MoveZone | ResizeZone) -> str:
    """The text with one zone edited. Raises ``EditError`` for what no rule can say."""
    match change:
        case NewZone():
            rectangles = [_bounded(one) for one in change.rectangles[: MAX_RECTANGLES + 1]]
            if len(rectangles) > MAX_RECTANGLES:
                raise EditError(f"a zone has at most {MAX_RECTANGLES} rectangles", remedy="draw it simpler")
            return with_new_zone(document, change.topic, rectangles, into=change.into, label=change.label)
        case MoveZone():
            by_m = (_known(change.dx), _known(change.dy))
            return with_moved_zone(document, change.id, change.topic, by_m)
        case ResizeZone():
            return with_resized_zone(document, change.id, change.index, _bounded(change.rectangle))


@job("POST /api/zones/cover", reads=True)
def cover(request: CoverRequest) -> CoverAnswer:
    """The rectangles for a polygon; its corners are rounded to centimetres."""
    if not 1 <= request.max_rectangles <= MAX_RECTANGLES:
        raise PolygonError(f"the rectangles must be 1 to {MAX_RECTANGLES}", remedy="give another number")
    corners = [(round(_known(x) * _CM_PER_M), round(_known(y) * _CM_PER_M)) for x, y in request.corners]
    found = covering_rectangles(corners, max_rectangles=request.max_rectangles)
    return CoverAnswer(
        rectangles=tuple(
            ZoneRectangle(
                min_x_m=one.min_x_cm / _CM_PER_M,
                max_x_m=one.max_x_cm / _CM_PER_M,
                min_y_m=one.min_y_cm / _CM_PER_M,
                max_y_m=one.max_y_cm / _CM_PER_M,
            )
            for one in found.rectangles
        ),
        polygon_m2=found.polygon_cm2 / _CM2_PER_M2,
        over_m2=found.over_cm2 / _CM2_PER_M2,
    )


def with_moved_zone(document: Document, name: str, topic: str, by_m: tuple[float, float]) -> str:
    """The text with all zones of rule ``name`` on ``topic`` elsewhere: other numbers and nothing else."""
    block = moved_zone(_block(document, name), topic, by_m, resolve_topic)
    return replaced(document, name, NewStatement(content=block))


def with_resized_zone(document: Document, name: str, index: int, rectangle: ZoneRectangle) -> str:
    """The text with other sides for zone number ``index`` of rule ``name``."""
    block = resized_zone(_block(document, name), index, rectangle, resolve_topic)
    return replaced(document, name, NewStatement(content=block))


def with_new_zone(
    document: Document, topic: str, rectangles: Sequence[ZoneRectangle], *, into: str | None, label: str
) -> str:
    """The text with the zone as condition of rule ``into``, or of a new rule ``label`` at the end.

    A new rule sets ``topic`` where that has a default, else the topic of the first default, to a rate that it
    does not have without the rule.
    """
    if any(one.is_empty for one in rectangles):
        raise EditError("this rectangle has no area", remedy="give it a width and a height")
    zone = zone_condition(topic, rectangles)
    if into is not None:
        block = with_zone(_block(document, into), zone, resolve_topic)
        return replaced(document, into, NewStatement(content=block))
    new = Block(
        name=label,
        priority=None,
        label=label,
        condition=zone,
        then=(_proposed_rate(document, topic),),
        otherwise=(),
        has_end_if=True,
        span=_NOWHERE,
    )
    part = _part_for_zone(document)
    return inserted(document, part.id, len(part.entries), NewStatement(content=new))


def _part_for_zone(document: Document) -> CollectionPart:
    """The collection that a new rule goes to: the last one. Raises ``EditError`` where there is none."""
    part = next((one for one in reversed(document.parts) if one.begin is not None), None)
    if part is None:
        raise EditError("the text has no collection to write in", remedy="put 'begin' and 'end' in it")
    return part


def _proposed_rate(document: Document, position_topic: str) -> SetFrequency:
    """More than the default where that is possible: a zone is mostly a place to look closer."""
    defaults = [one.statement for one in document.entries if isinstance(one.statement, SetFrequency)]
    position = resolve_topic(position_topic)
    of_position = (one for one in defaults if resolve_topic(one.topic.text) == position)
    known = next(of_position, defaults[0] if defaults else None)
    topic = TopicName(text=position_topic, span=_NOWHERE) if known is None else known.topic
    default = None if known is None else known.rate.value
    is_usual_more = default in {None, RateWord.FULL, RateWord.OFF} or (
        isinstance(default, int | float) and default < _USUAL_RATE_HZ
    )
    rate = RateExpression(value=_USUAL_RATE_HZ if is_usual_more else RateWord.FULL, text="", span=_NOWHERE)
    return SetFrequency(topic=topic, rate=rate, span=_NOWHERE)


def _block(document: Document, name: str) -> Block:
    entry = document.entry(name)
    if entry is None or not isinstance(entry.statement, Block):
        raise EditError(f"the text has no rule {name!r}", remedy="read the document again")
    return entry.statement


def _bounded(rectangle: ZoneRectangle) -> ZoneRectangle:
    """``rectangle``; ``EditError`` where a side of it is no place on a map."""
    for side_m in (rectangle.min_x_m, rectangle.max_x_m, rectangle.min_y_m, rectangle.max_y_m):
        if side_m is not None:
            _known(side_m)
    return rectangle


def _known(metres: float) -> float:
    if not math.isfinite(metres) or abs(metres) > _FAR_M:
        raise EditError(f"{metres} m is no place on a map", remedy="give metres, below a million")
    return metres
