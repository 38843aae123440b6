# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of an rclpy node."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import rclpy.parameter
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.exceptions import ParameterException

from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.domain.parameter import Accept, Access, Parameter, ParameterValue


class NodeParameters:
    """Declares parameters of a node and asks before they change."""

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
        """Give a parameter another value without asking anyone."""
        self._is_ours = True
        try:
            self._node.set_parameters([rclpy.parameter.Parameter(name, value=value)])
        finally:
            self._is_ours = False

    def _declared(self, one: Parameter) -> ParameterValue:
        descriptor = ParameterDescriptor(
            description=one.description,
            read_only=one.access is Access.NOBODY,
            dynamic_typing=not one.is_typed,
        )
        try:
            declared = self._node.declare_parameter(
                one.name, one.value, descriptor, ignore_override=one.is_final
            )
        except ParameterException as error:
            raise UsageError(str(error), place=f"parameter {one.name}") from error
        return plain_value(declared.value)

    def _asked(self, parameters: Sequence[Any]) -> Any:
        """Whether rclpy may give the parameters their new values."""
        changes = {one.name: plain_value(one.value) for one in parameters if one.name in self._access}
        if self._is_ours or not changes:
            return SetParametersResult(successful=True)
        try:
            for name in changes:
                if self._access[name] is Access.NODE:
                    raise UsageError("it only tells, and cannot be set", place=f"parameter {name}")
            self._accept(changes)
        except TestudoError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)


def _nothing(_changes: Mapping[str, ParameterValue]) -> None:
    """Accept whatever is set while nothing is declared."""


def plain_value(value: Any) -> ParameterValue:
    """A value of ROS as ours; one of a type that we lack as text."""
    if value is None or isinstance(value, bool | int | float | str):
        return value
    try:
        return tuple(map(str, value))
    except TypeError:
        return str(value)
