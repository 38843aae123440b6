# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whether branches together cover all states in which something holds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache

from smarttestudo.adirf.boxes import Box, Domain, Effort, TooComplexError, find_box
from smarttestudo.adirf.boxes.index import Interval
from smarttestudo.adirf.checks.analysis.atlas import Atlas
from smarttestudo.adirf.checks.analysis.results import State
from smarttestudo.adirf.checks.written import Branch
from smarttestudo.adirf.normal_form import Form, holds, negation
from smarttestudo.domain.signal import Signal

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

    def __init__(self, atlas: Atlas, domain: Domain) -> None:
        self._atlas = atlas
        self._domain = domain
        self._usual_value = cache(lambda signal: domain(signal).sample())

    def of(
        self, forms: Sequence[Form], topic: str, is_counted: Callable[[Branch], bool], effort: Effort
    ) -> Coverage:
        """Whether wherever ``forms`` hold some counted branch applies that sets ``topic``.

        Raises ``TooComplexError`` when ``effort`` is spent.
        """
        excluded: list[Branch] = []
        while len(excluded) < MAX_BRANCHES_EXCLUDED:
            box = self._box_outside(excluded, forms, effort)
            if box is None:
                return Coverage(gap=None, branches=self._needed(excluded, forms, effort))
            state = _FullState(box, self._usual_value)
            nearby = self._atlas.setters_near(topic, state.interval_of, effort)
            counted = (branch for branch in nearby if is_counted(branch))
            applying = next((branch for branch in counted if holds(branch.form, state)), None)
            if applying is None:
                return Coverage(gap=dict(sorted(state.items())), branches=())
            excluded.append(applying)
        raise TooComplexError

    def _needed(
        self, covering: Sequence[Branch], forms: Sequence[Form], effort: Effort
    ) -> tuple[Branch, ...]:
        """Those of few ``covering`` branches that cover by themselves."""
        needed = list(covering)
        if len(covering) <= MAX_BRANCHES_THINNED_OUT:
            for branch in covering:
                rest = [other for other in needed if other is not branch]
                if self._box_outside(rest, forms, effort) is None:
                    needed = rest
        return tuple(needed)

    def _box_outside(self, branches: Iterable[Branch], forms: Sequence[Form], effort: Effort) -> Box | None:
        return find_box([*forms, *(negation(branch.form) for branch in branches)], self._domain, effort)


class _FullState(dict[Signal, float]):
    """A state in a box that gives a signal beyond the box its usual value when that is asked for."""

    def __init__(self, box: Box, usual_value: Callable[[Signal], float]) -> None:
        super().__init__({signal: region.sample() for signal, region in box.items()})
        self._usual_value = usual_value

    def __missing__(self, signal: Signal) -> float:
        value = self[signal] = self._usual_value(signal)
        return value

    def interval_of(self, signal: Signal) -> Interval:
        """The one value of ``signal``."""
        return self[signal], self[signal]
