# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Why a topic has the rate and the bounds it has."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Annotated

from smarttestudo.domain.action import ActionDecision
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.record import Decimals, JsonEntry, derived, entries_of, from_json
from smarttestudo.domain.signal import Value


class Reason(Enum):
    """Reason for a rate."""

    DEFAULT = "default"
    BLOCK = "block"
    UNKNOWN = "unknown"
    FLOOR = "floor"
    BUDGET = "budget"
    LINK = "link"
    FALLBACK = "fallback"
    RELOAD = "reload"


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundReason:
    """Reason for the bound of one property; ``rule`` and ``line`` name the block where one decided.

    ``UNKNOWN``: the block is in doubt. Its bound counts if the plan has one of the property, else every
    message up to the rate passes because of the doubt.
    """

    reason: Reason
    rule: str | None = None
    line: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedRate:
    """The rate of one topic in a plan, with its reason.

    ``rule`` and ``line`` name the deciding block; both are ``None`` where no block decided. ``within`` are
    the bounds of the receiver's picture, by property; ``bound_reasons`` say of each what decided it, and of
    properties without a bound which block in doubt has one.
    """

    rate: Annotated[Rate, JsonEntry(name="to_hz")]
    reason: Reason
    rule: str | None = None
    line: int | None = None
    within: Annotated[Mapping[str, float], JsonEntry(name="to_within")] = field(default_factory=dict)
    bound_reasons: Annotated[Mapping[str, BoundReason], JsonEntry(omits_default=True)] = field(
        default_factory=dict
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Decision:
    """One change of a plan: another rate, other bounds, another deciding block, or one no more in doubt.

    ``t_s`` counts from the loop's start. ``values`` holds what the deciding condition read, by signal name;
    unknown values are ``None``. ``from_rate`` is ``None`` on the first decision of a topic. ``is_end``: other
    rules arrived that do not relay the topic; its planned rate is 0 then. ``from_within`` are the bounds
    before.
    """

    t_s: Annotated[float, Decimals(6), JsonEntry(name="t")]
    stamp_ns: int
    topic: str
    from_rate: Annotated[Rate | None, JsonEntry(name="from_hz")]
    planned: Annotated[PlannedRate, JsonEntry(is_merged=True)]
    values: Annotated[Mapping[str, Value | None], JsonEntry(has_infinite=True)]
    is_end: Annotated[bool, JsonEntry(name="end", omits_default=True)] = False
    from_within: Mapping[str, float] = field(default_factory=dict)

    @property
    @derived("start", omits_default=True)
    def is_first(self) -> bool:
        """Whether the topic had no rate before."""
        return self.from_rate is None

    def to_json(self) -> dict[str, object]:
        """The object of one line of the decisions file; bounds that did not change are left out."""
        record = entries_of(self)
        if self.from_within == self.planned.within:
            del record["from_within"], record["to_within"]
        return record

    @staticmethod
    def from_json(record: object) -> Decision:
        """The decision that ``to_json`` wrote as ``record``. Raises ``ValueError`` where it wrote none."""
        decision = from_json(Decision, record)
        # Both no rate yet and Full are null.
        is_first = isinstance(record, dict) and record.get("start", False)
        return replace(decision, from_rate=None if is_first else decision.from_rate or Rate.full())


AnyDecision = Decision | ActionDecision
"""What a decisions file has, one a line."""


def decision_from_json(record: object) -> AnyDecision:
    """The decision of one line. Raises ``ValueError`` where it is none."""
    is_action = isinstance(record, dict) and "action" in record
    return (ActionDecision if is_action else Decision).from_json(record)


def about_rates(decisions: Iterable[AnyDecision]) -> list[Decision]:
    """The ``decisions`` about topics."""
    return [one for one in decisions if isinstance(one, Decision)]


def about_actions(decisions: Iterable[AnyDecision]) -> list[ActionDecision]:
    """The ``decisions`` about actions, with what came of them."""
    return [one for one in decisions if isinstance(one, ActionDecision)]


def bound_texts(within: Mapping[str, float], reasons: Mapping[str, BoundReason]) -> tuple[str, ...]:
    """Bound of each property, and what decided it, as people read them.

    ``position 0.05: Docking``, ``position 0.05, in doubt: Docking`` and, where a doubt lets everything pass,
    ``position not bound, in doubt: Docking``.
    """
    return tuple(
        f"{name} {f'{within[name]:g}' if name in within else 'not bound'}{_decider(reasons.get(name))}"
        for name in dict.fromkeys([*within, *reasons])
    )


def _decider(decided: BoundReason | None) -> str:
    if decided is None:
        return ""
    return f"{', in doubt' * (decided.reason is Reason.UNKNOWN)}: {decided.rule or decided.reason.value}"
