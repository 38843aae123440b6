# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which conditions hold."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from collections.abc import Set as AbstractSet

from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.domain.status import BlockStatus, CheckStatus, TimeStatus
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.rule_set import WrittenBlock, WrittenCheck, WrittenTime
from smarttestudo.language.syntax import TimeWord
from smarttestudo.loop.knowledge.knowledge import Knowledge
from smarttestudo.loop.knowledge.watched_topic import Reading


def analyze(knowledge: Knowledge, readings: Iterable[Reading], now_ns: int) -> AbstractSet[str]:
    """The topics whose request may have changed by ``now_ns``, a steady time; at first all relayed ones."""
    knowledge.evaluator.advance(now_ns)
    for signal, value in readings:
        knowledge.evaluator.set(signal, value)
    return knowledge.evaluator.take_changed_topics()


def block_states(knowledge: Knowledge, now_ns: int) -> tuple[BlockStatus, ...]:
    """The blocks as their files have them, with what each check reads at ``now_ns``, a steady time.

    States are those of the last step: take first what time alone has changed by then.
    """
    written = knowledge.rule_set.written
    if not written:
        return ()
    values = {
        signal: value for topic in knowledge.watched.values() for signal, value in topic.readings(now_ns)
    }
    return tuple(_block(block, knowledge, values, now_ns) for block in written)


def _block(
    block: WrittenBlock, knowledge: Knowledge, values: Mapping[Signal, float | None], now_ns: int
) -> BlockStatus:
    return BlockStatus(
        file=block.file,
        line=block.line,
        column=block.column,
        state=knowledge.evaluator.truth(block.order),
        checks=tuple(_check(check, knowledge, values[check.signal]) for check in block.checks),
        held_s=(now_ns - knowledge.evaluator.changed_ns(block.order)) / NS_PER_S,
        times=tuple(_time(time, knowledge, now_ns) for time in block.times),
    )


def _time(time: WrittenTime, knowledge: Knowledge, now_ns: int) -> TimeStatus:
    is_long, held_ns = knowledge.evaluator.window(time.held, time.duration_ns, now_ns)
    state = is_long if time.word is TimeWord.FOR else Truth(Truth.TRUE.value - is_long.value)
    held_s = None if held_ns is None else held_ns / NS_PER_S
    return TimeStatus(line=time.line, column=time.column, state=state, held_s=held_s)


def _check(check: WrittenCheck, knowledge: Knowledge, value: float | None) -> CheckStatus:
    """For a check that no condition depends on, nothing else detects when its value crosses the border."""
    state = Truth.UNKNOWN
    if check.latch is not None:
        state = knowledge.evaluator.latched(check.latch)
    elif value is not None:
        state = Truth.TRUE if check.region.contains(value) else Truth.FALSE
    return CheckStatus(line=check.line, column=check.column, state=state, value=value)
