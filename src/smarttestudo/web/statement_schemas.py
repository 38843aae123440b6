# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The statement model in JSON: what a rule file says, and where.

Every ``offset`` counts UTF-16 code units from the start of the text, as JavaScript strings do; a line end
counts as many as it has (CRLF: two). ``line`` and ``column`` count from 1, in characters.

What an answer says about places (``id``, ``key``, ``offset``, ``end_offset``, ``line``, ``text``) is ignored
in a request, so that a statement can be sent back as it came, with one value changed.
"""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

from smarttestudo.adirf.syntax import Operator
from smarttestudo.domain.tier import Tier


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


AnyRate = Hz | TierRate | FullRate | OffRate


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

    terms: tuple[AnyCondition, ...]


class OrCondition(Struct, frozen=True, kw_only=True, tag_field="kind", tag="or"):
    """One of the terms holds; at least one term."""

    terms: tuple[AnyCondition, ...]


class NotCondition(Struct, frozen=True, kw_only=True, tag_field="kind", tag="not"):
    """The term does not hold."""

    term: AnyCondition


AnyCondition = CheckCondition | AndCondition | OrCondition | NotCondition


class SetStatement(Struct, frozen=True, kw_only=True, tag_field="kind", tag="set"):
    """``SetFrequency topic rate``: a default, or what a rule sets (then ``id`` and ``key`` are empty)."""

    topic: str
    rate: AnyRate
    comments: tuple[str, ...] | None = None
    id: str = ""
    key: str = ""
    offset: int = 0
    end_offset: int = 0
    line: int = 0
    text: str = ""


class KeepStatement(Struct, frozen=True, kw_only=True, tag_field="kind", tag="keep"):
    """``KeepAtLeast topic hz``."""

    topic: str
    hz: float
    comments: tuple[str, ...] | None = None
    id: str = ""
    key: str = ""
    offset: int = 0
    end_offset: int = 0
    line: int = 0
    text: str = ""


class RuleStatement(
    Struct, frozen=True, kw_only=True, tag_field="kind", tag="rule", rename={"otherwise": "else"}
):
    """``[Rule "name" [Priority n]] If … Then … [Else …]``; in JSON ``otherwise`` is called ``else``.

    ``label`` (answers only) is what findings and decisions call the rule.
    """

    condition: AnyCondition
    then: tuple[SetStatement, ...]
    otherwise: tuple[SetStatement, ...] = ()
    name: str | None = None
    priority: int = 0
    label: str = ""
    comments: tuple[str, ...] | None = None
    id: str = ""
    key: str = ""
    offset: int = 0
    end_offset: int = 0
    line: int = 0
    text: str = ""


class RawStatement(Struct, frozen=True, kw_only=True, tag_field="kind", tag="raw"):
    """Text that does not parse, as it stands in the file; in a request ``text`` is what to write."""

    text: str
    comments: tuple[str, ...] | None = None
    id: str = ""
    key: str = ""
    offset: int = 0
    end_offset: int = 0
    line: int = 0


AnyStatement = SetStatement | KeepStatement | RuleStatement | RawStatement


class CollectionModel(Struct, frozen=True, kw_only=True):
    """``begin … end`` with its statements in order.

    ``is_written`` is false for statements and other text that stand outside any ``begin … end``.
    """

    id: str
    is_written: bool
    offset: int
    end_offset: int
    line: int
    comments: tuple[str, ...]
    statements: tuple[AnyStatement, ...]


class FixModel(Struct, frozen=True, kw_only=True):
    """What mends a finding: ``replacement`` in the place of a stretch of the text."""

    title: str
    offset: int
    end_offset: int
    replacement: str


class FindingModel(Struct, frozen=True, kw_only=True):
    """One thing the checker says; ``index`` is its number for ``/api/fix``.

    ``statement`` is the id of the statement it is about, ``related`` are those of others that it names.
    """

    index: int
    code: str
    severity: Literal["error", "warning", "info"]
    message: str
    hint: str
    line: int
    column: int
    end_line: int
    end_column: int
    offset: int
    end_offset: int
    fix: FixModel | None
    statement: str | None
    related: tuple[str, ...]


class DocumentModel(Struct, frozen=True, kw_only=True):
    """A rule file as statements and findings.

    An ``id`` names a statement of exactly this text. A ``key`` comes from the statement's words: it survives
    edits elsewhere and moves, so that block positions can be kept by it.
    """

    collections: tuple[CollectionModel, ...]
    findings: tuple[FindingModel, ...]
    parses: bool
