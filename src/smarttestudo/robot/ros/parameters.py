# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of our node, and of others."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import rclpy.parameter
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.exceptions import NameValidationException, ParameterException

from smarttestudo.domain.errors import RosError, UsageError, said
from smarttestudo.domain.parameter import (
    Accept,
    Access,
    Got,
    Parameter,
    ParameterValue,
    Refusals,
    SilentNodeError,
    Values,
    WasSet,
)
from smarttestudo.domain.texts import in_utf_8
from smarttestudo.robot.ros.ros_errors import ros_errors


class NodeParameters:
    """Declares parameters of a node and has their changes accepted."""

    def __init__(self, node: Any) -> None:
        self._node = node
        self._accept: Accept = _nothing
        self._access: dict[str, Access] = {}
        self._is_ours = False

    def declare(self, parameters: Sequence[Parameter], accept: Accept) -> Mapping[str, ParameterValue]:
        """Have these parameters, to be called once; their values. Raises ``UsageError`` for a wrong one."""
        values = {one.name: self._declared(one) for one in parameters}
        self._access = {one.name: one.access for one in parameters}
        self._accept = accept
        self._node.add_on_set_parameters_callback(self._asked)
        return values

    def show(self, name: str, value: ParameterValue) -> None:
        """Give a parameter another value without acceptance."""
        self._is_ours = True
        try:
            self._node.set_parameters([_parameter(name, value)])
        finally:
            self._is_ours = False

    def values(self, names: Sequence[str]) -> Values:
        """The values of declared parameters; ``None`` for others."""
        return {
            name: plain_value(self._node.get_parameter(name).value) if name in self._access else None
            for name in names
        }

    def set(self, values: Values) -> Refusals:
        """Set declared parameters as somebody on the graph may, each by itself; why some were refused."""
        refused = {}
        for name, value in values.items():
            if name not in self._access:
                refused[name] = str(UsageError("there is no such parameter", place=f"parameter {name[:80]}"))
                continue
            (result,) = self._node.set_parameters([_parameter(name, value)])
            if not result.successful:
                refused[name] = result.reason
        return refused

    def _declared(self, one: Parameter) -> ParameterValue:
        descriptor = ParameterDescriptor(
            description=one.description,
            read_only=one.access is Access.NOBODY,
            dynamic_typing=not one.is_typed,
        )
        try:
            declared = self._node.declare_parameter(
                one.name, _in_utf_8(one.value), descriptor, ignore_override=one.is_final
            )
        except ParameterException as error:
            raise UsageError(str(error), place=f"parameter {one.name}") from error
        # The node may only be able to show it: the name of a file is not always UTF-8.
        return one.value if one.is_final else plain_value(declared.value)

    def _asked(self, parameters: Sequence[Any]) -> Any:
        """Whether rclpy may give the parameters their new values."""
        changes = {one.name: plain_value(one.value) for one in parameters if one.name in self._access}
        if self._is_ours or not changes:
            return SetParametersResult(successful=True)
        try:
            self._require_settable(changes)
            self._accept(changes)
        except Exception as error:  # noqa: BLE001 - whoever sets a parameter must not end the run
            return SetParametersResult(successful=False, reason=said(error))
        return SetParametersResult(successful=True)

    def _require_settable(self, names: Iterable[str]) -> None:
        for name in names:
            if self._access[name] is Access.NODE:
                raise UsageError("it is read-only", place=f"parameter {name}")


def _nothing(_changes: Mapping[str, ParameterValue]) -> None:
    """Accept whatever is set while nothing is declared."""


def _parameter(name: str, value: ParameterValue) -> Any:
    return rclpy.parameter.Parameter(name, value=_in_utf_8(value))


def _in_utf_8(value: ParameterValue) -> ParameterValue:
    match value:
        case str():
            return in_utf_8(value)
        case tuple():
            return tuple(map(in_utf_8, value))
    return value


def plain_value(value: Any) -> ParameterValue:
    """A value of ROS as ours; one of a type that we lack as text."""
    if value is None or isinstance(value, bool | int | float | str):
        return value
    try:
        return tuple(map(str, value))
    except TypeError:
        return str(value)


