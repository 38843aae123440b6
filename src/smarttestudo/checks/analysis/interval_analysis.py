# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The interval analysis of a rule set, bounded in time and memory."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from typing import TypeVar

from smarttestudo.checks.analysis.branch_index import BranchIndex, ConditionBoxes, Covers, boxes_of
from smarttestudo.checks.analysis.conflicts import ConflictFinder, redundant_rates
from smarttestudo.checks.analysis.results import Analysis, Clash, Gap, Shadow, SharedBorder
from smarttestudo.checks.context import CheckContext
from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.language.boxes import Domain, Effort, TooComplexError, find_box
from smarttestudo.language.normal_form import Form, negation
from smarttestudo.language.resolved_rules import Branch, ResolvedBlock, ResolvedFloor, ResolvedRate
from smarttestudo.language.text_region import is_part_of

_T = TypeVar("_T")

LOOKS_IN_ALL = 5_000_000
LOOKS_AT_A_QUESTION = 50_000
LOOKS_AT_REDUNDANT_RATES = 1_000_000
MAX_CLASHES_SHOWN = 3


def analyse(
    blocks: Sequence[ResolvedBlock],
    branches: Sequence[Branch],
    defaults: Mapping[str, ResolvedRate],
    floors: Mapping[str, ResolvedFloor],
    context: CheckContext,
) -> Analysis:
    """The analysis of the conditions of ``blocks``; ``defaults`` and ``floors`` are by topic.

    Of each branch the first clashes with branches before it are found, or else the first shared border.
    """
    analyst = _Analyst(blocks, domain=cache(context.domain), is_noisy=cache(context.is_noisy))
    where_true = {block.order: analyst.boxes(block.form) for block in blocks}
    truths = {block.order: analyst.truth(block, where_true[block.order]) for block in blocks}
    boxes_by_branch = {
        branch.order: analyst.boxes(branch.form) if branch.is_else else where_true[branch.block.order]
        for branch in branches
    }
    possible = [branch for branch in branches if boxes_by_branch[branch.order].boxes]
    index = BranchIndex(branches, boxes_by_branch)
    covers = Covers(index, analyst.domain)
    without_default = {topic for branch in branches for topic in branch.settings}.difference(defaults)
    gaps = (analyst.gap(topic, covers) for topic in sorted(without_default))
    shadows = [shadow for branch in possible for shadow in analyst.shadows(branch, covers)]
    shadowed = {shadow.branch.order for shadow in shadows}
    effort = Effort(LOOKS_AT_REDUNDANT_RATES)
    redundant = redundant_rates(possible, branches, defaults, floors, effort)
    conflicts = [found for branch in possible for found in analyst.conflicts(branch, index)]
    return Analysis(
        truths=truths,
        clashes=tuple(found for found in conflicts if isinstance(found, Clash)),
        shared_borders=tuple(found for found in conflicts if isinstance(found, SharedBorder)),
        shadows=tuple(shadows),
        gaps=tuple(gap for gap in gaps if gap is not None),
        redundant_rates=tuple(
            redundant_rate for redundant_rate in redundant if redundant_rate.branch.order not in shadowed
        ),
        unfinished=analyst.unfinished,
    )


class _Analyst:
    """Asks one question at a time, and notes the blocks about which one was given up."""

    def __init__(
        self, blocks: Sequence[ResolvedBlock], *, domain: Domain, is_noisy: Callable[[Signal], bool]
    ) -> None:
        self._blocks = blocks
        self.domain = domain
        self._is_noisy = is_noisy
        self._effort = Effort(LOOKS_IN_ALL)
        self._unfinished: set[int] = set()

    @property
    def unfinished(self) -> tuple[ResolvedBlock, ...]:
        return tuple(self._blocks[order] for order in sorted(self._unfinished))

    def truth(self, block: ResolvedBlock, where_true: ConditionBoxes) -> Truth:
        if where_true.is_exact and not where_true.boxes:
            return Truth.FALSE
        try:
            if where_true.sure_box is not None:
                return Truth.TRUE if self._is_everywhere(where_true, block) else Truth.UNKNOWN
        except TooComplexError:
            pass
        self._unfinished.add(block.order)
        return Truth.UNKNOWN

    def boxes(self, form: Form) -> ConditionBoxes:
        return boxes_of(form, self.domain, self._question())

    def conflicts(self, branch: Branch, index: BranchIndex) -> Iterator[Clash | SharedBorder]:
        conflicts = ConflictFinder(
            index, domain=self.domain, is_noisy=self._is_noisy, effort=self._question()
        )
        for count, found in enumerate(self._until_too_complex(branch, conflicts.of(branch)), start=1):
            yield found
            if isinstance(found, SharedBorder) or count == MAX_CLASHES_SHOWN:
                return

    def shadows(self, branch: Branch, covers: Covers) -> Iterator[Shadow]:
        return self._until_too_complex(branch, self._shadows(branch, covers))

    def gap(self, topic: str, covers: Covers) -> Gap | None:
        try:
            cover = covers.of(None, topic, lambda _: True, self._question())
        except TooComplexError:
            return Gap(topic=topic, state=None)
        return None if cover.gap is None else Gap(topic=topic, state=dict(sorted(cover.gap.items())))

    def _is_everywhere(self, where_true: ConditionBoxes, block: ResolvedBlock) -> bool:
        if where_true.is_exact and len(where_true.boxes) == 1:
            return all(
                is_part_of(self.domain(signal), region) for signal, region in where_true.boxes[0].items()
            )
        return find_box([negation(block.form)], self.domain, self._question()) is None

    def _shadows(self, branch: Branch, covers: Covers) -> Iterator[Shadow]:
        rivals: dict[int, Branch] = {}
        for topic in branch.settings:
            is_rival = partial(wins_over, loser=branch, topic=topic)
            cover = covers.of(branch, topic, is_rival, self._question())
            if cover.gap is not None:
                return
            rivals.update((rival.order, rival) for rival in cover.branches)
        yield Shadow(branch=branch, rivals=tuple(rivals[order] for order in sorted(rivals)))

    def _question(self) -> Effort:
        return Effort(LOOKS_AT_A_QUESTION, self._effort)

    def _until_too_complex(self, branch: Branch, found: Iterator[_T]) -> Iterator[_T]:
        try:
            yield from found
        except TooComplexError:
            self._unfinished.add(branch.block.order)


def wins_over(winner: Branch, loser: Branch, topic: str) -> bool:
    """Whether ``winner`` decides ``topic`` wherever both apply: by priority, rate, then order in the file."""
    if winner.block.priority != loser.block.priority:
        return winner.block.priority > loser.block.priority
    rate, losing_rate = winner.rate(topic), loser.rate(topic)
    if rate is None or losing_rate is None:
        return False
    return (rate, -winner.order) > (losing_rate, -loser.order)
