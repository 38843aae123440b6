# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The interval analysis of a rule set, bounded in time and memory."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Generic, TypeVar

from smarttestudo.checks.analysis.branch_index import BranchIndex
from smarttestudo.checks.analysis.condition_boxes import ConditionBoxes, boxes_of
from smarttestudo.checks.analysis.conflict_finder import ConflictFinder
from smarttestudo.checks.analysis.cover import Covers
from smarttestudo.checks.analysis.redundant_rates import redundant_rates
from smarttestudo.checks.analysis.results import Analysis, Clash, Gap, Shadow, SharedBorder
from smarttestudo.checks.context import CheckContext
from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.language.boxes import Domain, Effort, TooComplexError, find_box
from smarttestudo.language.normal_form import Form, negation
from smarttestudo.language.recall import Recall
from smarttestudo.language.resolved_rules import Branch, ResolvedBlock, ResolvedFloor, ResolvedRate

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
    *,
    recall: Recall,
) -> Analysis:
    """The analysis of the conditions of ``blocks``; ``defaults`` and ``floors`` are by topic.

    Of each branch the first clashes with branches before it are found, or else the first shared border.
    A question about blocks that ``recall`` has met costs the effort that it cost then, but no time.
    """
    analyst = _Analyst(blocks, recall, domain=cache(context.domain), is_noisy=cache(context.is_noisy))
    where_true = {block.order: analyst.boxes(block.form) for block in blocks}
    truths = {block.order: analyst.truth(block, where_true[block.order]) for block in blocks}
    boxes_by_branch = {
        branch.order: analyst.boxes(branch.form) if branch.is_else else where_true[branch.block.order]
        for branch in branches
    }
    possible = [branch for branch in branches if boxes_by_branch[branch.order].boxes]
    index = BranchIndex(branches, boxes_by_branch, recall)
    covers = Covers(index, analyst.domain)
    without_default = {topic for branch in branches for topic in branch.settings}.difference(defaults)
    gaps = (analyst.gap(topic, covers, index) for topic in sorted(without_default))
    shadows = [shadow for branch in possible for shadow in analyst.shadows(branch, covers, index)]
    shadowed = {shadow.branch.order for shadow in shadows}
    redundant = redundant_rates(possible, defaults, floors, Effort(LOOKS_AT_REDUNDANT_RATES))
    conflicts = [found for branch in possible for found in analyst.conflicts(branch, index)]
    return Analysis(
        truths=truths,
        clashes=tuple(found for found in conflicts if isinstance(found, Clash)),
        shared_borders=tuple(found for found in conflicts if isinstance(found, SharedBorder)),
        shadows=tuple(shadows),
        gaps=tuple(gap for gap in gaps if gap is not None),
        redundant_rates=tuple(one for one in redundant if one.branch.order not in shadowed),
        unfinished=analyst.unfinished,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Answer(Generic[_T]):
    """Findings on a question after so many looks; not all of them where it was given up."""

    found: _T
    is_whole: bool
    looks: int = 0


class _Analyst:
    """Asks one question at a time, and notes the blocks about which one was given up."""

    def __init__(
        self,
        blocks: Sequence[ResolvedBlock],
        recall: Recall,
        *,
        domain: Domain,
        is_noisy: Callable[[Signal], bool],
    ) -> None:
        self._blocks = blocks
        self._recall = recall
        self.domain = domain
        self._is_noisy = is_noisy
        self._effort = Effort(LOOKS_IN_ALL)
        self._unfinished: set[int] = set()

    @property
    def unfinished(self) -> tuple[ResolvedBlock, ...]:
        return tuple(self._blocks[order] for order in sorted(self._unfinished))

    def truth(self, block: ResolvedBlock, where_true: ConditionBoxes) -> Truth:
        answer = self._asked("truth", lambda: self._truth(block, where_true), block, where_true)
        return self._noted(answer, block)

    def boxes(self, form: Form) -> ConditionBoxes:
        def answer() -> _Answer[ConditionBoxes]:
            return _Answer(found=boxes_of(form, self.domain, self._question()), is_whole=True)

        return self._asked("boxes", answer, form).found

    def conflicts(self, branch: Branch, index: BranchIndex) -> Sequence[Clash | SharedBorder]:
        def ask() -> _Answer[Sequence[Clash | SharedBorder]]:
            return self._conflicts(branch, index)

        return self._noted(self._asked_near("conflicts", ask, branch, index), branch.block)

    def shadows(self, branch: Branch, covers: Covers, index: BranchIndex) -> Sequence[Shadow]:
        def ask() -> _Answer[Sequence[Shadow]]:
            return _until_too_complex(self._shadows(branch, covers))

        return self._noted(self._asked_near("shadows", ask, branch, index), branch.block)

    def gap(self, topic: str, covers: Covers, index: BranchIndex) -> Gap | None:
        version = index.branches_of(topic).version
        return self._asked("gap", lambda: self._gap(topic, covers), version, key=topic).found

    def _asked(
        self, name: str, ask: Callable[[], _Answer[_T]], *things: object, key: object = None
    ) -> _Answer[_T]:
        """The answer to a question about ``things``."""
        known = self._recall.get(name, *things, key=key)
        answer = self._answer(known, ask)
        self._recall.keep(answer, name, *things, key=key)
        return answer

    def _asked_near(
        self, name: str, ask: Callable[[], _Answer[_T]], branch: Branch, index: BranchIndex
    ) -> _Answer[_T]:
        """The answer to a question about ``branch`` and the branches near to it that set its topics."""
        near = index.topic_branches(branch)
        versions, known = self._recall.get(name, branch) or ((), None)
        is_alike = len(versions) == len(near) and all(
            one.is_as_in(version, branch) for one, version in zip(near, versions, strict=True)
        )
        answer = self._answer(known if is_alike else None, ask)
        self._recall.keep((tuple(one.version for one in near), answer), name, branch)
        return answer

    def _answer(self, known: _Answer[_T] | None, ask: Callable[[], _Answer[_T]]) -> _Answer[_T]:
        """A ``known`` answer where as much effort is left as it cost, else a new one."""
        left = self._effort.left
        if known is not None and known.looks <= left:
            self._effort.spend(known.looks)
            return known
        answer = ask()
        # One that was cut short by other questions is not known another time.
        looks = left - self._effort.left if self._effort.left >= 0 else LOOKS_IN_ALL + 1
        return replace(answer, looks=looks)

    def _noted(self, answer: _Answer[_T], block: ResolvedBlock) -> _T:
        if not answer.is_whole:
            self._unfinished.add(block.order)
        return answer.found

    def _truth(self, block: ResolvedBlock, where_true: ConditionBoxes) -> _Answer[Truth]:
        if where_true.is_exact and not where_true.boxes:
            return _Answer(found=Truth.FALSE, is_whole=True)
        try:
            if where_true.sure_box is not None:
                truth = Truth.TRUE if self._is_everywhere(where_true, block) else Truth.UNKNOWN
                return _Answer(found=truth, is_whole=True)
        except TooComplexError:
            pass
        return _Answer(found=Truth.UNKNOWN, is_whole=False)

    def _conflicts(self, branch: Branch, index: BranchIndex) -> _Answer[Sequence[Clash | SharedBorder]]:
        conflicts = ConflictFinder(
            index, domain=self.domain, is_noisy=self._is_noisy, effort=self._question()
        )
        return _until_too_complex(_first_few(conflicts.of(branch)))

    def _gap(self, topic: str, covers: Covers) -> _Answer[Gap | None]:
        try:
            cover = covers.of(None, topic, lambda _: True, self._question())
        except TooComplexError:
            return _Answer(found=Gap(topic=topic, state=None), is_whole=True)
        gap = None if cover.gap is None else Gap(topic=topic, state=dict(sorted(cover.gap.items())))
        return _Answer(found=gap, is_whole=True)

    def _is_everywhere(self, where_true: ConditionBoxes, block: ResolvedBlock) -> bool:
        if where_true.is_exact and len(where_true.boxes) == 1:
            return all(
                self.domain(signal).is_within(region) for signal, region in where_true.boxes[0].items()
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


def _until_too_complex(asked: Iterator[_T]) -> _Answer[Sequence[_T]]:
    found: list[_T] = []
    try:
        for one in asked:
            found.append(one)  # noqa: PERF402 - what was found counts when the effort is spent
    except TooComplexError:
        return _Answer(found=found, is_whole=False)
    return _Answer(found=found, is_whole=True)


def _first_few(conflicts: Iterator[Clash | SharedBorder]) -> Iterator[Clash | SharedBorder]:
    for count, found in enumerate(conflicts, start=1):
        yield found
        if isinstance(found, SharedBorder) or count == MAX_CLASHES_SHOWN:
            return


def wins_over(winner: Branch, loser: Branch, topic: str) -> bool:
    """Whether ``winner`` decides ``topic`` wherever both apply: by priority, rate, then order in the file."""
    if winner.block.priority != loser.block.priority:
        return winner.block.priority > loser.block.priority
    rate, losing_rate = winner.rate(topic), loser.rate(topic)
    if rate is None or losing_rate is None:
        return False
    return (rate, -winner.order) > (losing_rate, -loser.order)
