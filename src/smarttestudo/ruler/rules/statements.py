# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The content of a rule file, with positions: its statements as the page has them.

Every ``offset`` counts UTF-16 code units from the start of the text, as JavaScript strings do; a line end
counts as many as it has (CRLF: two). In a rule, those of checks and actions count from the rule's start, so
that they stay as they are when something above it changes. ``line`` and ``column`` count from 1, in
characters.

What an answer says about places (``id``, ``key``, ``offset``, ``end_offset``, ``line``) is ignored in a
request, so that a statement can be sent back as it came, with one value changed.
"""

from __future__ import annotations

from msgspec import Struct

from smarttestudo.domain.rate import Tier
from smarttestudo.language.syntax import DurationUnit, Operator, TimeWord


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

Compared = float | str
"""A number; else as a rule file spells it: a text in quotes, ``true``, ``false`` or a constant."""


class UntilValue(Struct, frozen=True, kw_only=True):
    """``Until op value`` behind a check: what ends it."""

    op: Operator
    value: Compared


class CheckCondition(Struct, frozen=True, kw_only=True, tag_field="kind", tag="check"):
    """``CheckValue topic property op value [Until op value]``; ``op`` is one of ``> < >= <= = !=``."""

    topic: str
    property: str
    op: Operator
    value: Compared
    until: UntilValue | None = None
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


class DurationValue(Struct, frozen=True, kw_only=True):
    """A time in ``unit``."""

    value: float
    unit: DurationUnit


class TimedCondition(Struct, frozen=True, kw_only=True, tag_field="kind", tag="timed"):
    """``term For duration``: it held all that time; ``term Within duration``: at some moment of it."""

    term: Condition
    word: TimeWord
    duration: DurationValue


Condition = CheckCondition | AndCondition | OrCondition | NotCondition | TimedCondition


class _PlacedStatement(Struct, frozen=True, kw_only=True):
    """Where a statement stands; the page leaves out what it does not know."""

    comments: tuple[str, ...] | None = None
    id: str = ""
    key: str = ""
    offset: int = 0
    end_offset: int = 0
    line: int = 0


class MarginValue(Struct, frozen=True, kw_only=True):
    """``.. to By topic property from .. to``: the rate goes to another one as a value goes to another one."""

    to: Rate
    topic: str
    property: str
    from_value: float
    to_value: float


class SetStatement(_PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="set"):
    """``SetFrequency topic rate [margin]``: a default, or in a rule, without ``id`` and ``key``."""

    topic: str
    rate: Rate
    margin: MarginValue | None = None


Bound = float | Tier
"""How far off a property may be, in its unit, or the name of a level."""


class WithinStatement(_PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="within"):
    """``KeepWithin topic property bound``, as a default or in a rule."""

    topic: str
    property: str
    bound: Bound


class RecordStatement(_PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="record"):
    """``Record "name" topics Before … After …`` in a rule; no topics stand for all that the rules name."""

    name: str
    topics: tuple[str, ...]
    before: DurationValue
    after: DurationValue


class ParameterStatement(_PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="parameter"):
    """``SetParameter node parameter value`` in a rule; the value as a rule file spells it: 1 is no 1.0."""

    node: str
    parameter: str
    value: str


class CallStatement(_PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="call"):
    """``Call service [true | false]`` in a rule."""

    service: str
    argument: bool | None = None


class NotifyStatement(_PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="notify"):
    """``Notify "text"`` in a rule."""

    text: str


Action = (
    SetStatement | WithinStatement | RecordStatement | ParameterStatement | CallStatement | NotifyStatement
)


class KeepStatement(_PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="keep"):
    """``KeepAtLeast topic hz``."""

    topic: str
    hz: float


class RuleStatement(
    _PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="rule", rename={"otherwise": "else"}
):
    """``[Disabled] [Rule "name" [Priority n]] If … Then … [Else …]``; in JSON ``otherwise`` is ``else``.

    ``label`` (answers only) is what findings and decisions call the rule.
    """

    condition: Condition
    then: tuple[Action, ...]
    otherwise: tuple[Action, ...]
    name: str | None = None
    priority: int = 0
    is_disabled: bool = False
    label: str = ""


class RawStatement(_PlacedStatement, frozen=True, kw_only=True, tag_field="kind", tag="raw"):
    """Text that does not parse, as it stands in the file; in a request, what to write."""

    text: str


Statement = SetStatement | KeepStatement | WithinStatement | RuleStatement | RawStatement
