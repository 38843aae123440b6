# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Conditions as one graph of leaves and joins in which equal parts are one node."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable
from functools import reduce

from smarttestudo.adirf.evaluator.literal import Group, Join, Leaf, Literal, Node
from smarttestudo.adirf.normal_form import Form, Some, Within
from smarttestudo.adirf.region import Region
from smarttestudo.domain.signal import Signal


class Graph:
    """An and-inverter graph over leaves "this signal lies in this region".

    OR is an inverted AND of inverted parts (A. Kuehlmann et al., "Robust Boolean reasoning", IEEE TCAD
    2002), so that a block and its Else are one node read in two ways.
    """

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self.leaves: dict[Signal, dict[Region, Leaf]] = {}
        self._joins: dict[tuple[Literal, Literal], Join] = {}
        self._groups: dict[tuple[Hashable, bool], Group] = {}

    @property
    def groups(self) -> Iterable[Group]:
        """All groups of literals."""
        return self._groups.values()

    def literal_of(self, form: Form, *, negated: bool = False) -> Literal:
        """The literal that is as true as ``form``, or as its negation."""
        if isinstance(form, Within):
            return self._within(form.signal, form.region.complement() if negated else form.region)
        is_or = isinstance(form, Some)
        conjunction = self._conjunction(form.parts, negated=is_or)
        return self._inverse(conjunction) if is_or != negated else conjunction

    def _conjunction(self, parts: Iterable[Form], *, negated: bool) -> Literal:
        """AND of ``parts`` (or of their negations): one leaf for each signal, then the nested parts.

        A signal is known or not for all its checks at once, so their regions may be intersected. The fixed
        order lets conditions over the same signals share joins.
        """
        regions: dict[Signal, list[Region]] = {}
        nested: dict[Literal, None] = {}
        for part in parts:
            if isinstance(part, Within):
                region = part.region.complement() if negated else part.region
                regions.setdefault(part.signal, []).append(region)
            else:
                nested[self.literal_of(part, negated=negated)] = None
        literals = [
            self._within(signal, Region.intersection_of(regions[signal])) for signal in sorted(regions)
        ]
        literals += sorted(nested, key=lambda literal: (literal.node.number, literal.inverted))
        return reduce(self._joined, literals)

    def _within(self, signal: Signal, region: Region) -> Literal:
        """The literal of a region; of a region and its complement only one is a leaf."""
        inverted = region.contains(-math.inf)
        base = region.complement() if inverted else region
        leaves = self.leaves.setdefault(signal, {})
        leaf = leaves.get(base)
        if leaf is None:
            leaf = leaves[base] = Leaf(len(self.nodes), signal, base)
            self.nodes.append(leaf)
        return self._literal(leaf, inverted=inverted)

    def _joined(self, left: Literal, right: Literal) -> Literal:
        join = self._joins.get((left, right))
        if join is None:
            join = self._joins[left, right] = Join(len(self.nodes), left, right)
            self.nodes.append(join)
        return self._literal(join, inverted=False)

    def _inverse(self, literal: Literal) -> Literal:
        return self._literal(literal.node, inverted=not literal.inverted)

    def _literal(self, node: Node, *, inverted: bool) -> Literal:
        for literal in node.literals:
            if literal.inverted == inverted:
                return literal
        group = self._groups.setdefault((node.shape, inverted), Group())
        literal = Literal(node, group, inverted=inverted)
        node.literals.append(literal)
        return literal
