# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What every ``Robot`` has and the tests of what runs on one never ask for."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence

from smarttestudo.domain.parameter import (
    Accept,
    Parameter,
    ParameterValue,
    Refusals,
    RemoteParameters,
    Values,
)
from smarttestudo.domain.robot import Called, Endpoint, Publisher, Qos


class UnaskedRobot:
    """What a robot in memory has none of: parameters, services, and nodes that listen to operators.

    Asking for them fails the test.
    """

    is_time_simulated = False
    fed_nodes: frozenset[str] = frozenset()
    doubted_nodes: frozenset[str] = frozenset()
    senders_remedy: str | None = None

    def players(self, nodes: Collection[str]) -> frozenset[str]:
        return frozenset()

    def local_subscriber_count(self, topic: str) -> int:
        raise NotImplementedError

    def own_subscribers(self, topic: str) -> Sequence[Endpoint]:
        raise NotImplementedError

    def own_publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        raise NotImplementedError

    def definition(self, type_name: str) -> str:
        raise NotImplementedError

    def declare(self, parameters: Sequence[Parameter], accept: Accept) -> Mapping[str, ParameterValue]:
        raise NotImplementedError

    def show(self, name: str, value: ParameterValue) -> None:
        raise NotImplementedError

    def parameters(self, names: Sequence[str]) -> Values:
        raise NotImplementedError

    def set_parameters(self, values: Values) -> Refusals:
        raise NotImplementedError

    def offer_trigger(self, name: str, act: Callable[[], str]) -> None:
        raise NotImplementedError

    @property
    def remote_parameters(self) -> RemoteParameters:
        raise NotImplementedError

    def call_service(self, service: str, *, argument: bool | None, called: Called) -> None:
        raise NotImplementedError
