# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The processes of a test use the ROS that its own process uses."""

from __future__ import annotations

from forked_python import inherited

LIBRARIES = {"LD_LIBRARY_PATH": "/opt/ros/humble/lib", "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1", "HOME": "/root"}


def test_the_libraries_of_a_setup_file_are_inherited_and_those_of_wheels_are_not() -> None:
    sourced = {"AMENT_PREFIX_PATH": "/opt/ros/humble", **LIBRARIES}
    assert inherited(LIBRARIES) == {"HOME": "/root"}
    assert inherited(sourced) == {
        "AMENT_PREFIX_PATH": "/opt/ros/humble",
        "LD_LIBRARY_PATH": "/opt/ros/humble/lib",
        "HOME": "/root",
    }
