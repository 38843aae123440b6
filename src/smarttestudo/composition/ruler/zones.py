# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The zones of a rule file, and the edits that a map makes: new zones, moved ones, other sides."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from smarttestudo.adirf.checks.blocks_clash import CHECK as BLOCKS_CLASH
from smarttestudo.adirf.checks.written import rate_of
from smarttestudo.adirf.document import Document, EditError, Entry, NewStatement, Part, inserted, replaced
from smarttestudo.adirf.syntax import Block, RateExpression, SetFrequency, TopicName
from smarttestudo.adirf.zones import (
    Zone,
    ZoneReading,
    ZoneRectangle,
    moved_zone,
    resized_zone,
    with_zone,
    zone_condition,
    zones_in,
)
from smarttestudo.composition.ruler.checked_text import CheckedText
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.source import Span

_NOWHERE = Span(line=1, column=1, end_line=1, end_column=1)
_USUAL_TOPIC, _USUAL_RATE_HZ = "/odom", 10.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleZones:
    """The zones of one rule, which is statement ``id`` of its text."""

    id: str
    block: Block
    reading: ZoneReading

    def is_shared(self, zone: Zone) -> bool:
        """Whether a check that bounds ``zone`` bounds another one as well."""
        uses = Counter(number for one in self.reading.zones for number in one.checks.values())
        return any(uses[number] > 1 for number in zone.checks.values())


@dataclass(frozen=True, slots=True, kw_only=True)
class ZoneClash:
    """Two rules that the checker says clash, and the rectangles in which both have a zone."""

    first: str
    second: str
    message: str
    hint: str
    common: tuple[ZoneRectangle, ...]


def rule_zones_of(document: Document) -> list[RuleZones]:
    """What each rule of a text that can be read says about places."""
    return [
        RuleZones(
            id=entry.id, block=entry.statement, reading=zones_in(entry.statement.condition, resolve_topic)
        )
        for entry in document.entries
        if isinstance(entry.statement, Block)
    ]


def zone_clashes(checked: CheckedText, rules: Sequence[RuleZones]) -> Iterator[ZoneClash]:
    """The clashes among the checker's findings in which zones overlap."""
    by_id = {rule.id: rule for rule in rules}
    document = checked.document
    for finding in checked.findings:
        if finding.code != BLOCKS_CLASH.code:
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

    A new rule sets the first default to the rate that it has: what the zone is for is said in the block.
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
        then=(_first_default(document),),
        otherwise=(),
        has_end_if=True,
        span=_NOWHERE,
    )
    part = part_for_zone(document)
    return inserted(document, part.id, len(part.entries), NewStatement(content=new))


def part_for_zone(document: Document) -> Part:
    """The collection that a new rule goes to: the last one. Raises ``EditError`` where there is none."""
    part = next((one for one in reversed(document.parts) if one.begin is not None), None)
    if part is None:
        raise EditError("the text has no collection to write in", remedy="put 'begin' and 'end' in it")
    return part


def unused_label(document: Document) -> str:
    """``Zone 1``, or the next number that no rule has."""
    taken = {entry.statement.label for entry in document.entries if isinstance(entry.statement, Block)}
    number = next(number for number in range(1, len(taken) + 2) if f"Zone {number}" not in taken)
    return f"Zone {number}"


def _first_default(document: Document) -> SetFrequency:
    known = next((one.statement for one in document.entries if isinstance(one.statement, SetFrequency)), None)
    if known is not None:
        return SetFrequency(topic=known.topic, rate=known.rate, span=_NOWHERE)
    return SetFrequency(
        topic=TopicName(text=_USUAL_TOPIC, span=_NOWHERE),
        rate=RateExpression(value=_USUAL_RATE_HZ, text="", span=_NOWHERE),
        span=_NOWHERE,
    )


def _differ(first: Block, second: Block) -> bool:
    """Whether the rules differ where their conditions hold; an Else holds outside the zones."""
    rates = {resolve_topic(one.topic.text): rate_of(one.rate) for one in first.then}
    others = ((rates.get(resolve_topic(one.topic.text)), rate_of(one.rate)) for one in second.then)
    return any(one is not None and other is not None and one != other for one, other in others)


def _common(first: RuleZones, second: RuleZones) -> Iterator[ZoneRectangle]:
    for one in first.reading.zones:
        for other in second.reading.zones:
            common = one.rectangle.common(other.rectangle) if one.topic == other.topic else None
            if common is not None:
                yield common


def _rule_at(document: Document, span: Span, by_id: dict[str, RuleZones]) -> RuleZones | None:
    entry = document.entry_at(document.places.range(span)[0])
    return None if entry is None else by_id.get(entry.id)


def _block(document: Document, name: str) -> Block:
    entry: Entry | None = document.entry(name)
    if entry is None or not isinstance(entry.statement, Block):
        raise EditError(f"the text has no rule {name!r}", remedy="read the document again")
    return entry.statement
