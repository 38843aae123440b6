# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Other rules for a loop that runs, before they come into force."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from smarttestudo.domain.signal import Signal
from smarttestudo.domain.timing import Rest, no_rest, resting
from smarttestudo.language.evaluator import Evaluator
from smarttestudo.language.rule_set import RuleBlock, RuleSet

_GONE = -1
"""Stands for a block that the new rules do not have."""

_Deciding = tuple[RuleSet, Sequence[RuleBlock]]
"""Rules, and their blocks that set one topic."""


@dataclass(frozen=True, slots=True)
class SameRules:
    """The blocks that decide one topic before and after, alike but for their places.

    ``blocks`` are those after by the order of those before, ``named`` the same by the former label and line.
    """

    blocks: Mapping[int, RuleBlock]
    named: Mapping[tuple[str, int], RuleBlock]


class PreparedRules:
    """Other rules in place of ``before``: all that can be made of them before they come into force.

    So the loop need not stop for as long as their number takes. They come into force once; ``values`` of
    signals may be those then. ``same`` are the topics whose rules stay the same.
    """

    def __init__(
        self,
        before: RuleSet,
        after: RuleSet,
        values: Mapping[Signal, float | None] | None = None,
        rest: Rest = no_rest,
    ) -> None:
        self.before, self.after = before, after
        self.evaluator = Evaluator(after, rest=rest)
        self.evaluator.foresee(values or {}, rest)
        old_blocks, new_blocks = before.blocks_by_topic(rest), after.blocks_by_topic(rest)
        self.same = {
            topic: _same(old, new)
            for topic, old in old_blocks.items()
            if (new := new_blocks.get(topic)) is not None
            and _are_alike(topic, (before, old), (after, new), rest)
        }
        self.counterpart = _counterparts(before, after, rest)

    def fits(self, before: RuleSet, after: RuleSet) -> bool:
        """Whether these are the rules that it was made of."""
        return self.before is before and self.after is after

    def dismantle(self, rest: Rest = no_rest) -> None:
        """Free what was in force before, after the exchange, piece by piece."""
        self.evaluator.dismantle(rest)
        left: list[object] = [*self.before.blocks]
        del self.before, self.same, self.counterpart
        while left:
            rest()
            left.pop()


def _same(before: Sequence[RuleBlock], after: Sequence[RuleBlock]) -> SameRules:
    pairs = list(zip(before, after, strict=True))
    return SameRules(
        blocks={one.order: other for one, other in pairs},
        named={(one.label, one.line): other for one, other in pairs},
    )


def _are_alike(topic: str, before: _Deciding, after: _Deciding, rest: Rest) -> bool:
    """Whether all that decides the rate and the bounds of ``topic`` is the same."""
    (before_set, old), (after_set, new) = before, after
    if len(old) != len(new) or _always(before_set, topic) != _always(after_set, topic):
        return False
    pairs = resting(zip(old, new, strict=True), rest)
    return all(_stance(one, topic) == _stance(other, topic) for one, other in pairs)


def _always(rule_set: RuleSet, topic: str) -> object:
    return rule_set.defaults.get(topic), rule_set.floors_hz.get(topic), rule_set.bounds.get(topic)


def _stance(block: RuleBlock, topic: str) -> object:
    return block.name, block.priority, block.rates.get(topic), block.bounds.get(topic), block.form


def _counterparts(before: RuleSet, after: RuleSet, rest: Rest) -> Callable[[int], int]:
    """Which block of ``after`` each block of ``before`` became: the one of the same name."""
    found: dict[int, int] = {}
    by_label: dict[str, list[int]] = {}
    for block in resting(reversed(after.blocks), rest):
        by_label.setdefault(block.label, []).append(block.order)
    for block in resting(before.blocks, rest):
        if orders := by_label.get(block.label):
            found[block.order] = orders.pop()
    return lambda order: found.get(order, _GONE)
