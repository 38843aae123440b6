# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which of the blocks that set a topic decides its rate."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Iterable
from dataclasses import dataclass

from smarttestudo.adirf.evaluator.literal import TRUE, UNKNOWN
from smarttestudo.adirf.rule_set import RuleBlock, RuleSet
from smarttestudo.domain.decision import PlannedRate, Reason
from smarttestudo.domain.rate import Rate


@dataclass(frozen=True, slots=True, kw_only=True)
class RequestedRate:
    """The rate that the rules ask for now, and the order of the deciding block where a block decides."""

    planned: PlannedRate
    block: int | None


class RateArbiter:
    """The blocks of one topic that are true or unknown, kept sorted so that the best is at hand.

    A block's rank is its place by (priority, rate, earliest in the file first); it never changes.
    """

    __slots__ = (
        "_blocks",
        "_default",
        "_default_reason",
        "_floor_hz",
        "_topic",
        "_true",
        "_unknown",
        "rank_of",
    )

    def __init__(self, topic: str, blocks: Iterable[RuleBlock], rule_set: RuleSet) -> None:
        self._topic = topic
        self._default = rule_set.defaults.get(topic, Rate.full())
        self._default_reason = rule_set.default_reason
        self._floor_hz = rule_set.floors_hz.get(topic, 0.0)
        self._blocks = sorted(blocks, key=lambda block: (block.priority, *self._merit(block)))
        self.rank_of = {block.order: rank for rank, block in enumerate(self._blocks)}
        self._true: list[int] = []
        self._unknown: dict[int, list[int]] = {}
        for rank, block in enumerate(self._blocks):
            self._unknown.setdefault(block.priority, []).append(rank)

    def move(self, rank: int, before: int, after: int) -> None:
        """The block of ``rank`` went from one truth to another."""
        self._drop(rank, before)
        if after == TRUE:
            insort(self._true, rank)
        elif after == UNKNOWN:
            insort(self._unknown.setdefault(self._blocks[rank].priority, []), rank)

    def request(self) -> RequestedRate:
        """Rules 3 to 6 of the language: priority, then rate; in doubt more; never below the floor."""
        known = self._blocks[self._true[-1]] if self._true else None
        rate = known.rates[self._topic] if known else self._default
        reason = Reason.BLOCK if known else self._default_reason
        doubt = self._highest_unknown(known)
        if doubt and doubt.rates[self._topic] > rate:
            known, rate, reason = doubt, doubt.rates[self._topic], Reason.UNKNOWN
        raised = rate.at_least(self._floor_hz)
        if raised is not rate:
            reason = Reason.FLOOR
        planned = PlannedRate(
            rate=raised,
            reason=reason,
            rule=known.label if known else None,
            line=known.line if known else None,
        )
        return RequestedRate(planned=planned, block=known.order if known else None)

    def _highest_unknown(self, known: RuleBlock | None) -> RuleBlock | None:
        """The unknown block with the highest rate among those that could overrule ``known``."""
        candidates = (
            self._blocks[ranks[-1]]
            for priority, ranks in self._unknown.items()
            if known is None or priority >= known.priority
        )
        return max(candidates, key=self._merit, default=None)

    def _merit(self, block: RuleBlock) -> tuple[Rate, int]:
        return block.rates[self._topic], -block.order

    def _drop(self, rank: int, truth: int) -> None:
        if truth == TRUE:
            del self._true[bisect_left(self._true, rank)]
        elif truth == UNKNOWN:
            priority = self._blocks[rank].priority
            ranks = self._unknown[priority]
            del ranks[bisect_left(ranks, rank)]
            if not ranks:
                del self._unknown[priority]
