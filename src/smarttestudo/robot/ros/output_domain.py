# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The domain of the operators, where it is not the robot's."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.robot import OutputDomain
from smarttestudo.robot.ros.discovery import discovery_variables, environment
from smarttestudo.robot.ros.ros_errors import ros_errors


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
            args=[],
            context=context,
            domain_id=domain.number,
            signal_handler_options=SignalHandlerOptions.NO,
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
