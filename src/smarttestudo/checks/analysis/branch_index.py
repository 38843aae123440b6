# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where branches apply, which are near a place, and whether they cover all states."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from smarttestudo.checks.analysis.results import State
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal, Value
from smarttestudo.language.boxes import (
    Box,
    BoxIndex,
    Domain,
    Effort,
    Hull,
    IndexEntry,
    Interval,
    TooComplexError,
    boxes_where,
    find_box,
    hull_of,
    meets,
)
from smarttestudo.language.normal_form import Every, Form, InRegion, holds, negation
from smarttestudo.language.resolved_rules import Branch
from smarttestudo.language.text_region import SetOfValues, common

MAX_BOXES = 64


@dataclass(frozen=True, slots=True, kw_only=True)
class ConditionBoxes:
    """The boxes where a condition holds; around them only, where ``is_exact`` is false.

    ``sure_box`` is the first box in all of which it holds, ``None`` where none was found; ``hulls`` are those
    of ``boxes``.
    """

    boxes: tuple[Box, ...]
    hulls: tuple[Hull, ...]
    is_exact: bool
    sure_box: Box | None


def boxes_of(form: Form, domain: Domain, effort: Effort) -> ConditionBoxes:
    """Where ``form`` holds, as at most ``MAX_BOXES`` boxes; one around them all where they are more."""
    boxes: list[Box] = []
    is_exact = False
    try:
        for box in itertools.islice(boxes_where([form], domain, effort), MAX_BOXES + 1):
            boxes.append(box)  # noqa: PERF402 - what was found counts when the effort is spent
        is_exact = len(boxes) <= MAX_BOXES
    except TooComplexError:
        pass
    around = tuple(boxes) if is_exact else (_box_around(form, domain),)
    return ConditionBoxes(
        boxes=around,
        hulls=tuple(map(hull_of, around)),
        is_exact=is_exact,
        sure_box=boxes[0] if boxes else None,
    )


def _box_around(form: Form, domain: Domain) -> Box:
    parts = form.parts if isinstance(form, Every) else (form,)
    around: dict[Signal, SetOfValues] = {}
    for part in parts:
        if isinstance(part, InRegion):
            known = around.get(part.signal, domain(part.signal))
            around[part.signal] = common(known, part.region)
    return {signal: region for signal, region in around.items() if not region.is_empty}


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicBranches:
    """The branches that set all of some topics, by place.

    ``kinds`` has equal numbers for branches, by order, that set equal rates; they are the kinds of entries.
    """

    kinds: Mapping[int, int]
    index: BoxIndex


class BranchIndex:
    """The boxes of all branches; topics that are set by the same branches share one index."""

    def __init__(self, branches: Sequence[Branch], boxes_by_branch: Mapping[int, ConditionBoxes]) -> None:
        self._branches = {branch.order: branch for branch in branches}
        self._boxes = boxes_by_branch
        setters: dict[str, list[int]] = {}
        for branch in branches:
            for topic in branch.settings:
                setters.setdefault(topic, []).append(branch.order)
        alike: dict[tuple[int, ...], list[str]] = {}
        for topic, orders in setters.items():
            alike.setdefault(tuple(orders), []).append(topic)
        self._by_topic: dict[str, TopicBranches] = {}
        for setting, topics in alike.items():
            near = self._topic_branches(setting, tuple(topics))
            self._by_topic.update(dict.fromkeys(topics, near))

    def boxes(self, branch: Branch) -> ConditionBoxes:
        """Where ``branch`` applies."""
        return self._boxes[branch.order]

    def topic_branches(self, branch: Branch) -> tuple[TopicBranches, ...]:
        """The branches that set the topics of ``branch``, once for topics that are set alike."""
        found = {id(setting): setting for setting in (self._by_topic[topic] for topic in branch.settings)}
        return tuple(found.values())

    def around(
        self, branch: Branch, hull: Hull, near: TopicBranches, effort: Effort
    ) -> Iterator[tuple[Branch, Box]]:
        """The branches near ``hull`` that set other rates than ``branch``, each with one of its boxes."""
        kind = near.kinds[branch.order]
        for entry in near.index.near(hull.get, effort, other_than=kind):
            yield self._branches[entry.owner], entry.box

    def setters(self, topic: str) -> Iterator[Branch]:
        """The branches that set ``topic``, in their order."""
        return (self._branches[order] for order in self._by_topic[topic].kinds)

    def setters_near(
        self, topic: str, interval_of: Callable[[Signal], Interval], effort: Effort
    ) -> Iterator[Branch]:
        """The branches near a place that set ``topic``."""
        for entry in self._by_topic[topic].index.near(interval_of, effort):
            yield self._branches[entry.owner]

    def _topic_branches(self, orders: Sequence[int], topics: tuple[str, ...]) -> TopicBranches:
        numbers: dict[tuple[Rate | None, ...], int] = {}
        kinds: dict[int, int] = {}
        entries: list[IndexEntry] = []
        for order in orders:
            kind = kinds[order] = numbers.setdefault(rates_set(self._branches[order], topics), len(numbers))
            boxes = self._boxes[order]
            entries.extend(
                IndexEntry(owner=order, kind=kind, box=box, hull=hull)
                for box, hull in zip(boxes.boxes, boxes.hulls, strict=True)
            )
        return TopicBranches(kinds=kinds, index=BoxIndex(entries))


