# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A second opinion on conditions with time: the definition, looked up in the whole history at every instant.

Times are few whole nanoseconds, so that every instant at which something can change is one of the samples.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from random import Random
from typing import NamedTuple

from language.evaluator.naive_rules import COMPARISONS
from language.evaluator.random_rules import SPAN, check
from smarttestudo.domain.signal import Signal
from smarttestudo.language.syntax import (
    And,
    Check,
    Condition,
    Duration,
    DurationUnit,
    Group,
    Not,
    Operator,
    Or,
    Timed,
    TimeWord,
    Until,
)

NS_PER_MS = 1_000_000
MAX_DURATION_NS = 6


class Sample(NamedTuple):
    """All values from ``t_ns`` on; a sample at the time of the next one lasts no time."""

    t_ns: int
    values: Mapping[Signal, float | None]


def truths(condition: Condition, history: Sequence[Sample]) -> list[bool | None]:
    """What the condition is at each sample; ``None`` is unknown. The first sample is the start."""
    match condition:
        case Check():
            return list(_check_truths(condition, history))
        case Group():
            return truths(condition.operand, history)
        case Not():
            return [None if one is None else not one for one in truths(condition.operand, history)]
        case And():
            return [_all(parts) for parts in _columns(condition.operands, history)]
        case Or():
            return [_any(parts) for parts in _columns(condition.operands, history)]
        case Timed():
            over = _all if condition.word is TimeWord.FOR else _any
            inner, ns = truths(condition.operand, history), condition.duration.ns
            return [over(_during(inner, history, index, ns)) for index in range(len(history))]


def _columns(parts: Sequence[Condition], history: Sequence[Sample]) -> Iterator[tuple[bool | None, ...]]:
    return zip(*(truths(part, history) for part in parts), strict=True)


def _all(parts: Sequence[bool | None]) -> bool | None:
    return False if False in parts else None if None in parts else True


def _any(parts: Sequence[bool | None]) -> bool | None:
    return True if True in parts else None if None in parts else False


def _during(
    inner: Sequence[bool | None], history: Sequence[Sample], index: int, ns: int
) -> list[bool | None]:
    """What ``inner`` was at the instants of the last ``ns`` before a sample, and at it."""
    since_ns = history[index].t_ns - ns
    found = [inner[index]]
    if history[0].t_ns > since_ns:
        found.append(None)  # Before the start everything is unknown.
    for before in reversed(range(index)):
        if history[before + 1].t_ns <= since_ns:
            break
        found.append(inner[before])
    return found


def _check_truths(one: Check, history: Sequence[Sample]) -> Iterator[bool | None]:
    signal = Signal(one.topic.text, one.property)
    assert isinstance(one.value, float)
    seen: bool | None = None
    for sample in history:
        value = sample.values[signal]
        if value is None:
            yield None
            continue
        is_true = COMPARISONS[one.operator](value, one.value)
        if one.until is None:
            yield is_true
            continue
        assert isinstance(one.until.value, float)
        if COMPARISONS[one.until.operator](value, one.until.value):
            seen = False
        elif is_true:
            seen = True
        yield seen


def random_condition(
    random: Random, signals: Sequence[Signal], borders: Sequence[float], depth: int = 4
) -> Condition:
    """A condition with time, nested at most ``depth`` deep."""
    kind = random.choice(("check", "until", "timed", "timed", "timed", "not", "and", "or")) if depth else ""
    inner = depth - 1
    match kind:
        case "timed":
            return Timed(
                operand=random_condition(random, signals, borders, inner),
                word=random.choice(list(TimeWord)),
                duration=duration(random.randint(0, MAX_DURATION_NS)),
                span=SPAN,
            )
        case "not":
            return Not(operand=random_condition(random, signals, borders, inner), span=SPAN)
        case "and" | "or":
            several = random.randint(2, 3)
            operands = tuple(random_condition(random, signals, borders, inner) for _ in range(several))
            joined = And if kind == "and" else Or
            return joined(operands=operands, span=SPAN)
        case _:
            return _random_check(random, signals, borders, has_end=kind == "until")


def _random_check(
    random: Random, signals: Sequence[Signal], borders: Sequence[float], *, has_end: bool
) -> Check:
    plain = check(random.choice(signals), random.choice(list(Operator)), random.choice(borders))
    if not has_end:
        return plain
    value = random.choice(borders)
    until = Until(operator=random.choice(list(Operator)), value=value, text=str(value), span=SPAN)
    return Check(
        topic=plain.topic,
        property=plain.property,
        property_span=SPAN,
        operator=plain.operator,
        value=plain.value,
        text=plain.text,
        span=SPAN,
        until=until,
    )


def duration(ns: int) -> Duration:
    return Duration(text=f"{ns / NS_PER_MS:.6f}", unit=DurationUnit.MILLISECONDS, ns=ns, span=SPAN)
