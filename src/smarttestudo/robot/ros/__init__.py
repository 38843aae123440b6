# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""ROS 2: the only importer of rclpy. It must be installed where this is called, not where it is imported."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from smarttestudo.domain.errors import RosError, how_to_get_ros
from smarttestudo.domain.robot import DataPathKind, OutputDomain, Robot
from smarttestudo.robot.ros.loading import load_rclpy

if TYPE_CHECKING:
    from smarttestudo.domain.link import OutgoingLink
    from smarttestudo.domain.remote_robots import RemoteRobots

NODE_NAME = "smarttestudo"


@contextmanager
def open_robot(
    ros_arguments: Sequence[str] = (),
    *,
    name: str = NODE_NAME,
    data_path: DataPathKind = DataPathKind.AUTO,
    output_domain: OutputDomain | None = None,
    link: OutgoingLink | None = None,
    is_local: bool = True,
    sends_large: bool = False,
) -> Iterator[Robot]:
    """A node ``name`` on the graph; ``ros_arguments`` are what follows ``--ros-args``.

    With an ``output_domain`` all that it publishes goes there, with a ``link`` over that; on the graph, too,
    where that ``is_local``. A process that ``sends_large`` messages there has shared memory for them.

    Raises:
        RosError: rclpy is missing, the node cannot be made, or the data path does not work here.
        UsageError: the arguments are none of ROS, or the output domain is the robot's.
    """
    try:
        load_rclpy()
    except ImportError as error:
        raise RosError(
            "this needs ROS 2 (rclpy)", remedy=f"source your ROS setup; {how_to_get_ros()}"
        ) from error
    from smarttestudo.robot.ros.node import RosNode, open_node  # noqa: PLC0415  needs rclpy

    def make(node: Any, executor: Any, operators: Any) -> RosNode:
        if link is None:
            return RosNode(node, executor, operators, data_path)
        from smarttestudo.robot.ros.linked_node import LinkedNode  # noqa: PLC0415  most robots have no link

        return LinkedNode(node, executor, operators, data_path, link=link, is_local=is_local)

    sends_large = sends_large and (link is None or is_local)
    with open_node(ros_arguments, name, output_domain, make, sends_large=sends_large) as node:
        yield node


@contextmanager
def open_graph_robots(name: str) -> Iterator[RemoteRobots]:
    """The robots of the ROS graph, heard by a node ``name`` with its process id, which publishes nothing.

    A few messages a second go without librcl's path and its self-test. Raises ``RosError``.
    """
    from smarttestudo.robot.ros.graph_robots import GraphRobots  # noqa: PLC0415  a run needs none

    with open_robot(name=f"{name}_{os.getpid()}", data_path=DataPathKind.RCLPY) as robot:
        yield GraphRobots(robot, time.monotonic)
