# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which conditions hold, as the evaluator has it, for people to see."""

from __future__ import annotations

from collections.abc import Mapping

from smarttestudo.adirf.rule_set import WrittenBlock, WrittenCheck
from smarttestudo.domain.block_status import BlockStatus, CheckStatus
from smarttestudo.domain.signal import Signal
from smarttestudo.runtime.knowledge.knowledge import Knowledge


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
        checks=tuple(_check(check, knowledge, values) for check in block.checks),
    )


def _check(check: WrittenCheck, knowledge: Knowledge, values: Mapping[Signal, float | None]) -> CheckStatus:
    return CheckStatus(
        line=check.line,
        column=check.column,
        state=knowledge.evaluator.check_truth(check.signal, check.region),
        value=values[check.signal],
    )
