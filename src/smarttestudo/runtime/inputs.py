# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a live loop was given, so that it can be given it again. Stamps are the loop's own time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from smarttestudo.domain.observation import SourceChanged
from smarttestudo.pacing.sample import WhenSlow


@dataclass(frozen=True, slots=True, kw_only=True)
class RulesInput:
    """Rules came into force; the first input of a log, and one for each reload.

    ``rule_texts`` are the rule files by path, ``profile_text`` the profile's TOML, ``names`` the full name
    of each topic in them by the name that they use. For want of rules, every message of ``relay_all`` passes.
    """

    stamp_ns: int
    rule_texts: Mapping[str, str]
    profile_text: str | None = None
    names: Mapping[str, str] = field(default_factory=dict)
    when_slow: WhenSlow = WhenSlow.PASS
    budget_kb_per_s: float | None = None
    relay_all: tuple[str, ...] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageInput:
    """A message arrived. ``payload`` is there where checks read fields of the topic.

    ``decodable`` is false where the robot could not decode it; ``publisher`` numbers the publishers of a
    topic where they were told apart.
    """

    stamp_ns: int
    topic: str
    size_bytes: int
    payload: bytes | None = None
    decodable: bool = True
    publisher: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceInput:
    """The publishers of a topic changed."""

    stamp_ns: int
    change: SourceChanged


@dataclass(frozen=True, slots=True, kw_only=True)
class BudgetInput:
    """The link carries another budget, in KB/s."""

    stamp_ns: int
    budget_kb_per_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class WakeInput:
    """Time passed."""

    stamp_ns: int


LoopInput = RulesInput | MessageInput | SourceInput | BudgetInput | WakeInput
