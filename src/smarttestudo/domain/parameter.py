# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of nodes: of our own, by which a robot is set up and changed from afar, and of others."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

from smarttestudo.domain.errors import RosError, TestudoError

ParameterValue = bool | int | float | str | tuple[str, ...] | None
"""``None`` is a parameter that is not set. ROS has more types; a value of those comes as text."""

Accept = Callable[[Mapping[str, ParameterValue]], None]
"""Takes parameters that somebody sets together; a ``TestudoError`` refuses all of them and says why."""


class Access(Enum):
    """Access to a parameter once the node runs: who may change it."""

    NOBODY = "nobody"
    ANYONE = "anyone"
    NODE = "node"


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """``value`` counts where the node's start-up gives no other, or, if it ``is_final``, always.

    ``is_typed``: only values of the type of ``value`` are taken.
    """

    name: str
    description: str
    value: ParameterValue
    access: Access = Access.NOBODY
    is_final: bool = False
    is_typed: bool = True


Values = Mapping[str, ParameterValue]
Got = Callable[[Values | TestudoError], None]
"""Takes the values of parameters, or why there are none."""

Refusals = Mapping[str, str]
WasSet = Callable[[Refusals | TestudoError], None]
"""Takes the parameters that the node refused to set with its reasons, or why nothing is known of it."""


class SilentNodeError(RosError):
    """A node or a robot that does not answer: it never was there, it is gone, or it cannot be reached."""


class RemoteParameters(Protocol):
    """Asks other nodes; answers come within ``Robot.wait``, each once.

    A node that does not answer in time gives a ``SilentNodeError``; what it was asked to do may still happen.
    """

    def get(self, node: str, names: Sequence[str], got: Got) -> None:
        """The values of parameters of ``node``; one that it does not have is ``None``."""

    def set(self, node: str, values: Values, was_set: WasSet) -> None:
        """Have ``node`` give its parameters these values, each by itself."""


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
    def question(self) -> Question: ...

    def answer(self, answer: Answer | TestudoError) -> None:
        """Answer it, or say why not; never waits for who asked."""
