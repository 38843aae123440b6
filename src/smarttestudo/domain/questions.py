# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions to a robot over its link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.parameter import Values


@dataclass(frozen=True, slots=True, kw_only=True)
class GetParameters:
    """The values of these parameters; the answer is by name."""

    names: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class GetTopics:
    """Topics that the robot's own nodes publish; the answer is the types by topic."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SetParameters:
    """Give parameters these values, each by itself; the answer is the reasons of those that were refused."""

    values: Values


Question = GetParameters | GetTopics | SetParameters
Answer = Values


class Asked(Protocol):
    """A question that waits for its answer, which may be given once and by any thread."""

    @property
    def question(self) -> Question:
        """Question that was asked."""

    def answer(self, answer: Answer | TestudoError) -> None:
        """Answer it, or say why not; never waits for who asked."""
