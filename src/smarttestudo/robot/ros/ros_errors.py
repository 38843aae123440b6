# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Errors of rclpy as ours."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from smarttestudo.domain.errors import RosError


@contextmanager
def ros_errors(place: str | None = None) -> Iterator[None]:
    """Make a ``RosError`` of what rclpy raises in the block."""
    try:
        yield
    except RuntimeError as error:
        # All errors of rcl and the middleware are RuntimeErrors; only their first line is for people.
        cause = (str(error).splitlines() or [type(error).__name__])[0]
        raise RosError(cause, place=place) from error
