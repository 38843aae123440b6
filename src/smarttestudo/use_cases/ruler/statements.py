# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The content of a rule file, with positions: its statements as the page has them.

Every ``offset`` counts UTF-16 code units from the start of the text, as JavaScript strings do; a line end
counts as many as it has (CRLF: two). ``line`` and ``column`` count from 1, in characters.

What an answer says about places (``id``, ``key``, ``offset``, ``end_offset``, ``line``, ``text``) is ignored
in a request, so that a statement can be sent back as it came, with one value changed.
"""

from __future__ import annotations

from msgspec import Struct

from smarttestudo.adirf.syntax import Operator
from smarttestudo.domain.rate import Tier


class Hz(Struct, frozen=True, kw_only=True, tag_field="kind", tag="hz"):
    """A rate in Hz, 0 … 1e6."""

    value: float


class TierRate(Struct, frozen=True, kw_only=True, tag_field="kind", tag="tier"):
    """The rate that the optimizer gives a level, named as in a rule file: ``"Desirable"``."""

    value: Tier


class FullRate(Struct, frozen=True, kw_only=True, tag_field="kind", tag="full"):
    """Every message passes."""

    value: None = None


class OffRate(Struct, frozen=True, kw_only=True, tag_field="kind", tag="off"):
    """Nothing passes."""

    value: None = None


Rate = Hz | TierRate | FullRate | OffRate


class CheckCondition(Struct, frozen=True, kw_only=True, tag_field="kind", tag="check"):
    """``CheckValue topic property op value``; ``op`` is one of ``> < >= <= = !=``."""

    topic: str
    property: str
    op: Operator
    value: float
    offset: int = 0
    end_offset: int = 0


class AndCondition(Struct, frozen=True, kw_only=True, tag_field="kind", tag="and"):
    """All terms hold; at least one term."""

    terms: tuple[Condition, ...]


class OrCondition(Struct, frozen=True, kw_only=True, tag_field="kind", tag="or"):
    """One of the terms holds; at least one term."""

    terms: tuple[Condition, ...]


class NotCondition(Struct, frozen=True, kw_only=True, tag_field="kind", tag="not"):
    """The term does not hold."""

    term: Condition


Condition = CheckCondition | AndCondition | OrCondition | NotCondition


class _PlacedStatement(Struct, frozen=True, kw_only=True):
    """Where a statement stands, and its text; the page leaves out what it does not know."""

    comments: tuple[str, ...] | None = None
    id: str = ""
    key: str = ""
    offset: int = 0
    end_offset: int = 0
    line: int = 0
    text: str = ""


class SetStatement(_PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="set"):
    """``SetFrequency topic rate``: a default, or what a rule sets (then ``id`` and ``key`` are empty)."""

    topic: str
    rate: Rate


class RecordStatement(Struct, frozen=True, kw_only=True):
    """``Record "name" topics Before before_s After after_s``; no topics stand for all that the rules name."""

    name: str
    topics: tuple[str, ...]
    before_s: float
    after_s: float


class KeepStatement(_PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="keep"):
    """``KeepAtLeast topic hz``."""

    topic: str
    hz: float


class RuleStatement(
    _PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="rule", rename={"otherwise": "else"}
):
    """``[Rule "name" [Priority n]] If … Then … [Else …]``; in JSON ``otherwise`` is called ``else``.

    ``label`` (answers only) is what findings and decisions call the rule. ``then_records`` and
    ``else_records`` left out of a request stay as they are in the rule that it replaces.
    """

    condition: Condition
    then: tuple[SetStatement, ...]
    otherwise: tuple[SetStatement, ...]
    name: str | None = None
    priority: int = 0
    label: str = ""
    then_records: tuple[RecordStatement, ...] | None = None
    else_records: tuple[RecordStatement, ...] | None = None


class RawStatement(_PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="raw"):
    """Text that does not parse, or says what the page has no words for, as it stands in the file.

    In a request ``text`` is what to write.
    """

    text: str


Statement = SetStatement | KeepStatement | RuleStatement | RawStatement
