# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Conditions as AND/OR trees over regions of signals, with every Not pushed into the checks.

What a condition asks of the time before is a signal of its own, derived from others: how long a condition
has held (``HeldTime``), and which of two regions a value was in last (``LastSeen``). So is whether any
element of an array lies in a region (``AnyElement``), which no region of one value says.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from smarttestudo.domain.names import is_source
from smarttestudo.domain.signal import Signal, SignalKind, Value
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.formatter import number_text, value_text
from smarttestudo.language.known_types import NO_TYPES, KnownTypes
from smarttestudo.language.properties.field_path import ANY
from smarttestudo.language.region import Bound, Region
from smarttestudo.language.syntax import (
    And,
    Check,
    Compared,
    Condition,
    Constant,
    Group,
    Margin,
    Not,
    Operator,
    Or,
    Timed,
    TimeWord,
)
from smarttestudo.language.text_region import SetOfValues, TextRegion, common, intersection_of, union_of


@dataclass(frozen=True, slots=True)
class InRegion:
    """True while the signal's value lies in the region, unknown while the signal is unknown."""

    signal: Signal
    region: SetOfValues


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
ANY_ELEMENT = "any_element"


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
    on: SetOfValues
    off: SetOfValues

    def __new__(cls, source: Signal, on: SetOfValues, off: SetOfValues) -> LastSeen:
        """The signal of ``source`` between two regions."""
        signal = super().__new__(cls, f"{source} {region_text(on)} Until {region_text(off)}", LAST_SEEN)
        signal.source, signal.on, signal.off = source, on, off
        return signal

    def __getnewargs__(self) -> tuple[Signal, SetOfValues, SetOfValues]:
        """The arguments that it is made from, for copies."""
        return self.source, self.on, self.off


class AnyElement(Signal):
    """1 where any of the values of ``source``, a property with ``[*]``, lies in ``region``, else 0."""

    source: Signal
    region: SetOfValues

    def __new__(cls, source: Signal, region: SetOfValues) -> AnyElement:
        """The signal of ``source`` and a region."""
        signal = super().__new__(cls, f"{source} {region_text(region)}", ANY_ELEMENT)
        signal.source, signal.region = source, region
        return signal

    def __getnewargs__(self) -> tuple[Signal, SetOfValues]:
        """The arguments that it is made from, for copies."""
        return self.source, self.region


def is_derived(signal: Signal) -> bool:
    """Whether ``signal`` is computed from others; the name of a topic has no blank."""
    return " " in signal.topic


def derived_values(signal: Signal) -> Region:
    """The values that a derived signal can have."""
    if signal.property == HELD:
        return Region.between(0.0, None)
    return Region.union_of(Region.where(Operator.EQUAL, value) for value in (0.0, 1.0))


def normal_form(
    condition: Condition, resolve: Resolve, types: KnownTypes = NO_TYPES, *, negated: bool = False
) -> Form:
    """``condition`` (or its negation) without Not, nested alike parts joined.

    De Morgan's laws and ``not (x > 3) == x <= 3`` hold in Kleene's logic, so truth stays the same for every
    state, unknown included; ``C Within d`` is ``Not (Not C For d)``. ``resolve`` gives the full name of a
    topic, ``types`` the constants of its type.
    """
    match condition:
        case Check():
            within = read_check(condition, resolve, types).form
            return InRegion(within.signal, within.region.complement()) if negated else within
        case Group():
            return normal_form(condition.operand, resolve, types, negated=negated)
        case Not():
            return normal_form(condition.operand, resolve, types, negated=not negated)
        case Timed():
            is_for = condition.word is TimeWord.FOR
            held = held_time(condition, resolve, types)
            enough = Region.where(Operator.GREATER_EQUAL, condition.duration.ns / NS_PER_S)
            return InRegion(held, enough if is_for != negated else enough.complement())
        case And() | Or():
            parts = tuple(normal_form(part, resolve, types, negated=negated) for part in condition.operands)
            joined = Every if isinstance(condition, And) != negated else Some
            return _flat(joined, parts)


def held_time(condition: Timed, resolve: Resolve, types: KnownTypes = NO_TYPES) -> HeldTime:
    """For how long what a ``For`` is about has held; of a ``Within``, for how long it has not."""
    negated = condition.word is TimeWord.WITHIN
    return HeldTime(normal_form(condition.operand, resolve, types, negated=negated))


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadCheck:
    """A check with full names: alone it is true where ``signal`` lies in ``region``.

    ``latch`` is the memory of one with an ``Until``, whose comparison counts where both are true. Of a check
    with ``[*]``, ``signal`` has the values of all elements, and one in the region is enough.
    """

    signal: Signal
    region: SetOfValues
    latch: LastSeen | None = None

    @property
    def form(self) -> InRegion:
        """Where the check holds."""
        derived: Signal | None = self.latch
        if ANY in self.signal.property:
            derived = AnyElement(self.signal, self.region)
        if derived is None:
            return InRegion(self.signal, self.region)
        return InRegion(derived, Region.where(Operator.GREATER_EQUAL, 1.0))


