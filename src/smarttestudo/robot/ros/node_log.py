# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The log of a node, as ROS has it: on the terminal, in its file and on /rosout."""

from __future__ import annotations

import sys
from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.logging import LoggingSeverity

from smarttestudo.domain.robot import RobotLog
from smarttestudo.domain.texts import visible


def node_log(node: Any) -> RobotLog:
    """The log of ``node``, by the cheaper way if this version of rclpy has it."""
    logger = node.get_logger()
    is_cheaper = hasattr(rclpy_implementation, "rclpy_logging_rcutils_log")
    return NodeLog(logger) if is_cheaper else Utf8Log(logger)


class Utf8Log:
    """Logs by ``logger``, which takes nothing but UTF-8; what others wrote stays within its line."""

    def __init__(self, logger: RobotLog) -> None:
        self._logger = logger

    def info(self, message: str) -> None:
        """Log what happened."""
        self._logger.info(visible(message))

    def warning(self, message: str) -> None:
        """Log a warning."""
        self._logger.warning(visible(message))


class NodeLog:
    """Logs what ``logger`` would, with the line of code that logs.

    rclpy looks for that line in the sources of all that is imported: 40 ms at the start, 1 ms each time.
    """

    def __init__(self, logger: Any) -> None:
        self._logger = logger

    def info(self, message: str) -> None:
        """Log what happened."""
        self._log(LoggingSeverity.INFO, message)

    def warning(self, message: str) -> None:
        """Log a warning."""
        self._log(LoggingSeverity.WARN, message)

    def _log(self, severity: LoggingSeverity, message: str) -> None:
        if not self._logger.is_enabled_for(severity):
            return
        # A method called this function, and that was called by who logs.
        frame = sys._getframe(2)  # noqa: SLF001 - as Python's own log does
        code = frame.f_code
        rclpy_implementation.rclpy_logging_rcutils_log(
            severity, self._logger.name, visible(message), code.co_name, code.co_filename, frame.f_lineno
        )
