# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which conditions hold, for a status."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice

from smarttestudo.domain.signal import Signal, Truth, Value, shown_value
from smarttestudo.domain.status import BlockStatus, CheckStatus, TimeStatus
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.normal_form import AnyElement
from smarttestudo.language.properties.field_path import ANY
from smarttestudo.language.rule_set import RuleBlock, RuleSet, WrittenCheck, WrittenTime
from smarttestudo.language.syntax import TimeWord
from smarttestudo.loop.knowledge.knowledge import Knowledge


class BlockStates:
    """The first blocks as their files have them, with what each check reads at ``now_ns``, a steady time.

    All is read when this is made, so what is iterated later is of one moment. States are those of the last
    step: take first what time alone has changed by then. ``most`` bounds the blocks, and eight times as many
    their checks and times; ``left_out`` is how many blocks there are beyond. ``None`` bounds nothing.
    """

    def __init__(self, knowledge: Knowledge, now_ns: int, most: int | None = None) -> None:
        written = knowledge.rule_set.written
        blocks = written if most is None else tuple(_first(written, most))
        self.left_out = len(written) - len(blocks)
        evaluator = knowledge.evaluator
        self._now_ns = now_ns
        self._blocks = [
            (block, evaluator.truth(block.order), evaluator.changed_ns(block.order)) for block in blocks
        ]
        topics = {check.signal.topic for block in blocks for check in block.checks}
        self._values = {
            signal: value for topic in topics for signal, value in knowledge.readings(topic, now_ns)
        }
        self._latched = {
            check.latch: evaluator.latched(check.latch)
            for block in blocks
            for check in block.checks
            if check.latch is not None
        }
        self._times = {
            (time.held, time.duration_ns): evaluator.window(time.held, time.duration_ns, now_ns)
            for block in blocks
            for time in block.times
        }

    def __iter__(self) -> Iterator[BlockStatus]:
        for block, state, changed_ns in self._blocks:
            yield BlockStatus(
                file=block.file,
                line=block.line,
                column=block.column,
                state=state,
                checks=tuple(map(self._check, block.checks)),
                held_s=(self._now_ns - changed_ns) / NS_PER_S,
                times=tuple(map(self._time, block.times)),
            )

    def _time(self, time: WrittenTime) -> TimeStatus:
        is_long, held_ns = self._times[time.held, time.duration_ns]
        state = is_long if time.word is TimeWord.FOR else Truth(Truth.TRUE.value - is_long.value)
        held_s = None if held_ns is None else held_ns / NS_PER_S
        return TimeStatus(line=time.line, column=time.column, state=state, held_s=held_s)

    def _check(self, check: WrittenCheck) -> CheckStatus:
        """The state of a check, of its value: on some checks no condition depends."""
        values, state = self._values[check.signal], Truth.UNKNOWN
        if check.latch is not None:
            state = self._latched[check.latch]
        elif values is not None:
            state = Truth.TRUE if check.holds_for(values) else Truth.FALSE
        value = shown_value(values, check.holds_for)
        return CheckStatus(line=check.line, column=check.column, state=state, value=value)


_REMEMBERED = {Truth.TRUE: 1.0, Truth.FALSE: 0.0, Truth.UNKNOWN: None}


def values_in(states: Iterable[BlockStatus], rule_set: RuleSet) -> dict[Signal, Value | None]:
    """The values that the conditions of ``rule_set`` read by what ``states`` say, what is derived included.

    Signals of blocks that are not in ``states`` are missing.
    """
    by_place = {(one.file, one.line, one.column): one for one in states}
    values: dict[Signal, Value | None] = {}
    for block in rule_set.written:
        state = by_place.get((block.file, block.line, block.column))
        if state is None:
            continue
        checks = {(one.line, one.column): one for one in state.checks}
        times = {(one.line, one.column): one for one in state.times}
        for check in block.checks:
            read = checks.get((check.line, check.column))
            if read is not None:
                values[check.signal] = read.value
                if check.latch is not None:
                    values[Signal(*check.latch)] = _REMEMBERED[read.state]
                elif ANY in check.signal.property:
                    of_any = AnyElement(check.signal, check.region)
                    values[Signal(*of_any)] = _REMEMBERED[read.state]
        for time in block.times:
            lasted = times.get((time.line, time.column))
            if lasted is not None:
                values[Signal(*time.held)] = lasted.held_s
    return values


_PARTS_PER_BLOCK = 8


def _first(written: Iterable[RuleBlock], most: int) -> Iterator[RuleBlock]:
    parts = 0
    for block in islice(written, most):
        parts += len(block.checks) + len(block.times)
        if parts > most * _PARTS_PER_BLOCK:
            return
        yield block
