# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Chooses the data path, and none with a known defect."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import DataPathKind
from smarttestudo.robot.ros.byte_topics import ByteTopics, come_serialized
from smarttestudo.robot.ros.known_deadlock import refuse_known_deadlock
from smarttestudo.robot.ros.rclpy_path import RclpyPath

if TYPE_CHECKING:
    from smarttestudo.robot.ros.rcl.path import RclPath


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

    It is closed by ``opened``. ``on_graph_change`` is called within its ``wait`` where it ``tells_graph``.
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
