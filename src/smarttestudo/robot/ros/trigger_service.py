# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Services that do something and say how it went."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from smarttestudo.domain.errors import RosError, TestudoError
from smarttestudo.domain.texts import in_utf_8
from smarttestudo.robot.ros.ros_errors import ros_errors


def offer_trigger(node: Any, name: str, act: Callable[[], str]) -> None:
    """Offer a std_srvs/srv/Trigger service that calls ``act``. Raises ``RosError``.

    It succeeds with the message that ``act`` returns, and fails with its ``TestudoError``.
    """
    try:
        from std_srvs.srv import Trigger  # noqa: PLC0415  a robot may lack it
    except ImportError as error:
        remedy = "install the ROS package std_srvs"
        raise RosError("the type of this service is not installed", place=name, remedy=remedy) from error

    def called(_request: Any, response: Any) -> Any:
        try:
            response.message = in_utf_8(act())
            response.success = True
        except TestudoError as error:
            response.message = in_utf_8(str(error))
            response.success = False
        return response

    with ros_errors(name):
        node.create_service(Trigger, name, called)
