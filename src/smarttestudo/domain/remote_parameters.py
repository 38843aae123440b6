# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of other nodes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.parameter import ParameterValue

Values = Mapping[str, ParameterValue]
Got = Callable[[Values | RosError], None]
"""Takes the values of parameters, or why there are none."""

Refusals = Mapping[str, str]
WasSet = Callable[[Refusals | RosError], None]
"""Takes the parameters that the node refused to set with its reasons, or why nothing is known of it."""


class SilentNodeError(RosError):
    """A node that does not answer: it never was there, it is gone, or it cannot be reached."""


class RemoteParameters(Protocol):
    """Asks other nodes; answers come within ``Robot.wait``, each once.

    A node that does not answer in time gives a ``SilentNodeError``; what it was asked to do may still happen.
    """

    def get(self, node: str, names: Sequence[str], got: Got) -> None:
        """The values of parameters of ``node``; one that it does not have is ``None``."""

    def set(self, node: str, values: Values, was_set: WasSet) -> None:
        """Have ``node`` give its parameters these values, each by itself."""
