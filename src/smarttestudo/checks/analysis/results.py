# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The results of the interval analysis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from smarttestudo.domain.signal import Signal, Truth, Value
from smarttestudo.language.boxes import Border
from smarttestudo.language.resolved_rules import Branch, ResolvedBlock, ResolvedRate

State = Mapping[Signal, Value]
"""Values of signals; what is said about a state holds for any values of the other signals."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Clash:
    """Two branches of one priority that both apply in ``state`` and set ``topics`` to different rates."""

    first: Branch
    second: Branch
    topics: tuple[str, ...]
    state: State


@dataclass(frozen=True, slots=True, kw_only=True)
class SharedBorder:
    """Two branches that never apply together, meet at ``border`` and set ``topics`` to different rates."""

    first: Branch
    second: Branch
    topics: tuple[str, ...]
    border: Border


@dataclass(frozen=True, slots=True, kw_only=True)
class Shadow:
    """A branch that never decides a topic, because one of ``rivals`` does wherever it applies."""

    branch: Branch
    rivals: tuple[Branch, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Gap:
    """A topic without a default that no branch sets in ``state`` (``None``: not found out where)."""

    topic: str
    state: State | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RedundantRate:
    """A rate that ``branch`` sets and that holds without it as well, because it is the default's."""

    branch: Branch
    setting: ResolvedRate
    default: ResolvedRate


@dataclass(frozen=True, slots=True, kw_only=True)
class Analysis:
    """Facts about all states in which every signal is known.

    ``truths`` says of each block, by order, whether its condition never (FALSE), always (TRUE) or sometimes
    holds. ``unfinished`` are the blocks that were too complex to say everything about. ``redundant_rates``
    hold for states with unknown signals as well; a shadowed branch has none.
    """

    truths: Mapping[int, Truth]
    clashes: tuple[Clash, ...]
    shared_borders: tuple[SharedBorder, ...]
    shadows: tuple[Shadow, ...]
    gaps: tuple[Gap, ...]
    redundant_rates: tuple[RedundantRate, ...]
    unfinished: tuple[ResolvedBlock, ...]
