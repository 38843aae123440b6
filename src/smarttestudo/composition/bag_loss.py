# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the operator lost between two recordings of one run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from smarttestudo.adirf.rule_set import RuleSet
from smarttestudo.domain.profile import Profile
from smarttestudo.visualizer.loss.report import LossReport


def _ignore(_: float) -> None:
    """Nobody wants to know."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LossQuestion:
    """What is asked of two recordings.

    ``mapping`` pairs topics as for ``compare_bags``. ``topics`` are names or patterns, empty for all;
    ``fields`` are more fields than the default ones, by topic of A. ``rule_set`` gives the thresholds,
    ``profile`` tiers and priorities for the third arm. ``report`` is told the share done, 0 … 1.
    """

    mapping: Mapping[str, str] = field(default_factory=dict)
    topics: Sequence[str] = ()
    fields: Mapping[str, Sequence[str]] = field(default_factory=dict)
    rule_set: RuleSet | None = None
    profile: Profile = field(default_factory=Profile)
    report: Callable[[float], None] = _ignore


def measure_loss(a: Path, b: Path, question: LossQuestion | None = None) -> LossReport:
    """The loss between ``a``, as sent, and ``b``, as received.

    Raises:
        RecordingError: one cannot be read or is empty; they share no topic or no time; a field or topic that
            was asked for does not exist.
    """
    raise NotImplementedError
