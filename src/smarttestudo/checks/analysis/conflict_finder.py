# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where branches that set different rates apply together, or meet."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from smarttestudo.checks.analysis.branch_index import BranchIndex
from smarttestudo.checks.analysis.results import Clash, SharedBorder, State
from smarttestudo.domain.signal import Signal
from smarttestudo.language.boxes import (
    Border,
    Box,
    Domain,
    Effort,
    border_between,
    common_box,
    find_box,
)
from smarttestudo.language.normal_form import is_derived
from smarttestudo.language.resolved_rules import Branch


class ConflictFinder:
    """Finder of conflicts of a branch with the branches before it in the file.

    ``is_noisy`` is whether a signal goes back and forth across a border. A conflict is searched for when it
    is asked for; ``TooComplexError`` is raised when ``effort`` is spent.
    """

    def __init__(
        self, index: BranchIndex, *, domain: Domain, is_noisy: Callable[[Signal], bool], effort: Effort
    ) -> None:
        self._index = index
        self._domain = domain
        self._is_noisy = is_noisy
        self._effort = effort

    def of(self, branch: Branch) -> Iterator[Clash | SharedBorder]:
        """The clashes of ``branch``; where it has none, its shared borders."""
        settled: set[int] = set()
        borders: dict[int, tuple[Branch, Border]] = {}
        has_clash = False
        for other, other_box, box in self._pairs(branch):
            common = common_box(other_box, box)
            if common is None:
                border = self._border(other, other_box, box)
                if border is not None:
                    borders.setdefault(other.order, (other, border))
            elif other.order not in settled and other.block.priority == branch.block.priority:
                settled.add(other.order)
                for clash in self._clash(other, branch, common):
                    has_clash = True
                    yield clash
        if not has_clash:
            yield from self._shared_borders(borders.values(), branch)

    def _pairs(self, branch: Branch) -> Iterator[tuple[Branch, Box, Box]]:
        """The branches before this one that set other rates, each with a box of its own near one of these."""
        boxes = self._index.boxes(branch)
        for near in self._index.topic_branches(branch):
            for box, hull in zip(boxes.boxes, boxes.hulls, strict=True):
                for other, other_box in self._index.around(branch, hull, near, self._effort):
                    if other.order >= branch.order:
                        break
                    if other.block is not branch.block:
                        self._effort.spend(len(box) + len(other_box))
                        yield other, other_box, box

    def _clash(self, first: Branch, second: Branch, common: Box) -> Iterator[Clash]:
        topics = differing_topics(first, second)
        is_exact = self._index.boxes(first).is_exact and self._index.boxes(second).is_exact
        box = common if is_exact else find_box([first.form, second.form], self._domain, self._effort)
        if topics and box is not None:
            yield Clash(first=first, second=second, topics=topics, state=sample_state(box))

    def _border(self, other: Branch, other_box: Box, box: Box) -> Border | None:
        # Noise does not turn a condition that must have held for a while.
        if not self._index.boxes(other).is_exact or any(map(is_derived, {*other_box, *box})):
            return None
        border = border_between(other_box, box)
        return border if border is not None and self._is_noisy(border.signal) else None

    def _shared_borders(
        self, borders: Iterable[tuple[Branch, Border]], branch: Branch
    ) -> Iterator[SharedBorder]:
        for other, border in borders:
            topics = differing_topics(other, branch)
            if topics and find_box([other.form, branch.form], self._domain, self._effort) is None:
                yield SharedBorder(first=other, second=branch, topics=topics, border=border)


def differing_topics(first: Branch, second: Branch) -> tuple[str, ...]:
    """The topics that both set, to rates that are known to differ."""
    return tuple(
        topic
        for topic in second.settings
        if topic in first.settings
        and (one := first.rate(topic)) is not None
        and (other := second.rate(topic)) is not None
        and one.hz != other.hz
    )


def sample_state(box: Box) -> State:
    """A state in ``box``, in round numbers where it can be."""
    return {signal: region.sample() for signal, region in sorted(box.items())}
