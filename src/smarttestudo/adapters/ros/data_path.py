# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Chooses the data path."""

from __future__ import annotations

from typing import Any

from smarttestudo.adapters.ros.rcl_library import RclLibrary
from smarttestudo.adapters.ros.rcl_path import RclPath
from smarttestudo.adapters.ros.rcl_self_test import tested_layout
from smarttestudo.adapters.ros.rclpy_path import RclpyPath
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import DataPathKind


def open_data_path(node: Any, executor: Any, kind: DataPathKind, operators: Any) -> RclPath | RclpyPath:
    """The path of that kind, or the best that works here; ``operators`` is the node that publishes.

    Raises ``RosError`` where librcl was asked for and does not work.
    """
    if kind is DataPathKind.RCLPY:
        return RclpyPath(node, executor, operators, "as asked for")
    try:
        library = RclLibrary()
        layout = tested_layout(node, library)
    except RosError as error:
        if kind is DataPathKind.RCL:
            raise
        return RclpyPath(node, executor, operators, f"at a higher cost, because {error.cause}")
    return RclPath(node, executor, library, layout, operators)
