# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The interval analysis of a rule set, bounded in time and memory."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from itertools import islice
from operator import attrgetter
from typing import Any, Generic, TypeVar

from smarttestudo.checks.analysis.branch_index import BranchIndex
from smarttestudo.checks.analysis.condition_boxes import ConditionBoxes, boxes_of
from smarttestudo.checks.analysis.conflict_finder import ConflictFinder
from smarttestudo.checks.analysis.cover import Covers
from smarttestudo.checks.analysis.redundant_rates import redundant_rates
from smarttestudo.checks.analysis.results import Analysis, Clash, Gap, Shadow, SharedBorder
from smarttestudo.checks.analysis.topic_branches import Setter
from smarttestudo.checks.context import CheckContext
from smarttestudo.domain.dataclass import dataclass
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
    analyst = _Analyst(recall, domain=cache(context.domain), is_noisy=cache(context.is_noisy))
    where_true = analyst.boxes("boxes", blocks)
    truths = analyst.truths(blocks, where_true)
    elses = [branch for branch in branches if branch.is_else]
    of_elses = iter(analyst.boxes("boxes of Else", elses))
    of_blocks = {block.order: boxes for block, boxes in zip(blocks, where_true, strict=True)}
    boxes = [next(of_elses) if one.is_else else of_blocks[one.block.order] for one in branches]
    setters = recall.each("setters", Setter, branches, boxes)
    possible = [one.branch for one in setters if one.boxes.boxes]
    index = BranchIndex(setters, recall)
    covers = Covers(index, analyst.domain)
    shadows = analyst.near("shadows", lambda one: analyst.shadows(one, covers), possible, index)
    shadowed = {shadow.branch.order for shadow in shadows}
    effort = Effort(LOOKS_AT_REDUNDANT_RATES)
    redundant = redundant_rates(possible, branches, defaults, floors, effort=effort, recall=recall)
    conflicts = analyst.near("conflicts", lambda one: analyst.conflicts(one, index), possible, index)
    gaps = [analyst.gap(topic, covers, index) for topic in sorted(index.topics - defaults.keys())]
    return Analysis(
        truths={block.order: truth for block, truth in zip(blocks, truths, strict=True)},
        clashes=tuple(found for found in conflicts if isinstance(found, Clash)),
        shared_borders=tuple(found for found in conflicts if isinstance(found, SharedBorder)),
        shadows=tuple(shadows),
        gaps=tuple(gap for gap in gaps if gap is not None),
        redundant_rates=tuple(one for one in redundant if one.branch.order not in shadowed),
        unfinished=tuple(block for block in blocks if block.order in analyst.unfinished),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Answer(Generic[_T]):
    """Findings on a question after so many looks; not all of them where it was given up."""

    found: _T
    is_whole: bool
    looks: int = 0


class _Analyst:
    """Asks one question at a time; ``unfinished`` are the orders of blocks about which one was given up."""

    def __init__(self, recall: Recall, *, domain: Domain, is_noisy: Callable[[Signal], bool]) -> None:
        self._recall = recall
        self.domain = domain
        self._is_noisy = is_noisy
        self._effort = Effort(LOOKS_IN_ALL)
        self.unfinished: set[int] = set()

    def boxes(
        self, name: str, wherever: Sequence[ResolvedBlock] | Sequence[Branch]
    ) -> Sequence[ConditionBoxes]:
        """Where the forms of ``wherever`` hold."""

        def ask(form: Form) -> _Answer[ConditionBoxes]:
            return _Answer(found=boxes_of(form, self.domain, self._question()), is_whole=True)

        return [answer.found for answer in self._asked(name, ask, [one.form for one in wherever])]

    def truths(
        self, blocks: Sequence[ResolvedBlock], where_true: Sequence[ConditionBoxes]
    ) -> Sequence[Truth]:
        """Whether each of ``blocks`` holds never, always or sometimes."""
        answers = self._asked("truths", self._truth, blocks, where_true)
        self._note(answers, blocks)
        return [answer.found for answer in answers]

    def near(
        self,
        name: str,
        ask: Callable[[Branch], _Answer[Sequence[_T]]],
        branches: Sequence[Branch],
        index: BranchIndex,
    ) -> Sequence[_T]:
        """The answers to a question about each branch and the branches near to it that set its topics."""
        touched = index.touched
        again = [at for at, branch in enumerate(branches) if branch.order in touched] if touched else ()
        answers = self._asked(name, ask, branches, again=again)
        self._note(answers, [branch.block for branch in branches])
        return [found for answer in answers for found in answer.found]

    def gap(self, topic: str, covers: Covers, index: BranchIndex) -> Gap | None:
        """Where no branch sets ``topic``."""
        setters = index.branches_of(topic).setters
        return self._asked(("gap", topic), lambda _: self._gap(topic, covers), [setters])[0].found

    def _asked(
        self,
        name: Hashable,
        ask: Callable[..., _Answer[_T]],
        *columns: Sequence[Any],
        again: Iterable[int] = (),
    ) -> Sequence[_Answer[_T]]:
        """The answers to a question about each row of ``columns``; the rows ``again`` are not recalled.

        Known ones count where as much effort is left as they cost.
        """
        answers: list[_Answer[_T]]
        answers, others = self._recall.known(name, *columns)
        behind = 0
        for at in (*sorted({*others, *again}), len(answers)):
            looks = sum(map(attrgetter("looks"), islice(answers, behind, at)))
            is_enough = looks <= self._effort.left
            if is_enough:
                self._effort.spend(looks)
            for row in range(at if is_enough else behind, min(at + 1, len(answers))):
                known = answers[row].looks if row < at else None
                if known is not None and known <= self._effort.left:
                    self._effort.spend(known)
                else:
                    answers[row] = self._new(ask, *(column[row] for column in columns))
            behind = at + 1
        return answers

    def _new(self, ask: Callable[..., _Answer[_T]], *things: Any) -> _Answer[_T]:
        left = self._effort.left
        answer = ask(*things)
        # One that was cut short by other questions is not known another time.
        looks = left - self._effort.left if self._effort.left >= 0 else LOOKS_IN_ALL + 1
        return replace(answer, looks=looks)

    def _note(self, answers: Iterable[_Answer[Any]], blocks: Iterable[ResolvedBlock]) -> None:
        pairs = zip(answers, blocks, strict=True)
        self.unfinished.update(block.order for answer, block in pairs if not answer.is_whole)

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

    def conflicts(self, branch: Branch, index: BranchIndex) -> _Answer[Sequence[Clash | SharedBorder]]:
        """The first clashes of ``branch`` with branches before it, else the first shared border."""
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

    def shadows(self, branch: Branch, covers: Covers) -> _Answer[Sequence[Shadow]]:
        """The shadow of ``branch``, if it never decides a topic."""
        return _until_too_complex(self._shadows(branch, covers))

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
