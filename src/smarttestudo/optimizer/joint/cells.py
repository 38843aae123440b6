# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Situations in which rules hold together, as cells of the signals' values."""

from __future__ import annotations

import bisect
import math
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from smarttestudo.domain.signal import Signal
from smarttestudo.language.boxes import Box, Domain, Effort, boxes_where
from smarttestudo.language.normal_form import reads, signals_of
from smarttestudo.language.region import Bound, Region
from smarttestudo.language.rule_set import RuleBlock


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
        for node in (*signals_of(block.form), *block.topics):
            parents[root(node)] = root(block.order)
    members: dict[Hashable, list[RuleBlock]] = {}
    for block in blocks:
        members.setdefault(root(block.order), []).append(block)
    return [_cluster(group) for group in members.values()]


def _cluster(blocks: Sequence[RuleBlock]) -> Cluster:
    return Cluster(
        blocks=tuple(blocks),
        signals=tuple(sorted({signal for block in blocks for signal in signals_of(block.form)})),
        topics=tuple(sorted({topic for block in blocks for topic in block.topics})),
    )


State = Mapping[Signal, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """The intervals of one signal's possible values: their edges, and a value in each that is not empty."""

    signal: Signal
    edges: Sequence[Bound]
    samples: Mapping[int, float]

    def intervals(self, region: Region) -> Iterator[int]:
        """The intervals that lie in ``region``, whose ends are edges."""
        for low, high in region.pieces:
            start, end = bisect.bisect_left(self.edges, low), bisect.bisect_left(self.edges, high)
            yield from (index for index in range(start, end) if index in self.samples)


def axes_of(cluster: Cluster, domain: Domain) -> list[Axis]:
    """One axis for each signal of the cluster."""
    cuts: dict[Signal, set[Bound]] = {signal: set() for signal in cluster.signals}
    for block in cluster.blocks:
        for part in reads(block.form):
            cuts[part.signal].update(part.region.cuts)
    return [_axis(signal, cuts[signal], domain(signal)) for signal in cluster.signals]


def cell_count(axes: Sequence[Axis]) -> int:
    """How many cells the axes make."""
    return math.prod(len(axis.samples) for axis in axes)


def holding_together(
    cluster: Cluster, axes: Sequence[Axis], domain: Domain, effort: Effort
) -> dict[frozenset[int], State]:
    """Every set of blocks, by order, that hold together while no other does, with a state in which they do.

    Raises ``TooComplexError`` when ``effort`` is spent on the conditions' boxes.
    """
    boxes = [
        (block.order, box) for block in cluster.blocks for box in boxes_where([block.form], domain, effort)
    ]
    orders = [order for order, _ in boxes]
    masks: dict[int, dict[Signal, float]] = {(1 << len(boxes)) - 1: {}}
    for axis in axes:
        along = _masks(axis, [box for _, box in boxes])
        # Cells with the same boxes so far go on as one.
        masks = {
            before & mask: {**state, axis.signal: axis.samples[index]}
            for before, state in reversed(masks.items())
            for index, mask in reversed(along.items())
        }
    found: dict[frozenset[int], State] = {}
    for mask, state in masks.items():
        found.setdefault(frozenset(orders[bit] for bit in _bits(mask)), state)
    return found


def _axis(signal: Signal, cuts: set[Bound], domain: Region) -> Axis:
    ends = {cut for piece in domain.pieces for cut in piece}
    whole = {cut for piece in Region.everything().pieces for cut in piece}
    edges = sorted(cuts | ends | whole)
    samples: dict[int, float] = {}
    for index in range(len(edges) - 1):
        values = Region.union_of([Region(((edges[index], edges[index + 1]),))]).intersection(domain)
        if not values.is_empty:
            samples[index] = values.sample()
    return Axis(signal=signal, edges=edges, samples=samples)


def _masks(axis: Axis, boxes: Sequence[Box]) -> dict[int, int]:
    """For each interval the bits of the boxes that do not exclude it."""
    masks = dict.fromkeys(axis.samples, 0)
    unbound = 0
    for bit, box in enumerate(boxes):
        region = box.get(axis.signal)
        if region is None:
            unbound |= 1 << bit
            continue
        for index in axis.intervals(region):
            masks[index] |= 1 << bit
    return {index: mask | unbound for index, mask in masks.items()}


def _bits(mask: int) -> Iterator[int]:
    while mask:
        lowest = mask & -mask
        yield lowest.bit_length() - 1
        mask ^= lowest
