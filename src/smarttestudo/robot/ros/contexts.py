# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Contexts of nodes: with a domain and a log that are fit for them, and that of the operators."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import get_rmw_implementation_identifier

from smarttestudo.domain.errors import RosError, TestudoError, UsageError
from smarttestudo.domain.robot import LAST_DOMAIN, OutputDomain
from smarttestudo.robot.ros.discovery import discovery_variables, environment
from smarttestudo.robot.ros.ros_errors import ros_errors

_NO_LOG = ("log directory", "logging directory", "create logger")
"""What ROS says where the folder of its logs cannot be made or written."""
_DOMAIN = "ROS_DOMAIN_ID"


@contextmanager
def own_context(ros_arguments: Sequence[str]) -> Iterator[Context]:
    """A context that is shut down at the end. Raises ``RosError``, and ``UsageError`` for arguments."""
    context = Context()
    arguments = ["--ros-args", *ros_arguments] if ros_arguments else []
    try:
        with ros_errors():
            rclpy.init(args=arguments, context=context, signal_handler_options=SignalHandlerOptions.NO)
    except RosError as error:
        raise _refused(error, ros_arguments) from error
    try:
        _require_domain(context)
        yield context
    finally:
        rclpy.try_shutdown(context=context)


def _refused(error: RosError, ros_arguments: Sequence[str]) -> TestudoError:
    """An error that says what to do where ROS does not begin."""
    if any(part in error.cause for part in _NO_LOG):
        remedy = "set ROS_LOG_DIR to a folder that can be written"
        return RosError(error.cause, place="ROS_LOG_DIR", remedy=remedy)
    if _DOMAIN in error.cause:
        return _no_domain(os.environ.get(_DOMAIN, ""))
    if not ros_arguments:
        return error
    return UsageError(error.cause, place="--ros-args", remedy="see the ROS 2 manual")


def _require_domain(context: Context) -> None:
    """Raise ``RosError`` for a domain without ports: Fast DDS ends the process there."""
    number = context.get_domain_id()
    if number > LAST_DOMAIN and not get_rmw_implementation_identifier().startswith("rmw_zenoh"):
        raise _no_domain(str(number))


def _no_domain(text: str) -> RosError:
    cause = f"{text!r:.80} is no ROS domain"
    return RosError(cause, place=_DOMAIN, remedy=f"set it to a number from 0 to {LAST_DOMAIN}")


@contextmanager
def operators_node(node: Any, domain: OutputDomain | None) -> Iterator[Any]:
    """A node in ``domain`` with the name of ``node``, or ``node`` itself. It only publishes: nobody spins it.

    Raises ``UsageError`` where it is the domain of ``node``.
    """
    if domain is None:
        yield node
        return
    if domain.number == node.context.get_domain_id():
        raise UsageError(
            f"the robot itself is in domain {domain.number}",
            place="--output-domain",
            remedy="give the operators another one, or leave this out",
        )
    context = Context()
    discovery = {} if domain.discovery is None else discovery_variables(domain.discovery)
    with environment(discovery), ros_errors("--output-domain"):
        rclpy.init(
            args=[], context=context, domain_id=domain.number, signal_handler_options=SignalHandlerOptions.NO
        )
    try:
        with ros_errors("--output-domain"):
            operators = Node(
                node.get_name(),
                namespace=node.get_namespace(),
                context=context,
                use_global_arguments=False,
                enable_rosout=False,
                start_parameter_services=False,
            )
        try:
            yield operators
        finally:
            operators.destroy_node()
    finally:
        rclpy.try_shutdown(context=context)
