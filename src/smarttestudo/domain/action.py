# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Actions of blocks beside relaying and recording: what to do, what was decided, and what came of it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Annotated

from smarttestudo.domain.errors import shortened
from smarttestudo.domain.record import Decimals, JsonEntry, entries_of, from_json
from smarttestudo.domain.signal import Value
from smarttestudo.domain.texts import visible

SetValue = bool | int | float | str
"""A value that a rule gives a parameter."""


class ActionKind(Enum):
    """Kind of an action; the value is its word in a rule file."""

    SET_PARAMETER = "SetParameter"
    CALL = "Call"
    NOTIFY = "Notify"


@dataclass(frozen=True, slots=True, kw_only=True)
class ActRequest:
    """Something to do; ``target`` is the full name of a node or a service, or the text of a Notify.

    ``value`` is what ``parameter`` gets; of a Call it is what it says, true or false, if that is written. A
    SetParameter without one gives the parameter its value back.
    """

    kind: Annotated[ActionKind, JsonEntry(name="action")]
    target: str
    parameter: Annotated[str, JsonEntry(omits_default=True)] = ""
    value: Annotated[SetValue | None, JsonEntry(is_absent=True)] = None

    @property
    def place(self) -> str:
        """The parameter, the service or the text that it is about, on one line."""
        if self.kind is ActionKind.NOTIFY:
            return quoted(self.target)
        return f"{self.target} {self.parameter}".rstrip()

    def is_same(self, other: ActRequest) -> bool:
        """Whether it does what ``other`` does: to a node, 1, 1.0 and true are not the same."""
        return self == other and type(self.value) is type(other.value)

    def __str__(self) -> str:
        """On one line, as a rule file has it."""
        value = "" if self.value is None else f" {value_text(self.value)}"
        return f"{self.kind.value} {self.place}{value}"


def value_text(value: object) -> str:
    """A value as a rule file has it, on one line."""
    if isinstance(value, bool):
        return str(value).lower()
    return quoted(value) if isinstance(value, str) else str(value)


def quoted(text: str) -> str:
    """``text`` in quotes, on one line, its middle left out where it is long."""
    return visible(json.dumps(shortened(text), ensure_ascii=False))


class ActionEvent(Enum):
    """Event of an action: the first ones are decided by the loop, and a replay has the same."""

    BEGIN = "begin"
    """The block holds from now on: it is to be done."""
    SKIPPED = "skipped"
    """The block began to hold within a second of the last time."""
    NOT_ALLOWED = "not allowed"
    """The profile does not allow it."""
    END = "end"
    """The block holds no more: a parameter gets its value back, a notice is over."""
    DRY = "dry"
    """Not done, as ``--dry-actions`` says."""
    DONE = "done"
    FAILED = "failed"
    LEFT_ALONE = "left alone"
    """Somebody else changed the parameter meanwhile, and it keeps its value."""

    @property
    def is_outcome(self) -> bool:
        """Whether it says what came of an action, which only a run knows."""
        return self in _OUTCOMES


_OUTCOMES = frozenset({ActionEvent.DRY, ActionEvent.DONE, ActionEvent.FAILED, ActionEvent.LEFT_ALONE})


@dataclass(frozen=True, slots=True, kw_only=True)
class ActionDecision:
    """One event of an action; ``t_s`` counts from the loop's start.

    ``rule`` and ``line`` name the block; ``values`` are what its condition read. ``lasted_s`` is how long it
    held at the end. ``detail`` is the answer of a service or a node, or why nothing was done.
    """

    t_s: Annotated[float, Decimals(6), JsonEntry(name="t")]
    stamp_ns: int
    event: ActionEvent
    action: Annotated[ActRequest, JsonEntry(is_merged=True)]
    rule: str | None = None
    line: int | None = None
    values: Annotated[Mapping[str, Value | None], JsonEntry(omits_default=True, has_infinite=True)] = field(
        default_factory=dict
    )
    lasted_s: Annotated[float | None, Decimals(6), JsonEntry(omits_default=True)] = None
    detail: Annotated[str, JsonEntry(omits_default=True)] = ""

    def to_json(self) -> dict[str, object]:
        """The object of one line of the decisions file."""
        value = self.action.value
        return {**entries_of(self), **({} if value is None else {"value": value})}

    @staticmethod
    def from_json(record: object) -> ActionDecision:
        """The event that ``to_json`` wrote as ``record``. Raises ``ValueError`` where it wrote none."""
        decision = from_json(ActionDecision, record)
        value = record.get("value") if isinstance(record, dict) else None
        if value is not None and not isinstance(value, SetValue):
            raise ValueError("value: neither a number, a text, true nor false")
        return replace(decision, action=replace(decision.action, value=value))

    def outcome(self, event: ActionEvent, *, t_s: float, stamp_ns: int, detail: str = "") -> ActionDecision:
        """This action with what came of it, at another time."""
        return replace(
            self, t_s=t_s, stamp_ns=stamp_ns, event=event, values={}, lasted_s=None, detail=shortened(detail)
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Notice:
    """A text that a rule notifies while it holds, since ``since_ns`` on the robot's clock."""

    text: str
    rule: str | None
    since_ns: int


def action_line(decision: ActionDecision) -> str:
    """An event for the log, on one line."""
    words = decision.event.value
    if decision.lasted_s is not None:
        words += f" after {decision.lasted_s:.1f} s"
    if decision.detail:
        words += f": {visible(decision.detail)}"
    elif decision.rule is not None:
        words += f" ({visible(decision.rule)})"
    return f"{decision.action}: {words}"
