# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of our node, and of others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import rclpy.parameter
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.exceptions import ParameterException

from smarttestudo.domain.errors import RosError, UsageError, said
from smarttestudo.domain.parameter import (
    Accept,
    Access,
    Got,
    Parameter,
    ParameterValue,
    Refusals,
    Values,
    WasSet,
)
from smarttestudo.domain.texts import in_utf_8
from smarttestudo.robot.ros.service_clients import ServiceClients


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


_REMEDY = "check that `testudo run` is still running, in the same ROS domain"


class NodeParameterClients:
    """Gets and sets parameters of other nodes through ``clients``."""

    def __init__(self, clients: ServiceClients) -> None:
        self._clients = clients

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

        self._clients.request(
            GetParameters,
            f"{node}/get_parameters",
            request,
            answered,
            place=node,
            remedy=_REMEDY,
            is_repeated=True,
        )

    def set(self, node: str, values: Values, was_set: WasSet) -> None:
        """Have ``node`` give its parameters these values, each by itself."""
        parameters = [_parameter(name, value).to_parameter_msg() for name, value in values.items()]

        def answered(response: Any) -> None:
            if isinstance(response, RosError):
                was_set(response)
                return
            results = zip(values, response.results, strict=False)
            was_set({name: one.reason for name, one in results if not one.successful})

        request = SetParameters.Request(parameters=parameters)
        self._clients.request(
            SetParameters, f"{node}/set_parameters", request, answered, place=node, remedy=_REMEDY
        )
