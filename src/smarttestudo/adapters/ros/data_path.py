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
    """The path of that kind, or the best that works here; the node's log says which. ``operators`` publishes.

    Raises ``RosError`` where librcl was asked for and does not work.
    """
    log = node.get_logger()
    if kind is DataPathKind.RCLPY:
        log.info("Data path: rclpy, as asked for")
        return RclpyPath(node, executor, operators)
    try:
        library = RclLibrary()
        layout = tested_layout(node, library)
    except RosError as error:
        if kind is DataPathKind.RCL:
            raise
        log.warning(f"Data path: rclpy, at a higher cost, because {error.cause}")
        return RclpyPath(node, executor, operators)
    known = "publishers told apart" if layout.gid_bytes else "publishers not told apart"
    log.info(f"Data path: librcl, {known}, messages {'' if layout.is_numbered else 'not '}numbered")
    return RclPath(node, executor, library, layout, operators)
