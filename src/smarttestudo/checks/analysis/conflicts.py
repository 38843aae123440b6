# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Branches that set different rates and apply together or meet, and rates that change nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet

from smarttestudo.checks.analysis.branch_index import BranchIndex
from smarttestudo.checks.analysis.results import Clash, RedundantRate, SharedBorder, State
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.signal import Signal
from smarttestudo.language.boxes import (
    Border,
    Box,
    Domain,
    Effort,
    TooComplexError,
    border_between,
    common_box,
    find_box,
)
from smarttestudo.language.normal_form import Every, Form, InRegion, Some, is_derived
from smarttestudo.language.resolved_rules import Branch, ResolvedFloor, ResolvedRate
from smarttestudo.language.text_region import common


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


def redundant_rates(
    possible: Sequence[Branch],
    branches: Sequence[Branch],
    defaults: Mapping[str, ResolvedRate],
    floors: Mapping[str, ResolvedFloor],
    effort: Effort,
) -> Iterator[RedundantRate]:
    """The rates of ``possible`` branches that equal their topic's default where none is overruled.

    Any of ``branches`` may be: one that never holds is feared all the same while its values are unknown.
    They can be removed all at once: what is asked of a rate is asked of others that differ from the default.
    Ends when ``effort`` is spent.
    """
    fixed = {topic: default.rate for topic, default in defaults.items() if default.margin is None}
    alike = _alike(fixed, possible)
    rivals = _rivals(branches, {setting.topic for _, setting in alike}, floors) if alike else {}
    try:
        for branch, setting in alike:
            topic, rate = setting.topic, setting.rate
            if rate is None or (rate.yields_to_floor and rate.hz < _floor_hz(floors.get(topic))):
                continue
            others = (
                other
                for (priority, raised), asking in rivals[topic].items()
                if _may_matter(rate, branch.block.priority, raised, priority)
                for other in asking
                if other is not branch
            )
            if all(excludes(other.form, branch.form, effort) for other in others):
                yield RedundantRate(branch=branch, setting=setting, default=defaults[topic])
    except TooComplexError:
        return


def _alike(
    rates: Mapping[str, Rate | None], branches: Sequence[Branch]
) -> Sequence[tuple[Branch, ResolvedRate]]:
    """The settings of ``branches`` to known ``rates``."""
    return [
        (branch, setting)
        for branch in branches
        for topic, setting in branch.settings.items()
        if setting.margin is None and setting.rate is not None and setting.rate == rates.get(topic)
    ]


_Stance = tuple[int, Rate | None]
"""The priority of a block, and its rate raised to the floor."""


def _rivals(
    branches: Sequence[Branch], topics: AbstractSet[str], floors: Mapping[str, ResolvedFloor]
) -> dict[str, dict[_Stance, list[Branch]]]:
    """The branches that set each of ``topics``, by what they ask for: few ask for different things."""
    rivals: dict[str, dict[_Stance, list[Branch]]] = {}
    for branch in branches:
        for topic in branch.settings.keys() & topics:
            rate = branch.rate(topic)
            raised = None if rate is None else rate.at_least(_floor_hz(floors.get(topic)))
            alike = rivals.setdefault(topic, {}).setdefault((branch.block.priority, raised), [])
            alike.append(branch)
    return rivals


def _floor_hz(floor: ResolvedFloor | None) -> float:
    return 0.0 if floor is None else floor.rate.hz


def _may_matter(mine: Rate, my_priority: int, raised: Rate | None, priority: int) -> bool:
    """Whether ``mine``, which is the default's, can change what a block with the other rate makes of a topic.

    It does where it overrules a lower rate, known or in doubt, and where it keeps a higher rate of lower
    priority from being feared; unless the two conditions exclude each other.
    """
    if priority > my_priority or raised == mine:
        return False
    return raised is None or raised < mine or priority < my_priority


def excludes(first: Form, second: Form, effort: Effort) -> bool:
    """Whether ``second`` is known to be false wherever ``first`` is known to hold, unknown values included.

    It looks for values of one signal that both need and cannot both have; ``False`` may be either.
    Raises ``TooComplexError`` when ``effort`` is spent.
    """
    effort.spend(1)
    if isinstance(first, Some):
        return all(excludes(part, second, effort) for part in first.parts)
    if isinstance(second, Some):
        return all(excludes(first, part, effort) for part in second.parts)
    if isinstance(first, Every):
        return any(excludes(part, second, effort) for part in first.parts)
    if isinstance(second, Every):
        return any(excludes(first, part, effort) for part in second.parts)
    return _are_apart(first, second)


def _are_apart(first: InRegion, second: InRegion) -> bool:
    return first.signal == second.signal and common(first.region, second.region).is_empty