REMOTE_POLL_PERIOD_S = 0.05
ANSWER_WITHIN_S = 5.0
# Clients of a node that is not used any more are kept no longer than this.
_KEPT_S = 60.0


@dataclass(slots=True)
class _Client:
    handle: Any
    used_s: float


@dataclass(slots=True, eq=False)
class _Call:
    """A request that was sent once ``future`` is there; ``answered`` takes the response or the error."""

    client: _Client
    request: Any
    answered: Callable[[Any], None]
    node: str
    until_s: float
    future: Any = None


class NodeParameterClients:
    """Gets and sets parameters of other nodes through clients of ``node``, on the thread of its executor.

    ``poll`` is to be called often: it sends what waits for a service to be found, and gives up in time.
    """

    def __init__(self, node: Any, steady_s: Callable[[], float]) -> None:
        self._node = node
        self._steady_s = steady_s
        self._clients: dict[tuple[str, Any], _Client] = {}
        self._calls: list[_Call] = []

    def get(self, node: str, names: Sequence[str], got: Got) -> None:
        """The values of parameters of ``node``; one that it does not have is ``None``."""
        request = GetParameters.Request(names=list(names))

        def answered(response: Any) -> None:
            if isinstance(response, RosError):
                got(response)
                return
            # A node that lacks one of them answers with an empty list.
            values = [rclpy.parameter.parameter_value_to_python(one) for one in response.values]
            padded = values + [None] * (len(names) - len(values))
            got({name: plain_value(value) for name, value in zip(names, padded, strict=False)})

        self._call(GetParameters, "get_parameters", node, request, answered)

    def set(self, node: str, values: Values, was_set: WasSet) -> None:
        """Have ``node`` give its parameters these values, each by itself."""
        parameters = [_parameter(name, value).to_parameter_msg() for name, value in values.items()]

        def answered(response: Any) -> None:
            if isinstance(response, RosError):
                was_set(response)
                return
            results = zip(values, response.results, strict=False)
            was_set({name: one.reason for name, one in results if not one.successful})

        self._call(
            SetParameters, "set_parameters", node, SetParameters.Request(parameters=parameters), answered
        )

    def poll(self) -> None:
        """Send what can be sent, and give up on what took too long."""
        now_s = self._steady_s()
        for call in [*self._calls]:
            if now_s >= call.until_s:
                self._give_up(call)
            elif call.future is None and call.client.handle.service_is_ready():
                self._send(call)
        busy = [call.client for call in self._calls]
        for key, client in [*self._clients.items()]:
            if client.used_s + _KEPT_S < now_s and client not in busy:
                del self._clients[key]
                self._node.destroy_client(client.handle)

    def _call(
        self, kind: Any, service: str, node: str, request: Any, answered: Callable[[Any], None]
    ) -> None:
        now_s = self._steady_s()
        client = self._clients.get((node, kind))
        try:
            if client is None:
                client = self._clients[node, kind] = self._new_client(kind, f"{node}/{service}", now_s)
        except RosError as error:
            answered(error)
            return
        client.used_s = now_s
        self._calls.append(_Call(client, request, answered, node, now_s + ANSWER_WITHIN_S))
        self.poll()

    def _new_client(self, kind: Any, service: str, now_s: float) -> _Client:
        with ros_errors(service):
            try:
                return _Client(self._node.create_client(kind, service), now_s)
            except NameValidationException as error:
                raise RosError("this is not the name of a node", place=service) from error

    def _send(self, call: _Call) -> None:
        call.future = call.client.handle.call_async(call.request)
        call.future.add_done_callback(partial(self._done, call))

    def _done(self, call: _Call, future: Any) -> None:
        if call not in self._calls:
            return
        self._calls.remove(call)
        error = future.exception()
        call.answered(future.result() if error is None else RosError(str(error), place=call.node))

    def _give_up(self, call: _Call) -> None:
        self._calls.remove(call)
        if call.future is not None:
            call.client.handle.remove_pending_request(call.future)
        call.answered(
            SilentNodeError(
                f"the node did not answer within {ANSWER_WITHIN_S:g} s",
                place=call.node,
                remedy="check that `testudo run` is still running, in the same ROS domain",
            )
        )
