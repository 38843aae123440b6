# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whether branches together cover all states in which something holds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from smarttestudo.adirf.boxes import Box, Domain, Effort, TooComplexError, find_box
from smarttestudo.adirf.boxes.index import Interval
from smarttestudo.adirf.checks.analysis.atlas import Atlas
from smarttestudo.adirf.checks.analysis.results import State
from smarttestudo.adirf.checks.written import Branch
from smarttestudo.adirf.normal_form import Form, holds, negation
from smarttestudo.domain.signal import Signal

MAX_BRANCHES_EXCLUDED = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class Coverage:
    """A state that ``branches`` and their likes leave uncovered; ``None`` where ``branches`` leave none."""

    gap: State | None
    branches: tuple[Branch, ...]


def coverage(
    forms: Sequence[Form],
    topic: str,
    is_counted: Callable[[Branch], bool],
    *,
    atlas: Atlas,
    domain: Domain,
    effort: Effort,
) -> Coverage:
    """Whether wherever ``forms`` hold some counted branch applies that sets ``topic``.

    Guesses a state, excludes the branch that applies there, and guesses again: mostly the first guess is
    good, so that of many branches few are looked at. Raises ``TooComplexError`` when ``effort`` is spent.
    """
    excluded: list[Branch] = []
    while len(excluded) < MAX_BRANCHES_EXCLUDED:
        box = find_box([*forms, *(negation(branch.form) for branch in excluded)], domain, effort)
        if box is None:
            return Coverage(gap=None, branches=tuple(excluded))
        state = _FullState(box, domain)
        nearby = atlas.setters_near(topic, state.interval_of, effort)
        applying = next(
            (branch for branch in nearby if is_counted(branch) and holds(branch.form, state)), None
        )
        if applying is None:
            return Coverage(gap=dict(sorted(state.items())), branches=tuple(excluded))
        excluded.append(applying)
    raise TooComplexError


class _FullState(dict[Signal, float]):
    """A state in a box that gives a signal beyond the box a value when that is asked for."""

    def __init__(self, box: Box, domain: Domain) -> None:
        super().__init__({signal: region.sample() for signal, region in box.items()})
        self._domain = domain

    def __missing__(self, signal: Signal) -> float:
        value = self[signal] = self._domain(signal).sample()
        return value

    def interval_of(self, signal: Signal) -> Interval:
        """The one value of ``signal``."""
        return self[signal], self[signal]
