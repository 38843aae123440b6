# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Why a topic has the rate it has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

from smarttestudo.domain.rate import Rate


class Reason(Enum):
    """What decided a rate."""

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
    """What decided the bound of one property; ``rule`` and ``line`` name the block where one did.

    ``UNKNOWN``: the block is in doubt. Its bound counts if the plan has one of the property, else every
    message up to the rate passes because of the doubt.
    """

    reason: Reason
    rule: str | None = None
    line: int | None = None

    def to_json(self) -> dict[str, object]:
        """The object in decisions and statuses."""
        return {"reason": self.reason.value, "rule": self.rule, "line": self.line}

    @staticmethod
    def from_json(record: Mapping[str, Any]) -> BoundReason:
        """Raises ``ValueError`` or ``LookupError`` for what ``to_json`` never gives."""
        return BoundReason(reason=Reason(record["reason"]), rule=record["rule"], line=record["line"])


def bound_texts(within: Mapping[str, float], reasons: Mapping[str, BoundReason]) -> tuple[str, ...]:
    """What bounds each property, and what decided it, as people read it.

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


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedRate:
    """The rate of one topic in a plan, with its reason.

    ``rule`` and ``line`` name the deciding block; both are ``None`` where no block decided. ``within`` are
    the bounds of the receiver's picture, by property; ``bound_reasons`` say of each what decided it, and of
    properties without a bound which block in doubt has one.
    """

    rate: Rate
    reason: Reason
    rule: str | None = None
    line: int | None = None
    within: Mapping[str, float] = field(default_factory=dict)
    bound_reasons: Mapping[str, BoundReason] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Decision:
    """One change of a plan: another rate, other bounds, or another deciding block.

    ``t_s`` counts from the loop's start. ``values`` holds what the deciding condition read, by signal
    name; unknown values are ``None``. ``from_rate`` is ``None`` on the first decision of a topic. ``is_end``:
    other rules came that do not relay the topic; its planned rate is 0 then. ``from_within`` are the bounds
    before.
    """

    t_s: float
    stamp_ns: int
    topic: str
    from_rate: Rate | None
    planned: PlannedRate
    values: Mapping[str, float | None]
    is_end: bool = False
    from_within: Mapping[str, float] = field(default_factory=dict)

    def to_json(self) -> dict[str, object]:
        """The object of one line of the decisions file."""
        record: dict[str, object] = {
            "t": round(self.t_s, 6),
            "stamp_ns": self.stamp_ns,
            "topic": self.topic,
            "from_hz": None if self.from_rate is None else self.from_rate.to_json(),
            "to_hz": self.planned.rate.to_json(),
            "reason": self.planned.reason.value,
            "rule": self.planned.rule,
            "line": self.planned.line,
            "values": dict(self.values),
        }
        if self.from_rate is None:
            record["start"] = True
        if self.is_end:
            record["end"] = True
        if self.from_within != self.planned.within:
            record["from_within"] = dict(self.from_within)
            record["to_within"] = dict(self.planned.within)
        if self.planned.bound_reasons:
            record["bound_reasons"] = {
                name: one.to_json() for name, one in self.planned.bound_reasons.items()
            }
        return record

    @staticmethod
    def from_json(record: Mapping[str, Any]) -> Decision:
        """The decision that ``to_json`` gave ``record`` for; bounds that did not change are left out.

        Raises ``ValueError``, ``TypeError`` or ``LookupError`` where it gave it for none.
        """
        starts = bool(record.get("start", False))
        return Decision(
            t_s=float(record["t"]),
            stamp_ns=int(record["stamp_ns"]),
            topic=str(record["topic"]),
            from_rate=None if starts else Rate.from_json(record["from_hz"]),
            planned=PlannedRate(
                rate=Rate.from_json(record["to_hz"]),
                reason=Reason(record["reason"]),
                rule=record["rule"],
                line=record["line"],
                within=_bounds(record.get("to_within", {})),
                bound_reasons={
                    str(name): BoundReason.from_json(one)
                    for name, one in record.get("bound_reasons", {}).items()
                },
            ),
            values={
                str(name): None if value is None else float(value) for name, value in record["values"].items()
            },
            is_end=bool(record.get("end", False)),
            from_within=_bounds(record.get("from_within", {})),
        )


def _bounds(record: Mapping[str, Any]) -> dict[str, float]:
    return {str(name): float(bound) for name, bound in record.items()}