def read_check(check: Check, resolve: Resolve, types: KnownTypes = NO_TYPES) -> ReadCheck:
    """The meaning of ``check``; what it compares with says how its property is read."""
    name = check.topic.text
    topic = name if is_source(name) else resolve(name)
    kind, value = _compared(check.value, topic, check.property, types)
    if check.until is None:
        return ReadCheck(
            signal=Signal(topic, _read_property(check, kind), kind), region=_region(check.operator, value)
        )
    other, end = _compared(check.until.value, topic, check.property, types)
    if SignalKind.UNRESOLVED in (kind, other) or isinstance(value, str) != isinstance(end, str):
        kind, value, end = SignalKind.UNRESOLVED, 0.0, 1.0
    signal = Signal(topic, _read_property(check, kind), kind)
    region, off = _region(check.operator, value), _region(check.until.operator, end)
    return ReadCheck(
        signal=signal, region=region, latch=LastSeen(signal, common(region, off.complement()), off)
    )


def margin_signal(margin: Margin, resolve: Resolve) -> Signal:
    """The signal that a rate goes by."""
    name = margin.topic.text
    return Signal(name if is_source(name) else resolve(name), margin.property)


def _compared(value: Compared, topic: str, path: str, types: KnownTypes) -> tuple[SignalKind, Value]:
    if isinstance(value, bool):
        return SignalKind.STATE, float(value)
    if isinstance(value, Constant):
        known = types.constant(topic, path, value)
        if known is None:
            return SignalKind.UNRESOLVED, 0.0
        return (SignalKind.TEXT if isinstance(known, str) else SignalKind.STATE), known
    return (SignalKind.TEXT if isinstance(value, str) else SignalKind.NUMBER), value


def _read_property(check: Check, kind: SignalKind) -> str:
    """The property; with an unresolved constant its name, too: nothing is known of two of them."""
    return f"{check.property} {check.value}" if kind is SignalKind.UNRESOLVED else check.property


def _region(operator: Operator, value: Value) -> SetOfValues:
    return TextRegion.where(operator, value) if isinstance(value, str) else Region.where(operator, value)


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
        elif isinstance(part.signal, AnyElement):
            pending.append(InRegion(part.signal.source, part.signal.region))
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
    if isinstance(signal, AnyElement):
        return plain
    if isinstance(signal, HeldTime):
        is_for = not form.region.contains(-1.0)
        now = over_states(signal.form)
        return _flat(Every, (now, plain)) if is_for else _flat(Some, (negation(now), plain))
    if isinstance(signal, LastSeen):
        is_on = form.region.contains(1.0)
        if signal.on.is_empty:
            return InRegion(signal.source, signal.on if is_on else signal.on.complement())
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
    regions: dict[Signal, list[SetOfValues]] = {}
    nested: list[Form] = []
    for part in map(merged, form.parts):
        if isinstance(part, InRegion):
            regions.setdefault(part.signal, []).append(part.region)
        else:
            nested.append(part)
    join = intersection_of if isinstance(form, Every) else union_of
    parts = (*(InRegion(signal, join(alike)) for signal, alike in regions.items()), *nested)
    return parts[0] if len(parts) == 1 else type(form)(parts)


def holds(form: Form, values: Mapping[Signal, Value]) -> bool:
    """Whether ``form`` holds where every signal that it reads has the value in ``values``."""
    if isinstance(form, InRegion):
        return form.region.contains(values[form.signal])  # type: ignore[arg-type]  # of one sort
    results = (holds(part, values) for part in form.parts)
    return all(results) if isinstance(form, Every) else any(results)


def form_text(form: Form) -> str:
    """``form`` for reading, a text of its own for each."""
    if not isinstance(form, InRegion):
        word = " AND " if isinstance(form, Every) else " OR "
        return f"({word.join(map(form_text, form.parts))})"
    if isinstance(form.signal, HeldTime):
        is_for = not form.region.contains(-1.0)
        cut_s = _cuts(form.region)[0][0]
        return f"({'' if is_for else 'Not '}{form.signal.topic} For {number_text(cut_s)} s)"
    if isinstance(form.signal, LastSeen | AnyElement):
        return f"({'' if form.region.contains(1.0) else 'Not '}{form.signal.topic})"
    return f"{form.signal} {region_text(form.region)}"


def _cuts(region: SetOfValues) -> Sequence[Bound]:
    return region.cuts if isinstance(region, Region) else ()


def region_text(region: SetOfValues) -> str:
    """``< 3`` where one comparison says it, else the ends of its intervals, or its texts."""
    comparison = region.comparison
    if comparison is not None:
        operator, value = comparison
        return f"{operator.value} {value_text(value)}"
    if isinstance(region, TextRegion):
        return f"{'not ' * region.is_inverse}in {' '.join(map(value_text, sorted(region.texts)))}"
    opening, closing = {-1: "[", 1: "("}, {-1: ")", 1: "]"}
    intervals = (
        f"{opening[low[1]]}{number_text(low[0])}, {number_text(high[0])}{closing[high[1]]}"
        for low, high in region.pieces
    )
    return f"in {' '.join(intervals)}"
