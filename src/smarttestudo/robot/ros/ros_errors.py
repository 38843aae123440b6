# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Errors of rclpy as ours."""

from __future__ import annotations

from types import TracebackType

from smarttestudo.domain.errors import RosError, TestudoError


def ros_errors(place: str | None = None) -> _RosErrors:
    """Make a ``RosError`` of what rclpy raises in the block."""
    return _RosErrors(place)


class _RosErrors:
    """No generator: each poll of the graph enters it for hundreds of topics."""

    __slots__ = ("_place",)

    def __init__(self, place: str | None) -> None:
        self._place = place

    def __enter__(self) -> None:
        pass

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        # Errors of rcl are RuntimeErrors, names and values have others; only the first line is for people.
        if isinstance(error, Exception) and not isinstance(error, TestudoError):
            cause = (str(error).splitlines() or [type(error).__name__])[0]
            raise RosError(cause, place=self._place) from error
