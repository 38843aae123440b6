# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Conditions as AND/OR trees over regions of signals, with every Not pushed into the checks.

What a condition asks of the time before is a signal of its own, derived from others: how long a condition
has held (``HeldTime``), and which of two regions a value was in last (``LastSeen``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from smarttestudo.domain.signal import Signal
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.formatter import number_text
from smarttestudo.language.region import Region
from smarttestudo.language.syntax import (
    And,
    Check,
    Condition,
    Group,
    Not,
    Operator,
    Or,
    Timed,
    TimeWord,
    Until,
)


@dataclass(frozen=True, slots=True)
class InRegion:
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


Form = InRegion | Every | Some
Resolve = Callable[[str], str]

HELD = "held_s"
LAST_SEEN = "last_seen"


class HeldTime(Signal):
    """For how many seconds ``form`` has held without a break; its text names it.

    Of two forms with one text, either stands for both.
    """

    form: Form

    def __new__(cls, form: Form) -> HeldTime:
        """The signal of ``form``."""
        signal = super().__new__(cls, form_text(form), HELD)
        signal.form = form
        return signal

    def __getnewargs__(self) -> tuple[Form]:
        """The arguments that it is made from, for copies."""
        return (self.form,)


class LastSeen(Signal):
    """1 where ``source`` was in ``on`` more recently than in ``off``, 0 the other way round.

    The two regions have no number in common.
    """

    source: Signal
    on: Region
    off: Region

    def __new__(cls, source: Signal, on: Region, off: Region) -> LastSeen:
        """The signal of ``source`` between two regions."""
        signal = super().__new__(cls, f"{source} {region_text(on)} Until {region_text(off)}", LAST_SEEN)
        signal.source, signal.on, signal.off = source, on, off
        return signal

    def __getnewargs__(self) -> tuple[Signal, Region, Region]:
        """The arguments that it is made from, for copies."""
        return self.source, self.on, self.off


def is_derived(signal: Signal) -> bool:
    """Whether ``signal`` stands for the past of others; the name of a topic has no blank."""
    return " " in signal.topic


def derived_values(signal: Signal) -> Region:
    """The values that a derived signal can have."""
    if signal.property == HELD:
        return Region.between(0.0, None)
    return Region.union_of(Region.where(Operator.EQUAL, value) for value in (0.0, 1.0))


def normal_form(condition: Condition, resolve: Resolve, *, negated: bool = False) -> Form:
    """``condition`` (or its negation) without Not, nested alike parts joined.

    De Morgan's laws and ``not (x > 3) == x <= 3`` hold in Kleene's logic, so truth stays the same for every
    state, unknown included; ``C Within d`` is ``Not (Not C For d)``. ``resolve`` gives the full name of a
    topic.
    """
    match condition:
        case Check():
            within = _check_form(condition, signal_of(condition, resolve))
            return InRegion(within.signal, within.region.complement()) if negated else within
        case Group():
            return normal_form(condition.operand, resolve, negated=negated)
        case Not():
            return normal_form(condition.operand, resolve, negated=not negated)
        case Timed():
            is_for = condition.word is TimeWord.FOR
            held = held_time(condition, resolve)
            enough = Region.where(Operator.GREATER_EQUAL, condition.duration.ns / NS_PER_S)
            return InRegion(held, enough if is_for != negated else enough.complement())
        case And() | Or():
            parts = tuple(normal_form(part, resolve, negated=negated) for part in condition.operands)
            joined = Every if isinstance(condition, And) != negated else Some
            return _flat(joined, parts)


def held_time(condition: Timed, resolve: Resolve) -> HeldTime:
    """For how long what a ``For`` is about has held; of a ``Within``, for how long it has not."""
    negated = condition.word is TimeWord.WITHIN
    return HeldTime(normal_form(condition.operand, resolve, negated=negated))


def signal_of(check: Check, resolve: Resolve) -> Signal:
    """The signal that ``check`` reads."""
    return Signal(resolve(check.topic.text), check.property)


def compared_region(comparison: Check | Until) -> Region:
    """The values for which a comparison alone is true."""
    return Region.where(comparison.operator, comparison.value)


def latch_of(signal: Signal, region: Region, until: Until | None) -> LastSeen | None:
    """Memory of a check of ``signal`` with an ``Until``, whose comparison counts where both are true."""
    if until is None:
        return None
    off = compared_region(until)
    return LastSeen(signal, region.intersection(off.complement()), off)


def _check_form(check: Check, signal: Signal) -> InRegion:
    """Where ``check`` of ``signal`` holds."""
    region = compared_region(check)
    latch = latch_of(signal, region, check.until)
    if latch is None:
        return InRegion(signal, region)
    return InRegion(latch, Region.where(Operator.GREATER_EQUAL, 1.0))


def _flat(joined: type[Every] | type[Some], parts: tuple[Form, ...]) -> Form:
    flat: list[Form] = []
    for part in parts:
        flat.extend(part.parts if isinstance(part, joined) else (part,))
    return joined(tuple(flat))


def reads(form: Form) -> Iterator[InRegion]:
    """Every region of a signal that messages give, also where ``form`` asks for its past."""
    pending = [form]
    while pending:
        part = pending.pop()
        if not isinstance(part, InRegion):
            pending.extend(reversed(part.parts))
        elif isinstance(part.signal, HeldTime):
            pending.append(part.signal.form)
        elif isinstance(part.signal, LastSeen):
            pending.extend(
                InRegion(part.signal.source, region) for region in (part.signal.off, part.signal.on)
            )
        else:
            yield part


def signals_of(form: Form) -> frozenset[Signal]:
    """Every signal of a message that the form reads."""
    return frozenset(within.signal for within in reads(form))


def over_states(form: Form) -> Form:
    """``form`` where derived signals are signals like any other, with what binds them to values of now.

    It holds in at least the states in which ``form`` can hold, and with all pasts of a state only where
    ``form`` must: ``C For d`` only where C does, ``C Within d`` wherever C does, an ``Until`` on one side of
    its thresholds always, on the other never.
    """
    if not isinstance(form, InRegion):
        return _flat(type(form), tuple(map(over_states, form.parts)))
    signal, plain = form.signal, InRegion(Signal(*form.signal), form.region)
    if isinstance(signal, HeldTime):
        is_for = not form.region.contains(-1.0)
        now = over_states(signal.form)
        return _flat(Every, (now, plain)) if is_for else _flat(Some, (negation(now), plain))
    if isinstance(signal, LastSeen):
        is_on = form.region.contains(1.0)
        if signal.on.is_empty:
            return InRegion(signal.source, Region.nothing() if is_on else Region.everything())
        sure, never = (signal.on, signal.off) if is_on else (signal.off, signal.on)
        between = InRegion(signal.source, never.complement())
        return Some((InRegion(signal.source, sure), Every((between, plain))))
    return form


def negation(form: Form) -> Form:
    """The form that is false where ``form`` is true, true where it is false, and unknown where it is."""
    if isinstance(form, InRegion):
        return InRegion(form.signal, form.region.complement())
    joined = Some if isinstance(form, Every) else Every
    return joined(tuple(negation(part) for part in form.parts))


def merged(form: Form) -> Form:
    """``form`` with the regions of one signal under one AND or OR made one; its truth stays the same."""
    if isinstance(form, InRegion):
        return form
    regions: dict[Signal, list[Region]] = {}
    nested: list[Form] = []
    for part in map(merged, form.parts):
        if isinstance(part, InRegion):
            regions.setdefault(part.signal, []).append(part.region)
        else:
            nested.append(part)
    join = Region.intersection_of if isinstance(form, Every) else Region.union_of
    parts = (*(InRegion(signal, join(alike)) for signal, alike in regions.items()), *nested)
    return parts[0] if len(parts) == 1 else type(form)(parts)


def holds(form: Form, values: Mapping[Signal, float]) -> bool:
    """Whether ``form`` holds where every signal that it reads has the value in ``values``."""
    if isinstance(form, InRegion):
        return form.region.contains(values[form.signal])
    results = (holds(part, values) for part in form.parts)
    return all(results) if isinstance(form, Every) else any(results)


def form_text(form: Form) -> str:
    """``form`` for reading, a text of its own for each."""
    if not isinstance(form, InRegion):
        word = " AND " if isinstance(form, Every) else " OR "
        return f"({word.join(map(form_text, form.parts))})"
    if isinstance(form.signal, HeldTime):
        is_for = not form.region.contains(-1.0)
        cut_s = form.region.cuts[0][0]
        return f"({'' if is_for else 'Not '}{form.signal.topic} For {number_text(cut_s)} s)"
    if isinstance(form.signal, LastSeen):
        return f"({'' if form.region.contains(1.0) else 'Not '}{form.signal.topic})"
    return f"{form.signal} {region_text(form.region)}"


def region_text(region: Region) -> str:
    """``< 3`` where one comparison says it, else the ends of its intervals."""
    comparison = region.comparison
    if comparison is not None:
        operator, value = comparison
        return f"{operator.value} {number_text(value)}"
    opening, closing = {-1: "[", 1: "("}, {-1: ")", 1: "]"}
    intervals = (
        f"{opening[low[1]]}{number_text(low[0])}, {number_text(high[0])}{closing[high[1]]}"
        for low, high in region.pieces
    )
    return f"in {' '.join(intervals)}"
