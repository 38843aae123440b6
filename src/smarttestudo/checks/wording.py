# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How findings name blocks, places, states and numbers, and fixes that several lint rules offer."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from smarttestudo.domain.finding import Fix, Span
from smarttestudo.domain.signal import Signal, Value
from smarttestudo.language.formatter import value_text
from smarttestudo.language.normal_form import HELD, is_derived
from smarttestudo.language.resolved_rules import Branch
from smarttestudo.language.syntax import Block, Collection, RuleFile, TopicName

_LISTED = 5
_SIGNALS_SHOWN = 8


def state(values: Mapping[Signal, Value]) -> str:
    """``/odom pose_x = 3, pose_y = 2, /battery_state level = 10``; empty for no or too many signals.

    What was before stands behind what is.
    """
    if len(values) > _SIGNALS_SHOWN:
        return ""
    parts: list[str] = []
    topic = ""
    past = [_past(signal, value) for signal, value in values.items() if is_derived(signal)]
    for signal, value in values.items():
        if not is_derived(signal):
            name = signal.property if signal.topic == topic else str(signal)
            topic = signal.topic
            parts.append(f"{name} = {value_text(value)}")
    return ", ".join([*parts, *past])


def _past(signal: Signal, value: Value) -> str:
    """The value of a past: ``/odom speed < 1 for 5 s``."""
    if signal.property == HELD:
        return f"{signal.topic} for {value_text(value)} s"
    return f"{signal.topic} {'holds' if value else 'has ended'}"


def listed(names: Sequence[str]) -> str:
    """``a, b and c``, or ``a, b, c, d, e and 7 more``."""
    shown = list(names) if len(names) <= _LISTED + 1 else [*names[:_LISTED], f"{len(names) - _LISTED} more"]
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"


def place(path: str, span: Span, *, seen_from: str) -> str:
    """``line 4``, with the file's name where it is another one than ``seen_from``."""
    return f"line {span.line}" if path == seen_from else f"{path}:{span.line}"


def block_name(block: Block) -> str:
    """A block's label in quotes, or what stands for one."""
    return f"the block at line {block.span.line}" if block.is_unnamed else f'"{block.label}"'


def branch_name(branch: Branch) -> str:
    """A branch of a block: the block's name, for an Else with that word."""
    return (
        f"the Else of {block_name(branch.block.block)}" if branch.is_else else block_name(branch.block.block)
    )


def branch_with_place(branch: Branch, *, seen_from: str) -> str:
    """A branch's name with its line, and the file if it is another one."""
    block = branch.block
    if block.block.is_unnamed and block.path == seen_from:
        return branch_name(branch)
    return f"{branch_name(branch)} ({place(block.path, block.block.span, seen_from=seen_from)})"


def places_in(path: str, branches: Iterable[Branch]) -> tuple[Span, ...]:
    """Where the blocks of ``branches`` stand, as far as they are in the file at ``path``."""
    return tuple(branch.block.block.span for branch in branches if branch.block.path == path)


def sentence(text: str) -> str:
    """``text`` with a capital first letter."""
    return text[:1].upper() + text[1:]


def close_topic(topic: str, known: Iterable[str]) -> str | None:
    """The known topic that is spelt almost like ``topic``; ``None`` where there is none."""
    return next(iter(difflib.get_close_matches(topic, known, n=1, cutoff=0.75)), None)


def write_topic(name: TopicName, topic: str | None) -> Fix | None:
    """A fix that writes ``topic`` in the place of ``name``."""
    return None if topic is None else Fix(span=name.span, replacement=topic, title=f"write {topic}")


class DefaultPlace(NamedTuple):
    """Where a new default belongs: behind statement ``last`` of ``part``, or before its rules."""

    part: Collection
    last: int | None


def default_place(file: RuleFile) -> DefaultPlace | None:
    """The place in the last ``begin … end`` with a default, else in the first one with a rule.

    ``None`` for a file without any statement.
    """
    places = [DefaultPlace(part, _last_default(part)) for part in file.collections if part.statements]
    with_default = (place for place in reversed(places) if place.last is not None)
    return next(with_default, next(iter(places), None))


def new_default(place: DefaultPlace | None, topic: str, rate: str = "Full", says: str = "") -> Fix | None:
    """Write ``SetFrequency topic rate`` at ``place``, if there is one; ``says`` ends the title."""
    if place is None:
        return None
    default = f"SetFrequency {topic} {rate}"
    span, replacement = _insertion(place, default)
    return Fix(span=span, replacement=replacement, title=f"add {default}{says}")


def _last_default(part: Collection) -> int | None:
    """The number of the last statement that is no rule."""
    return max((at for at, one in enumerate(part.statements) if not isinstance(one, Block)), default=None)


def _insertion(place: DefaultPlace, default: str) -> tuple[Span, str]:
    """Where to write and what: a line of its own wherever the text has lines for its statements."""
    part, last = place
    if last is None:
        first = part.statements[0].span
        if first.line > part.span.line:
            return _at(part.span.line + 1, 1), f"{' ' * (first.column - 1)}{default}\n"
        return _at(first.line, first.column), f"{default} "
    before = part.statements[last].span
    behind = part.statements[last + 1 : last + 2]
    next_line = behind[0].span.line if behind else part.span.end_line
    if next_line > before.end_line:
        return _at(before.end_line + 1, 1), f"{' ' * (before.column - 1)}{default}\n"
    return _at(before.end_line, before.end_column), f" {default}"


def _at(line: int, column: int) -> Span:
    return Span(line=line, column=column, end_line=line, end_column=column)
