# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""When recordings begin."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from smarttestudo.domain.signal import Truth
from smarttestudo.language.rule_set import RuleBlock, RuleSet
from smarttestudo.loop.knowledge.knowledge import Knowledge


@dataclass(frozen=True, slots=True, kw_only=True)
class Trigger:
    """A block with recordings began to hold at ``stamp_ns``, when its condition read ``values``."""

    stamp_ns: int
    block: RuleBlock
    values: Mapping[str, float | None]


def triggers(knowledge: Knowledge, now_ns: int) -> Iterator[Trigger]:
    """The blocks that are now known to hold and were known not to since they last did.

    A condition that is in doubt for a while has neither begun nor ended. ``now_ns`` is a steady time.
    """
    for order, truth in knowledge.evaluator.take_turned_recordings():
        if truth is Truth.FALSE:
            knowledge.recording.discard(order)
        elif truth is Truth.TRUE and order not in knowledge.recording:
            knowledge.recording.add(order)
            yield Trigger(
                stamp_ns=knowledge.time.on_clock(now_ns),
                block=knowledge.rule_set.blocks[order],
                values=knowledge.values_of(order, now_ns),
            )


def still_recording(knowledge: Knowledge, rule_set: RuleSet) -> set[int]:
    """The blocks of ``rule_set``, by order, that are written as those that hold: they do not begin again."""
    holding = {_written(knowledge.rule_set.blocks[order]) for order in knowledge.recording}
    return {block.order for block in rule_set.blocks if block.recordings and _written(block) in holding}


def _written(block: RuleBlock) -> object:
    """All that stays when other statements move the block, and comments change."""
    records = None if block.name is not None else tuple(one.name for one in block.recordings)
    return block.name, records, block.form
