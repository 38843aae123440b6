# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Conditions as AND/OR trees over regions of signals, with every Not pushed into the checks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from smarttestudo.adirf.region import Region
from smarttestudo.adirf.syntax import And, Check, Condition, Group, Not, Or
from smarttestudo.domain.signal import Signal


@dataclass(frozen=True, slots=True)
class Within:
    """True while the signal's value lies in the region, unknown while the signal is unknown."""

    signal: Signal
    region: Region


@dataclass(frozen=True, slots=True)
class Every:
    """Kleene AND of two or more parts."""

    parts: tuple[Form, ...]


@dataclass(frozen=True, slots=True)
class Some:
    """Kleene OR of two or more parts."""

    parts: tuple[Form, ...]


Form = Within | Every | Some
Resolve = Callable[[str], str]


def normal_form(condition: Condition, resolve: Resolve, *, negated: bool = False) -> Form:
    """``condition`` (or its negation) without Not, nested alike parts joined.

    De Morgan's laws and ``not (x > 3) == x <= 3`` hold in Kleene's logic, so truth stays the same for every
    state, unknown included. ``resolve`` gives the full name of a topic.
    """
    match condition:
        case Check():
            region = Region.where(condition.operator, condition.value)
            signal = Signal(resolve(condition.topic.text), condition.property)
            return Within(signal, region.complement() if negated else region)
        case Group():
            return normal_form(condition.operand, resolve, negated=negated)
        case Not():
            return normal_form(condition.operand, resolve, negated=not negated)
        case And() | Or():
            parts = tuple(normal_form(part, resolve, negated=negated) for part in condition.operands)
            joined = Every if isinstance(condition, And) != negated else Some
            return _flat(joined, parts)


def _flat(joined: type[Every] | type[Some], parts: tuple[Form, ...]) -> Form:
    flat: list[Form] = []
    for part in parts:
        flat.extend(part.parts if isinstance(part, joined) else (part,))
    return joined(tuple(flat))


def signals_of(form: Form) -> frozenset[Signal]:
    """Every signal that the form reads."""
    if isinstance(form, Within):
        return frozenset({form.signal})
    return frozenset().union(*(signals_of(part) for part in form.parts))


def negation(form: Form) -> Form:
    """The form that is false where ``form`` is true, true where it is false, and unknown where it is."""
    if isinstance(form, Within):
        return Within(form.signal, form.region.complement())
    joined = Some if isinstance(form, Every) else Every
    return joined(tuple(negation(part) for part in form.parts))


def merged(form: Form) -> Form:
    """``form`` with the regions of one signal under one AND or OR made one; its truth stays the same."""
    if isinstance(form, Within):
        return form
    regions: dict[Signal, list[Region]] = {}
    nested: list[Form] = []
    for part in map(merged, form.parts):
        if isinstance(part, Within):
            regions.setdefault(part.signal, []).append(part.region)
        else:
            nested.append(part)
    join = Region.intersection_of if isinstance(form, Every) else Region.union_of
    parts = (*(Within(signal, join(alike)) for signal, alike in regions.items()), *nested)
    return parts[0] if len(parts) == 1 else type(form)(parts)


def holds(form: Form, values: Mapping[Signal, float]) -> bool:
    """Whether ``form`` holds where every signal that it reads has the value in ``values``."""
    if isinstance(form, Within):
        return form.region.contains(values[form.signal])
    results = (holds(part, values) for part in form.parts)
    return all(results) if isinstance(form, Every) else any(results)
