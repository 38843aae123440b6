# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which of the blocks that hold, or may hold, decides the rate and the bounds of a topic."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from smarttestudo.domain.decision import BoundReason, PlannedRate, Reason
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.timing import Yield
from smarttestudo.language.evaluator.literal import FALSE, TRUE, UNKNOWN
from smarttestudo.language.margin_rate import STEPS, MarginRate
from smarttestudo.language.rule_set import RuleBlock, RuleSet


@dataclass(frozen=True, slots=True, kw_only=True)
class RequestedRate:
    """The rate that the rules ask for now, and the order of the deciding block where a block decides."""

    planned: PlannedRate
    block: int | None


class Ranking:
    """The blocks that set one thing and are true or unknown, kept sorted so that the best is at hand.

    A block's rank is its place by (priority, merit, earliest in the file first); it never changes. A block
    that is given several times, with other merits, has as many ranks.
    """

    __slots__ = ("_blocks", "_merit", "_true", "_unknown", "ranks_of")

    def __init__(self, blocks: Iterable[RuleBlock], merit: Callable[[RuleBlock], Any]) -> None:
        def placed(block: RuleBlock) -> tuple[Any, int]:
            return merit(block), -block.order

        self._merit = placed
        self._blocks = sorted(blocks, key=lambda block: (block.priority, *self._merit(block)))
        self.ranks_of: dict[int, list[int]] = {}
        for rank, block in enumerate(self._blocks):
            self.ranks_of.setdefault(block.order, []).append(rank)
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

    @property
    def known(self) -> RuleBlock | None:
        """The best of the highest priority among those that are known to hold."""
        return self._blocks[self._true[-1]] if self._true else None

    def best_unknown(self, known: RuleBlock | None) -> RuleBlock | None:
        """The best unknown block among those that could overrule ``known``."""
        candidates = (
            self._blocks[ranks[-1]]
            for priority, ranks in self._unknown.items()
            if known is None or priority >= known.priority
        )
        return max(candidates, key=self._merit, default=None)

    def _drop(self, rank: int, truth: int) -> None:
        if truth == TRUE:
            del self._true[bisect_left(self._true, rank)]
        elif truth == UNKNOWN:
            priority = self._blocks[rank].priority
            ranks = self._unknown[priority]
            del ranks[bisect_left(ranks, rank)]
            if not ranks:
                del self._unknown[priority]


class Steps:
    """The step of a rate that goes by a margin; at first that of an unknown value.

    With a ranking, the block has a rank for each step, in ``ranks``, and counts with the present one.
    """

    __slots__ = ("is_known", "margin", "ranking", "ranks", "step", "truth")

    def __init__(self, margin: MarginRate) -> None:
        self.margin = margin
        self.step = STEPS
        self.is_known = False
        self.ranking: Ranking | None = None
        self.ranks: Sequence[int] = ()
        self.truth = UNKNOWN

    @property
    def rate(self) -> Rate:
        """The present rate."""
        return self.margin.rates[self.step]

    def set(self, value: Any) -> bool:
        """Take the signal's value; whether the rate, or whether it is known, is another one now."""
        before = self.step, self.is_known
        step, self.is_known = self.margin.step(value), value is not None
        if step != self.step and self.ranking is not None:
            self.ranking.move(self.ranks[self.step], self.truth, FALSE)
            self.ranking.move(self.ranks[step], FALSE, self.truth)
        self.step = step
        return before != (step, self.is_known)

    def move(self, before: int, after: int) -> None:
        """The block went from one truth to another."""
        if self.ranking is not None:
            self.ranking.move(self.ranks[self.step], before, after)
        self.truth = after


class RateArbiter:
    """Which rate the rules ask for one topic; ``steps`` are those of blocks with a margin, by order."""

    __slots__ = ("_default", "_default_reason", "_floor_hz", "_topic", "default_steps", "ranking", "steps")

    def __init__(self, topic: str, blocks: Iterable[RuleBlock], rule_set: RuleSet) -> None:
        self._topic = topic
        self._default = rule_set.defaults.get(topic, Rate.full())
        self._default_reason = rule_set.default_reason
        self._floor_hz = rule_set.floors_hz.get(topic, 0.0)
        margin = rule_set.default_margins.get(topic)
        self.default_steps = None if margin is None else Steps(margin)
        self.steps: dict[int, Steps] = {}

        def merit(block: RuleBlock) -> tuple[float, bool]:
            # As rates order, and much faster to compare.
            rate = block.rates[topic]
            return rate.hz, rate.yields_to_floor

        self.ranking = Ranking(self._with_each_step(blocks), merit)
        for order, steps in self.steps.items():
            steps.ranking, steps.ranks = self.ranking, self.ranking.ranks_of[order]
            for rank in steps.ranks[:-1]:
                self.ranking.move(rank, UNKNOWN, FALSE)

    def _with_each_step(self, blocks: Iterable[RuleBlock]) -> Iterator[RuleBlock]:
        """The blocks, of one with a margin one for each step."""
        for block in blocks:
            margin = block.margins.get(self._topic)
            if margin is None:
                yield block
                continue
            self.steps[block.order] = Steps(margin)
            yield from (replace(block, rates={self._topic: rate}) for rate in margin.rates)

    def _is_margin_unknown(self, block: RuleBlock | None) -> bool:
        steps = self.default_steps if block is None else self.steps.get(block.order)
        return steps is not None and not steps.is_known

    def request(self) -> RequestedRate:
        """Rules 3 to 6 of the language: priority, then rate; in doubt more; never below the floor."""
        known = self.ranking.known
        default = self._default if self.default_steps is None else self.default_steps.rate
        rate = known.rates[self._topic] if known else default
        reason = Reason.BLOCK if known else self._default_reason
        if self._is_margin_unknown(known):
            reason = Reason.UNKNOWN
        doubt = self.ranking.best_unknown(known)
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


