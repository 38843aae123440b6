# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which conditions hold."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from collections.abc import Set as AbstractSet

from smarttestudo.adirf.rule_set import WrittenBlock, WrittenCheck
from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.domain.status import BlockStatus, CheckStatus
from smarttestudo.runtime.knowledge.knowledge import Knowledge
from smarttestudo.runtime.knowledge.watched_topic import Reading


def analyze(knowledge: Knowledge, readings: Iterable[Reading]) -> AbstractSet[str]:
    """The topics whose request may have changed; at first all that are relayed."""
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
    return tuple(_block(block, knowledge, values) for block in written)


def _block(block: WrittenBlock, knowledge: Knowledge, values: Mapping[Signal, float | None]) -> BlockStatus:
    return BlockStatus(
        file=block.file,
        line=block.line,
        column=block.column,
        state=knowledge.evaluator.truth(block.order),
        checks=tuple(_check(check, values[check.signal]) for check in block.checks),
    )


def _check(check: WrittenCheck, value: float | None) -> CheckStatus:
    """For a check that no condition depends on, nothing else detects when its value crosses the border."""
    state = Truth.UNKNOWN
    if value is not None:
        state = Truth.TRUE if check.region.contains(value) else Truth.FALSE
    return CheckStatus(line=check.line, column=check.column, state=state, value=value)
