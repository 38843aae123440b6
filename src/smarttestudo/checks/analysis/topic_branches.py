# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The branches that set some topics, by place; a text that an edit changed has most of them from before."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from heapq import merge

from smarttestudo.checks.analysis.condition_boxes import ConditionBoxes
from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.language.boxes import BoxIndex, Effort, IndexEntry
from smarttestudo.language.boxes.index import Interval, meets
from smarttestudo.language.resolved_rules import Branch

_MOST_CHANGED = 32


@dataclass(frozen=True, slots=True, eq=False)
class Setter:
    """A branch with the boxes where it applies."""

    branch: Branch
    boxes: ConditionBoxes


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicBranches:
    """The branches that set all of ``topics``.

    ``index`` has all entries but those ``added`` since, and some that are ``left_out``. ``touched`` are the
    orders of branches near to what changed since the text before, ``setters`` are in their order.
    """

    topics: tuple[str, ...]
    setters: tuple[Setter, ...]
    index: BoxIndex
    touched: AbstractSet[int]
    left_out: frozenset[int] = frozenset()
    added: tuple[IndexEntry, ...] = ()

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

    def with_setters(self, setters: tuple[Setter, ...]) -> TopicBranches | None:
        """The same topics with the branches of the next text; ``None`` where too many are others."""
        if setters == self.setters:
            return replace(self, touched=frozenset()) if self.touched else self
        mine, others = set(self.setters), set(setters)
        gone, come = mine - others, others - mine
        if len(gone) + len(come) > _MOST_CHANGED:
            return None
        left_out = {one.branch.order for one in gone}
        added = [one for one in self.added if one.owner not in left_out]
        added += entries_of(come, self.topics)
        if len(added) > _MOST_CHANGED:
            return None
        changed = replace(
            self,
            setters=setters,
            left_out=self.left_out.union(left_out),
            added=tuple(sorted(added, key=lambda one: one.owner)),
        )
        endless = Effort(sys.maxsize)
        hulls = [hull for one in (*gone, *come) for hull in one.boxes.hulls]
        near = {entry.owner for hull in hulls for entry in changed.near(hull.get, endless)}
        return replace(changed, touched=near.union(one.branch.order for one in come))


def topic_branches(topics: tuple[str, ...], setters: tuple[Setter, ...]) -> TopicBranches:
    """The branches ``setters`` of all of ``topics``."""
    entries = tuple(entries_of(setters, topics))
    touched = {one.branch.order for one in setters}
    return TopicBranches(topics=topics, setters=setters, index=BoxIndex(entries), touched=touched)


def entries_of(setters: Iterable[Setter], topics: Sequence[str]) -> Iterator[IndexEntry]:
    """The boxes of branches as entries of an index."""
    for one in setters:
        kind = rates_set(one.branch, topics)
        for box, hull in zip(one.boxes.boxes, one.boxes.hulls, strict=True):
            yield IndexEntry(owner=one.branch.order, kind=kind, box=box, hull=hull)


def rates_set(branch: Branch, topics: Sequence[str]) -> tuple[Rate | None, ...]:
    """The rates that ``branch`` sets ``topics`` to."""
    return tuple(branch.rate(topic) for topic in topics)
