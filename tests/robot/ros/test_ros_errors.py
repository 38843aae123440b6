# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What rclpy raises becomes an error with a place and one line; whatever else is raised stays as it is."""

from __future__ import annotations

import pytest

from smarttestudo.domain.errors import RosError
from smarttestudo.robot.ros.ros_errors import ros_errors


@pytest.mark.parametrize(
    ("text", "cause"), [("no such node\n  at rcl.c:1", "no such node"), ("", "RuntimeError")]
)
def test_an_error_of_rclpy_has_a_place_and_its_first_line(text: str, cause: str) -> None:
    raised = RuntimeError(text)
    with pytest.raises(RosError) as error, ros_errors("/imu"):
        raise raised
    assert (error.value.place, error.value.cause) == ("/imu", cause)
    assert error.value.__cause__ is raised


def test_other_errors_pass_and_so_does_what_goes_well() -> None:
    with pytest.raises(KeyError), ros_errors("/imu"):
        raise KeyError("/imu")
    with ros_errors("/imu"):
        found = 1
    assert found == 1
