# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whether branches together cover all states in which something holds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

from smarttestudo.checks.analysis.branch_index import BranchIndex
from smarttestudo.checks.analysis.results import State
from smarttestudo.domain.signal import Signal
from smarttestudo.language.boxes import Box, Domain, Effort, Interval, TooComplexError, find_box, meets
from smarttestudo.language.normal_form import holds, negation
from smarttestudo.language.resolved_rules import Branch

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
        self,
        covered: Branch | None,
        topic: str,
        is_counted: Callable[[Branch], bool],
        effort: Effort,
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


class _FullState(dict[Signal, float]):
    """A state in a box that gives a signal beyond the box its usual value when that is asked for."""

    def __init__(self, box: Box, usual_value: Callable[[Signal], float]) -> None:
        super().__init__({signal: region.sample() for signal, region in box.items()})
        self._usual_value = usual_value

    def __missing__(self, signal: Signal) -> float:
        value = self[signal] = self._usual_value(signal)
        return value


class _Points(dict[Signal, Interval]):
    """The values of a state as intervals, each made when it is first asked for."""

    def __init__(self, state: _FullState) -> None:
        super().__init__()
        self._state = state

    def __missing__(self, signal: Signal) -> Interval:
        value = self._state[signal]
        point = self[signal] = (value, value)
        return point
