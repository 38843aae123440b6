# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The zones of a rule file, and where they clash. Lengths are metres."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from msgspec import Struct

from smarttestudo.checks.blocks import blocks_clash
from smarttestudo.domain.finding import Span
from smarttestudo.domain.names import resolve_topic
from smarttestudo.editing import Document
from smarttestudo.editing.zones import Zone, ZoneReading, ZoneRectangle, zones_in
from smarttestudo.language.formatter import check_text
from smarttestudo.language.syntax import Block, sets_in
from smarttestudo.ruler.rules.checked_text import CheckedText


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
    """``POST /api/zones`` with a ``Draft``. ``label`` is a name for a new zone that no rule has."""

    rules: tuple[RuleZones, ...]
    clashes: tuple[ZoneClash, ...]
    label: str


@dataclass(frozen=True, slots=True, kw_only=True)
class _Rule:
    """A rule, which is statement ``id`` of its text, and what it says about places."""

    id: str
    block: Block
    reading: ZoneReading


def zones_answer(checked: CheckedText) -> ZonesAnswer:
    """The zones of a text that can be read, and which clash."""
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
