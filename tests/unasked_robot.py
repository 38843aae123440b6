# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What every ``Robot`` has and the tests of what runs on one never ask for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from smarttestudo.domain.parameter import Accept, Parameter, ParameterValue, RemoteParameters


class UnaskedRobot:
    """The parameters and services of a robot in memory: it has none, and asking for them fails the test."""

    def declare(self, parameters: Sequence[Parameter], accept: Accept) -> Mapping[str, ParameterValue]:
        raise NotImplementedError

    def show(self, name: str, value: ParameterValue) -> None:
        raise NotImplementedError

    def offer_trigger(self, name: str, act: Callable[[], str]) -> None:
        raise NotImplementedError

    @property
    def remote_parameters(self) -> RemoteParameters:
        raise NotImplementedError