class BoundArbiter:
    """Which bound the rules ask for one property of one topic."""

    __slots__ = ("_default", "_topic", "property", "ranking")

    def __init__(self, topic: str, name: str, blocks: Iterable[RuleBlock], rule_set: RuleSet) -> None:
        self._topic = topic
        self.property = name
        self._default = rule_set.bounds.get(topic, {}).get(name)
        self.ranking = Ranking(blocks, lambda block: -block.bounds[topic][name])

    @property
    def is_known(self) -> bool:
        """Whether the property is bound whatever the unknown blocks turn out to be."""
        return self._default is not None or self.ranking.known is not None

    def request(self, *, doubt_counts: bool) -> tuple[float | None, RuleBlock | None, Reason]:
        """The bound, the block that decides it, and why: priority, then the tightest.

        In doubt the tightest, where ``doubt_counts``. The bound is ``None`` while nothing bounds the
        property; a block beside it is one in doubt that would.
        """
        known = self.ranking.known
        bound, reason = self._default, Reason.DEFAULT
        if known is not None:
            bound, reason = known.bounds[self._topic][self.property], Reason.BLOCK
        doubt = self.ranking.best_unknown(known)
        if doubt is not None:
            feared = doubt.bounds[self._topic][self.property]
            if bound is None or feared < bound:
                return feared if doubt_counts else None, doubt, Reason.UNKNOWN
        return bound, known, reason


class TopicArbiter:
    """The request of the rules for one topic: its rate, and the bounds of the receiver's picture."""

    __slots__ = ("_bounds", "_rate")

    def __init__(self, topic: str, blocks: Sequence[RuleBlock], rule_set: RuleSet) -> None:
        self._rate = RateArbiter(topic, [block for block in blocks if topic in block.rates], rule_set)
        names = dict.fromkeys(rule_set.bounds.get(topic, {}))
        for block in blocks:
            names.update(dict.fromkeys(block.bounds.get(topic, {})))
        self._bounds = [
            BoundArbiter(
                topic, name, [block for block in blocks if name in block.bounds.get(topic, {})], rule_set
            )
            for name in names
        ]

    def movers_of(self, order: int) -> list[Callable[[int, int], None]]:
        """The functions to be told the truth of the block of that order before and after it changes."""
        rankings = [bound.ranking for bound in self._bounds]
        steps = self._rate.steps.get(order)
        if steps is None:
            rankings.append(self._rate.ranking)
        movers: list[Callable[[int, int], None]] = [
            partial(ranking.move, ranking.ranks_of[order][0])
            for ranking in rankings
            if order in ranking.ranks_of
        ]
        return movers if steps is None else [*movers, steps.move]

    @property
    def steps(self) -> Iterator[Steps]:
        """The steps of all its rates that go by a margin."""
        yield from self._rate.steps.values()
        if self._rate.default_steps is not None:
            yield self._rate.default_steps

    def request(self) -> RequestedRate:
        """The rate with its reason, and the bounds.

        A topic without any bound passes all that its rate lets through, which is more than with one: so
        bounds of unknown blocks count only where a known one bounds the topic. Where no block decides the
        rate, the first that decides a bound stands for it.
        """
        request = self._rate.request()
        if not self._bounds:
            return request
        is_bound = any(arbiter.is_known for arbiter in self._bounds)
        within: dict[str, float] = {}
        reasons: dict[str, BoundReason] = {}
        for arbiter in self._bounds:
            bound, block, reason = arbiter.request(doubt_counts=is_bound)
            if bound is None and block is None:
                continue
            label, line = (None, None) if block is None else (block.label, block.line)
            reasons[arbiter.property] = BoundReason(reason=reason, rule=label, line=line)
            if bound is None:
                continue
            within[arbiter.property] = bound
            if block is not None and request.block is None and request.planned.reason is Reason.DEFAULT:
                planned = replace(request.planned, reason=reason, rule=label, line=line)
                request = RequestedRate(planned=planned, block=block.order)
        return replace(request, planned=replace(request.planned, within=within, bound_reasons=reasons))


def arbiters_of(rule_set: RuleSet, yield_turn: Yield) -> dict[str, TopicArbiter]:
    blocks = rule_set.blocks_by_topic(yield_turn)
    return {topic: TopicArbiter(topic, setting, rule_set) for topic, setting in blocks.items()}
