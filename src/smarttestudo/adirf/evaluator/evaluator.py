# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The one evaluator of rule sets."""

from __future__ import annotations

from collections.abc import Set as AbstractSet

from smarttestudo.adirf.evaluator.graph import Graph, Propagation
from smarttestudo.adirf.evaluator.literal import Literal, Thresholds
from smarttestudo.adirf.evaluator.rate_arbiter import RateArbiter, RequestedRate
from smarttestudo.adirf.normal_form import signals_of
from smarttestudo.adirf.region import Bound
from smarttestudo.adirf.rule_set import RuleBlock, RuleSet
from smarttestudo.domain.decision import PlannedRate
from smarttestudo.domain.signal import Signal, Truth


class Evaluator:
    """What a rule set asks for, given the values of its signals; all signals start unknown.

    A new value costs in proportion to the thresholds it crosses and the blocks it changes, whatever the
    size of the rule set.
    """

    def __init__(self, rule_set: RuleSet) -> None:
        graph = Graph()
        self._blocks = rule_set.blocks
        self._literals = [_literal(graph, block) for block in rule_set.blocks]
        self._thresholds = {signal: Thresholds(leaves.values()) for signal, leaves in graph.leaves.items()}
        self._arbiters = _arbiters(rule_set)
        self._entries = [
            [
                (topic, self._arbiters[topic], self._arbiters[topic].rank_of[block.order])
                for topic in block.rates
            ]
            for block in rule_set.blocks
        ]
        self._changed_topics = set(self._arbiters)
        self._changed_blocks: set[int] = set()
        self._propagation = Propagation(graph, self._block_changed)

    @property
    def touched(self) -> int:
        """How many parts of the network were looked at so far, a measure of cost that needs no clock."""
        return self._propagation.touched

    def set(self, signal: Signal, value: float | None) -> None:
        """Take a signal's value; ``None`` and NaN mean unknown. Signals that no check reads are ignored."""
        thresholds = self._thresholds.get(signal)
        if thresholds is None:
            return
        for leaf in thresholds.move(value):
            self._propagation.change(leaf, thresholds.truth(leaf))

    def take_changed_topics(self) -> AbstractSet[str]:
        """The topics whose request may have changed since the last call; at first all that are relayed."""
        self._propagation.settle()
        changed, self._changed_topics = self._changed_topics, set()
        return changed

    def take_changed_blocks(self) -> AbstractSet[int]:
        """The blocks, by order, that turned since the last call; at first none: all start unknown."""
        self._propagation.settle()
        changed, self._changed_blocks = self._changed_blocks, set()
        return changed

    def request(self, topic: str) -> PlannedRate:
        """The rate that the rules ask for now; ``topic`` is one of the rule set's relayed topics."""
        return self.decide(topic).planned

    def decide(self, topic: str) -> RequestedRate:
        """Like ``request``, with the order of the deciding block."""
        self._propagation.settle()
        return self._arbiters[topic].request()

    def truth(self, block_order: int) -> Truth:
        """Whether the condition of a block holds."""
        self._propagation.settle()
        return Truth(self._literals[block_order].truth)

    def reads(self, block_order: int) -> list[Signal]:
        """The signals that the condition of a block reads, sorted."""
        return sorted(signals_of(self._blocks[block_order].form))

    def values_of(self, block_order: int) -> dict[str, float | None]:
        """What the condition of a block reads, by signal name; ``None`` is unknown."""
        return {str(signal): self._thresholds[signal].value for signal in self.reads(block_order)}

    def cuts(self, signal: Signal) -> list[Bound]:
        """The places of the number line, rising, where a value of ``signal`` changes some check."""
        return self._thresholds[signal].cuts

    def _block_changed(self, order: int, before: int, after: int) -> None:
        self._changed_blocks.add(order)
        for topic, arbiter, rank in self._entries[order]:
            arbiter.move(rank, before, after)
            self._changed_topics.add(topic)


def _literal(graph: Graph, block: RuleBlock) -> Literal:
    literal = graph.literal_of(block.form)
    literal.blocks.append(block.order)
    return literal


def _arbiters(rule_set: RuleSet) -> dict[str, RateArbiter]:
    blocks: dict[str, list[RuleBlock]] = {topic: [] for topic in rule_set.relayed}
    for block in rule_set.blocks:
        for topic in block.rates:
            blocks[topic].append(block)
    return {topic: RateArbiter(topic, setting, rule_set) for topic, setting in blocks.items()}
