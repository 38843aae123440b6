# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Differences between two rule files for a robot, in words; none where only the layout differs."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence

from smarttestudo.domain.rate import Tier
from smarttestudo.editing.document import condition_meaning, meaning
from smarttestudo.language.formatter import margin_text, number_text
from smarttestudo.language.parser import ParseResult
from smarttestudo.language.syntax import (
    Action,
    Block,
    KeepAtLeast,
    KeepWithin,
    RateExpression,
    SetFrequency,
)
from smarttestudo.language.syntax_walks import (
    bounds_in,
    records_in,
    sets_in,
)

_Rates = Mapping[str, str]


def differences(old: ParseResult, new: ParseResult) -> tuple[str, ...]:
    """Sentences such as ``Corridor: /scan 4 → 6 Hz``, defaults first, then rules in the new file's order."""
    return tuple(_differences(old, new))


def mean_the_same(old: ParseResult, new: ParseResult) -> bool:
    """Whether both mean the same to a robot, except for the lines of rules.

    Neither the order of blocks nor comments, layout and spellings matter.
    """
    return _meaning(old) == _meaning(new)


def differing_blocks(old: ParseResult, new: ParseResult) -> tuple[int, ...]:
    """The blocks of ``new``, counted from 0, that ``old`` does not have with the same meaning."""
    left = Counter(meaning(one) for one in old.file.statements if isinstance(one, Block))
    differing = []
    for number, block in enumerate(one for one in new.file.statements if isinstance(one, Block)):
        if left[meaning(block)] == 0:
            differing.append(number)
        left[meaning(block)] -= 1
    return tuple(differing)


def _meaning(result: ParseResult) -> object:
    statements = result.file.statements
    defaults = {one.topic.text: meaning(one) for one in statements if isinstance(one, SetFrequency)}
    blocks = Counter(meaning(one) for one in statements if isinstance(one, Block))
    return result.is_valid, defaults, _floors_hz(result), _always_bounds(result), blocks


def _differences(old: ParseResult, new: ParseResult) -> Iterator[str]:
    yield from _rates("default", _defaults(old), _defaults(new))
    yield from _rates("floor", _floors(old), _floors(new))
    yield from _rates("bound", _always_bounds(old), _always_bounds(new))
    before, after = _blocks(old), _blocks(new)
    yield from (f"{name}: removed" for name in before if name not in after)
    for name, block in after.items():
        if name in before:
            yield from _block(name, before[name], block)
        else:
            yield f"{name}: added, switched off" if block.is_disabled else f"{name}: added"


def _defaults(result: ParseResult) -> _Rates:
    statements = (one for one in result.file.statements if isinstance(one, SetFrequency))
    return {one.topic.text: _set_text(one) for one in statements}


def _floors(result: ParseResult) -> _Rates:
    return {topic: f"{number_text(hz)} Hz" for topic, hz in _floors_hz(result).items()}


def _floors_hz(result: ParseResult) -> Mapping[str, float]:
    """The highest floor of each topic, which is the one that counts."""
    floors_hz: dict[str, float] = {}
    for one in result.file.statements:
        if isinstance(one, KeepAtLeast) and isinstance(one.rate.value, int | float):
            floors_hz[one.topic.text] = max(one.rate.value, floors_hz.get(one.topic.text, 0.0))
    return floors_hz


def _always_bounds(result: ParseResult) -> _Rates:
    return _bounds(one for one in result.file.statements if isinstance(one, KeepWithin))


def _bounds(statements: Iterable[KeepWithin]) -> _Rates:
    """The bounds that count, by topic and property: the tightest number and the highest level."""
    numbers: dict[str, float] = {}
    levels: dict[str, Tier] = {}
    names: list[str] = []
    for one in statements:
        names.append(name := _bound(one))
        if isinstance(one.bound, Tier):
            levels[name] = max(one.bound, levels.get(name, one.bound), key=lambda tier: tier.level)
        else:
            numbers[name] = min(one.bound, numbers.get(name, math.inf))
    return {name: " and ".join(_bound_texts(numbers.get(name), levels.get(name))) for name in names}


def _bound_texts(number: float | None, level: Tier | None) -> Iterator[str]:
    if number is not None:
        yield number_text(number)
    if level is not None:
        yield level.value


def _blocks(result: ParseResult) -> dict[str, Block]:
    """Blocks by what they are called; of several with one name, the later ones are numbered."""
    blocks: dict[str, Block] = {}
    unnamed = 0
    for statement in result.file.statements:
        if not isinstance(statement, Block):
            continue
        name, number = statement.label, 1
        if statement.is_unnamed:
            # A line number moves with the layout, the place among such blocks does not.
            unnamed += 1
            name = f"unnamed rule {unnamed}"
        while (key := name if number == 1 else f"{name} ({number})") in blocks:
            number += 1
        blocks[key] = statement
    return blocks


def _block(name: str, old: Block, new: Block) -> Iterator[str]:
    if old.is_disabled != new.is_disabled:
        yield f"{name}: switched off" if new.is_disabled else f"{name}: switched on"
    if condition_meaning(old.condition) != condition_meaning(new.condition):
        yield f"{name}: another condition"
    if (old.priority or 0) != (new.priority or 0):
        yield f"{name}: Priority {old.priority or 0} → {new.priority or 0}"
    yield from _rates(name, _branch(old.then), _branch(new.then))
    yield from _recordings(name, old.then, new.then)
    yield from _rates(f"{name}, Else", _branch(old.otherwise), _branch(new.otherwise))
    yield from _recordings(f"{name}, Else", old.otherwise, new.otherwise)


def _branch(actions: Sequence[Action]) -> _Rates:
    """The rates by topic, and the bounds by topic and property."""
    rates = {one.topic.text: _set_text(one) for one in sets_in(actions)}
    return {**rates, **_bounds(bounds_in(actions))}


def _bound(one: KeepWithin) -> str:
    return f"{one.topic.text} {one.property} within"


def _recordings(name: str, old: Sequence[Action], new: Sequence[Action]) -> Iterator[str]:
    before, after = {meaning(one) for one in records_in(old)}, {meaning(one) for one in records_in(new)}
    yield from (
        f'{name}: Record "{one.name}" removed' for one in records_in(old) if meaning(one) not in after
    )
    yield from (f'{name}: Record "{one.name}" added' for one in records_in(new) if meaning(one) not in before)


def _rates(name: str, old: _Rates, new: _Rates) -> Iterator[str]:
    for topic in dict.fromkeys([*old, *new]):
        before, after = old.get(topic), new.get(topic)
        if before != after:
            yield f"{name}: {topic} {_change(before, after)}"


def _change(before: str | None, after: str | None) -> str:
    if before is None or after is None:
        return f"{after}, new" if before is None else f"{before}, removed"
    if before.endswith(" Hz") and after.endswith(" Hz"):
        before = before.removesuffix(" Hz")
    return f"{before} → {after}"


def _set_text(statement: SetFrequency) -> str:
    margin = statement.margin
    return f"{_text(statement.rate)}{'' if margin is None else f' {margin_text(margin)}'}"


def _text(rate: RateExpression) -> str:
    value = rate.value
    if isinstance(value, int | float):
        return f"{number_text(value)} Hz"
    return value.value if isinstance(value, Tier) else str(value.value)
