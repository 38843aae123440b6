# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Groups of blocks that read or set something in common; different groups do not depend on each other."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

from smarttestudo.adirf.normal_form import signals_of
from smarttestudo.adirf.rule_set import RuleBlock
from smarttestudo.domain.signal import Signal


@dataclass(frozen=True, slots=True, kw_only=True)
class Cluster:
    """Blocks with all signals that they read and all topics that they set, sorted."""

    blocks: tuple[RuleBlock, ...]
    signals: tuple[Signal, ...]
    topics: tuple[str, ...]


def clusters_of(blocks: Sequence[RuleBlock]) -> list[Cluster]:
    """The clusters of ``blocks``, in the order of their first blocks."""
    parents: dict[Hashable, Hashable] = {}

    def root(node: Hashable) -> Hashable:
        while parents.setdefault(node, node) != node:
            parents[node] = parents[parents[node]]
            node = parents[node]
        return node

    for block in blocks:
        for node in (*signals_of(block.form), *block.rates):
            parents[root(node)] = root(block.order)
    members: dict[Hashable, list[RuleBlock]] = {}
    for block in blocks:
        members.setdefault(root(block.order), []).append(block)
    return [_cluster(group) for group in members.values()]


def _cluster(blocks: Sequence[RuleBlock]) -> Cluster:
    return Cluster(
        blocks=tuple(blocks),
        signals=tuple(sorted({signal for block in blocks for signal in signals_of(block.form)})),
        topics=tuple(sorted({topic for block in blocks for topic in block.rates})),
    )
