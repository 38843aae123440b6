# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Chooses the data path, and none with a known defect."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rclpy.utilities import get_rmw_implementation_identifier

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import DataPathKind
from smarttestudo.robot.ros.rclpy_path import ByteTopics, RclpyPath, come_serialized

if TYPE_CHECKING:
    from smarttestudo.robot.ros.rcl.path import RclPath

FIRST_WITHOUT_DEADLOCK = (6, 2, 4)
"""Before, a listener and who sets its callback took two locks in opposite order (ros2/rmw_fastrtps#657)."""

# What all its variants have in common, the listeners included.
_PACKAGE = "rmw_fastrtps_shared_cpp"
_VERSION = re.compile(r"<version>\s*(\d+)\.(\d+)\.(\d+)\s*</version>")


def open_data_path(
    node: Any,
    executor: Any,
    kind: DataPathKind,
    operators: Any,
    *,
    opened: ExitStack,
    on_graph_change: Callable[[], None],
) -> RclPath | RclpyPath:
    """The path of that kind, or the best that works here; ``operators`` is the node that publishes.

    It is closed by ``opened``. ``on_graph_change`` is called within its ``wait`` where it ``reports_graph``.
    Raises ``RosError`` where librcl or compiled relays were asked for and do not work.
    """
    byte_topics = ByteTopics(node, come_serialized=come_serialized(node, executor.spin_once))
    if kind is DataPathKind.RCLPY:
        return RclpyPath(node, executor, operators, byte_topics, "as asked for")
    try:
        return _rcl_path(
            node, executor, operators, byte_topics, kind=kind, opened=opened, on_graph_change=on_graph_change
        )
    except RosError as error:
        if kind is not DataPathKind.AUTO:
            raise
        return RclpyPath(node, executor, operators, byte_topics, f"at a higher cost, because {error.cause}")


def _rcl_path(
    node: Any,
    executor: Any,
    operators: Any,
    byte_topics: ByteTopics,
    *,
    kind: DataPathKind,
    opened: ExitStack,
    on_graph_change: Callable[[], None],
) -> RclPath:
    """The path through librcl, tested. Raises ``RosError`` for whatever keeps it from working."""
    refuse_known_deadlock()
    try:
        # This path goes below rclpy's public interface, which another distribution may have changed.
        from smarttestudo.robot.ros.rcl.bindings import RclLibrary  # noqa: PLC0415
        from smarttestudo.robot.ros.rcl.path import RclPath  # noqa: PLC0415
        from smarttestudo.robot.ros.rcl.self_test import tested_layout, tested_relays  # noqa: PLC0415

        library = RclLibrary()
        layout = tested_layout(node, library)
        relays = tested_relays(node, library, layout, kind)
        with ExitStack() as undone:
            path = RclPath(
                node,
                executor,
                operators,
                byte_topics,
                library=library,
                layout=layout,
                relays=relays,
                on_graph_change=on_graph_change,
            )
            undone.callback(path.close)
            path.wait(0.0)
            opened.push(undone.pop_all())
    except (ImportError, AttributeError, TypeError) as error:
        raise RosError(f"this version of rclpy has a different interface: {error}") from error
    return path


def refuse_known_deadlock() -> None:
    """Raise ``RosError`` where setting a callback may block for ever, as far as the version can be seen."""
    if not get_rmw_implementation_identifier().startswith("rmw_fastrtps"):
        return
    version = _installed_version()
    if version is not None and version < FIRST_WITHOUT_DEADLOCK:
        raise RosError(
            f"rmw_fastrtps {_text(version)} may block for ever when it is asked to wake for messages",
            remedy=f"update it to {_text(FIRST_WITHOUT_DEADLOCK)} or later: sudo apt upgrade",
        )


def _installed_version() -> tuple[int, ...] | None:
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        try:
            manifest = Path(prefix, "share", _PACKAGE, "package.xml").read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError):
            continue
        found = _VERSION.search(manifest)
        return tuple(map(int, found.groups())) if found else None
    return None


def _text(version: tuple[int, ...]) -> str:
    return ".".join(map(str, version))
