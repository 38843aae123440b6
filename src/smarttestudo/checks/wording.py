# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How findings name blocks, places, states and numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from smarttestudo.domain.finding import Span
from smarttestudo.domain.signal import Signal
from smarttestudo.language.formatter import duration_text
from smarttestudo.language.normal_form import HELD, is_derived
from smarttestudo.language.resolved_rules import Branch
from smarttestudo.language.syntax import Block, Check, Timed

_LISTED = 5
_SIGNALS_SHOWN = 8


def number(value: float) -> str:
    """``value`` in the fewest digits that mean exactly it."""
    return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)


def check_text(check: Check) -> str:
    """A check without its keyword, as the file writes it."""
    until = "" if check.until is None else f" Until {check.until.operator.value} {check.until.text}"
    return f"{check.topic.text} {check.property} {check.operator.value} {check.text}{until}"


def time_text(timed: Timed) -> str:
    """``For 5 s``, as the file writes it."""
    return f"{timed.word.value} {duration_text(timed.duration)}"


def state(values: Mapping[Signal, float]) -> str:
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
            parts.append(f"{name} = {number(value)}")
    return ", ".join([*parts, *past])


def _past(signal: Signal, value: float) -> str:
    """The value of a past: ``/odom speed < 1 for 5 s``."""
    if signal.property == HELD:
        return f"{signal.topic} for {number(value)} s"
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
    return tuple(one.block.block.span for one in branches if one.block.path == path)


def sentence(text: str) -> str:
    """``text`` with a capital first letter."""
    return text[:1].upper() + text[1:]
