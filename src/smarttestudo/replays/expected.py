# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Decisions that rules are expected to make over a recording, and the first that they make otherwise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path

from smarttestudo.domain.action import ActionDecision
from smarttestudo.domain.decision import AnyDecision
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.json_text import json_text
from smarttestudo.loop.decision_log import DecisionLogError, read_all_decisions
from smarttestudo.robot.decisions import decision_line

_REMEDY = "--update writes what is decided now"


class UnexpectedDecisionError(TestudoError):
    """The first decision that differs from the expected one."""


def read_expected(path: Path) -> list[AnyDecision]:
    """The decisions in the file at ``path``. Raises ``DecisionLogError``."""
    if not path.exists():
        raise DecisionLogError("there are no expected decisions", place=str(path), remedy=_REMEDY)
    return read_all_decisions(path)


def require_expected(expected: Sequence[AnyDecision], decided: Sequence[AnyDecision], path: Path) -> None:
    """Raise ``UnexpectedDecisionError`` where ``decided`` are not the ``expected`` ones of ``path``.

    The lines of rules do not count, since each comment moves them, nor does what came of actions.
    """
    lines = [(number, one) for number, one in enumerate(expected, 1) if not _is_outcome(one)]
    for line, other in zip_longest(lines, decided):
        number, one = line or (len(expected) + 1, None)
        if one is None or other is None or _compared(one) != _compared(other):
            raise UnexpectedDecisionError(_difference(one, other), place=f"{path}:{number}", remedy=_REMEDY)


def _is_outcome(decision: AnyDecision) -> bool:
    return isinstance(decision, ActionDecision) and decision.event.is_outcome


def _compared(decision: AnyDecision) -> Mapping[str, object]:
    """The object of the file, without lines."""
    if isinstance(decision, ActionDecision):
        return replace(decision, line=None).to_json()
    planned = decision.planned
    reasons = {name: replace(reason, line=None) for name, reason in planned.bound_reasons.items()}
    return replace(decision, planned=replace(planned, line=None, bound_reasons=reasons)).to_json()


def _difference(expected: AnyDecision | None, decided: AnyDecision | None) -> str:
    first = expected or decided
    assert first is not None
    words = f"at {first.t_s:.3f} s: expected {_quoted(expected)}"
    if expected is None or decided is None:
        return f"{words}, decided {_quoted(decided)}"
    is_later = f"{expected.t_s:.3f}" != f"{decided.t_s:.3f}"
    if is_later or decision_line(expected) != decision_line(decided):
        return f"{words}, decided {_quoted(decided)}{f' at {decided.t_s:.3f} s' * is_later}"
    one, other = _compared(expected), _compared(decided)
    name = next(key for key in (*one, *other) if one.get(key) != other.get(key))
    entries = (json_text({name: each.get(name)}, ascii_only=False)[1:-1] for each in (one, other))
    return f"{words} with {', decided '.join(entries)}"


def _quoted(decision: AnyDecision | None) -> str:
    return "nothing more" if decision is None else f'"{decision_line(decision)}"'
