# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The branches that set some topics, by place; a text that an edit changed has most of them from before."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field, replace
from heapq import merge

from smarttestudo.checks.analysis.condition_boxes import ConditionBoxes
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.language.boxes import BoxIndex, Effort, IndexEntry
from smarttestudo.language.boxes.index import Interval, meets
from smarttestudo.language.resolved_rules import Branch

_MOST_CHANGED = 32

Setters = Mapping[int, tuple[Branch, ConditionBoxes]]
"""Branches with the boxes where they apply, by order."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicBranches:
    """The branches that set all of ``topics``.

    ``index`` has all entries but those ``added`` since, and some that are ``left_out``. ``touched`` are the
    orders of branches near to what changed since the ones ``before``.
    """

    topics: tuple[str, ...]
    setters: Setters
    index: BoxIndex
    version: object = field(default_factory=object)
    before: object = None
    left_out: frozenset[int] = frozenset()
    added: tuple[IndexEntry, ...] = ()
    touched: AbstractSet[int] = frozenset()

    def near(
        self,
        interval_of: Callable[[Signal], Interval | None],
        effort: Effort,
        *,
        other_than: Branch | None = None,
    ) -> Iterator[IndexEntry]:
        """The entries near a place, in the order of their branches.

        Those of branches that set the same rates as ``other_than`` are left out.
        """
        kind = None if other_than is None else rates_set(other_than, self.topics)
        found = self.index.near(interval_of, effort, other_than=kind)
        if not self.added and not self.left_out:
            return found
        effort.spend(len(self.added))
        kept = (entry for entry in found if entry.owner not in self.left_out)
        added = [one for one in self.added if one.kind != kind and meets(one.hull, interval_of)]
        return merge(kept, added, key=lambda entry: entry.owner)

    def is_as_in(self, version: object, branch: Branch) -> bool:
        """Whether near to ``branch`` nothing changed since ``version``."""
        return version is self.version or (version is self.before and branch.order not in self.touched)

    def with_setters(self, setters: Setters) -> TopicBranches | None:
        """The same topics with other branches; ``None`` where too many are others."""
        mine = self.setters
        gone = [order for order, one in mine.items() if not _is_same(one, setters.get(order))]
        come = [order for order, one in setters.items() if not _is_same(one, mine.get(order))]
        if not gone and not come:
            return self
        added = [one for one in self.added if one.owner not in gone]
        for order in come:
            added += entries_of(*setters[order], self.topics)
        if len(gone) + len(come) > _MOST_CHANGED or len(added) > _MOST_CHANGED:
            return None
        hulls = [hull for order in gone for hull in mine[order][1].hulls]
        hulls += [hull for order in come for hull in setters[order][1].hulls]
        changed = replace(
            self,
            setters=setters,
            version=object(),
            before=self.version,
            left_out=self.left_out.union(gone),
            added=tuple(sorted(added, key=lambda one: one.owner)),
        )
        endless = Effort(sys.maxsize)
        touched = {entry.owner for hull in hulls for entry in changed.near(hull.get, endless)}
        return replace(changed, touched=touched.union(come))


def _is_same(one: tuple[Branch, ConditionBoxes], other: tuple[Branch, ConditionBoxes] | None) -> bool:
    return other is not None and one[0] is other[0] and one[1] is other[1]


def topic_branches(topics: tuple[str, ...], setters: Setters) -> TopicBranches:
    """The branches ``setters`` of all of ``topics``."""
    entries = [entry for one in setters.values() for entry in entries_of(*one, topics)]
    return TopicBranches(topics=topics, setters=setters, index=BoxIndex(entries))


def entries_of(branch: Branch, boxes: ConditionBoxes, topics: Sequence[str]) -> Iterator[IndexEntry]:
    """The boxes of a branch as entries of an index."""
    kind = rates_set(branch, topics)
    for box, hull in zip(boxes.boxes, boxes.hulls, strict=True):
        yield IndexEntry(owner=branch.order, kind=kind, box=box, hull=hull)


def rates_set(branch: Branch, topics: Sequence[str]) -> tuple[Rate | None, ...]:
    """The rates that ``branch`` sets ``topics`` to."""
    return tuple(branch.rate(topic) for topic in topics)
