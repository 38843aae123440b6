# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What rclpy raises becomes an error with a place and one line."""

from __future__ import annotations

import pytest

from smarttestudo.domain.errors import RosError, UsageError
from smarttestudo.robot.ros.ros_errors import ros_errors


@pytest.mark.parametrize(
    ("raised", "cause"),
    [
        (RuntimeError("no such node\n  at rcl.c:1"), "no such node"),
        (RuntimeError(""), "RuntimeError"),
        (NameError("Invalid topic name: topic length should not exceed '255U - 8U':\n  '/a"), None),
        (UnicodeDecodeError("utf-16", b"\xd8\x00", 0, 2, "illegal encoding"), None),
        (ValueError("depth must be positive"), None),
        (KeyError("type"), "'type'"),
    ],
)
def test_whatever_rclpy_raises_has_a_place_and_its_first_line(raised: Exception, cause: str | None) -> None:
    cause = cause or str(raised).partition("\n")[0]
    with pytest.raises(RosError) as error, ros_errors("/imu"):
        raise raised
    assert (error.value.place, error.value.cause) == ("/imu", cause)
    assert error.value.__cause__ is raised


@pytest.mark.parametrize("raised", [UsageError("no"), KeyboardInterrupt()], ids=repr)
def test_what_has_its_place_and_what_ends_the_run_pass(raised: BaseException) -> None:
    with pytest.raises(type(raised)) as error, ros_errors("/imu"):
        raise raised
    assert error.value is raised


def test_what_goes_well_goes_on() -> None:
    with ros_errors("/imu"):
        found = 1
    assert found == 1