def rates_set(branch: Branch, topics: Sequence[str]) -> tuple[Rate | None, ...]:
    """The rates that ``branch`` sets ``topics`` to."""
    return tuple(branch.rate(topic) for topic in topics)


MAX_BRANCHES_EXCLUDED = 100
MAX_BRANCHES_THINNED_OUT = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class Coverage:
    """A state that no branch covers; ``None`` where ``branches`` cover all states together."""

    gap: State | None
    branches: tuple[Branch, ...]


class Covers:
    """Finds out whether branches together cover all states in which something holds.

    It guesses a state, excludes the branch that applies there, and guesses again: mostly the first guess is
    good, so that of many branches few are looked at.
    """

    def __init__(self, index: BranchIndex, domain: Domain) -> None:
        self._index = index
        self._domain = domain
        self._usual_value = cache(lambda signal: domain(signal).sample())

    def of(
        self, covered: Branch | None, topic: str, is_counted: Callable[[Branch], bool], effort: Effort
    ) -> Coverage:
        """Whether wherever ``covered`` applies some counted branch applies that sets ``topic``.

        Without ``covered`` the question is about all states.
        Raises ``TooComplexError`` when ``effort`` is spent.
        """
        excluded: list[Branch] = []
        while len(excluded) < MAX_BRANCHES_EXCLUDED:
            box = self._box_outside(excluded, covered, effort)
            if box is None:
                return Coverage(gap=None, branches=self._needed(excluded, covered, effort))
            state = _FullState(box, self._usual_value)
            nearby = self._index.setters_near(topic, _Points(state).__getitem__, effort)
            counted = (branch for branch in nearby if is_counted(branch))
            applying = next((branch for branch in counted if holds(branch.form, state)), None)
            if applying is None:
                gap = state if covered is not None else self._telling_state(box, topic, effort)
                return Coverage(gap=gap, branches=())
            excluded.append(applying)
        raise TooComplexError

    def _telling_state(self, box: Box, topic: str, effort: Effort) -> State:
        """A state in ``box`` with only the signals that tell why no branch that sets ``topic`` applies."""
        state = _FullState(box, self._usual_value)
        points = _Points(state)
        for branch in self._index.setters(topic):
            hulls = self._index.boxes(branch).hulls
            effort.spend(len(hulls))
            if any(meets(hull, points.__getitem__) for hull in hulls):
                holds(branch.form, state)
        return state

    def _needed(
        self, covering: Sequence[Branch], covered: Branch | None, effort: Effort
    ) -> tuple[Branch, ...]:
        """The branches among few ``covering`` ones that cover by themselves."""
        needed = list(covering)
        if len(covering) <= MAX_BRANCHES_THINNED_OUT:
            for branch in covering:
                rest = [other for other in needed if other is not branch]
                if self._box_outside(rest, covered, effort) is None:
                    needed = rest
        return tuple(needed)

    def _box_outside(self, branches: Sequence[Branch], covered: Branch | None, effort: Effort) -> Box | None:
        """A box of ``covered`` in which none of ``branches`` applies."""
        forms = [negation(branch.form) for branch in branches]
        if covered is not None:
            sure_box = self._index.boxes(covered).sure_box
            if sure_box is not None and not branches:
                return sure_box
            forms.insert(0, covered.form)
        return find_box(forms, self._domain, effort)


_ANYWHERE: Interval = (-math.inf, math.inf)


class _FullState(dict[Signal, Value]):
    """A state in a box that gives a signal beyond the box its usual value when that is asked for."""

    def __init__(self, box: Box, usual_value: Callable[[Signal], Value]) -> None:
        super().__init__({signal: region.sample() for signal, region in box.items()})
        self._usual_value = usual_value

    def __missing__(self, signal: Signal) -> Value:
        value = self[signal] = self._usual_value(signal)
        return value


class _Points(dict[Signal, Interval]):
    """The values of a state as intervals, each made when it is first asked for."""

    def __init__(self, state: _FullState) -> None:
        super().__init__()
        self._state = state

    def __missing__(self, signal: Signal) -> Interval:
        value = self._state[signal]
        point = self[signal] = _ANYWHERE if isinstance(value, str) else (value, value)
        return point
