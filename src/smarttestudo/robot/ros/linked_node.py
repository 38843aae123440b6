# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The node among the robot's own whose operators are at the other end of a link."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from typing import Any

from smarttestudo.domain.link import OutgoingLink, StreamInfo
from smarttestudo.domain.robot import (
    DataPath,
    DataPathKind,
    Endpoint,
    GraphChange,
    Payload,
    PollGraph,
    Publisher,
    Qos,
    receiving_node,
)
from smarttestudo.pacing.cdr import string_message
from smarttestudo.robot.ros.message_types import message_definition
from smarttestudo.robot.ros.node import RosNode
from smarttestudo.robot.ros.ros_errors import ros_errors

OPERATOR_NODE = "/testudo_receive"
_TEXT_TYPE = "std_msgs/msg/String"


class LinkedNode(RosNode):
    """An rclpy node that publishes over ``link``, and on the ROS graph too where that ``is_local``.

    While an operator's end is connected, it counts as a subscriber of every topic.
    """

    def __init__(
        self,
        node: Any,
        executor: Any,
        operators: Any,
        data_path_kind: DataPathKind,
        *,
        link: OutgoingLink,
        is_local: bool,
    ) -> None:
        super().__init__(node, executor, operators, data_path_kind)
        self._link = link
        self._is_local = is_local
        self._linked_path: LinkedPath | None = None
        self._said: frozenset[str] = frozenset()

    @property
    def data_path(self) -> DataPath:
        """Messages in by the path that works here, and out over the link. Raises ``RosError``."""
        if self._linked_path is None:
            self._linked_path = LinkedPath(super().data_path, self._link, is_local=self._is_local)
        return self._linked_path

    @property
    def fed_nodes(self) -> frozenset[str]:
        """Nodes of operator's ends that are on the robot's own graph, which is said. Raises ``RosError``."""
        named = {f"/{receiving_node(number)}" for number in self._link.state.operators}
        if not named:
            return frozenset()
        with ros_errors():
            names = self._node.get_node_names_and_namespaces()
        found = frozenset(named & {f"{namespace.rstrip('/')}/{name}" for name, namespace in names})
        for node in sorted(found - self._said):
            self.log.warning(
                f"{node} publishes what this robot sends on the robot's own ROS graph; that is not relayed "
                "again: start 'testudo receive' with a ROS_DOMAIN_ID of its own"
            )
        self._said |= found
        return found

    @property
    def has_output_domain(self) -> bool:
        """Whether relayed topics may have the names of their sources."""
        return super().has_output_domain or not self._is_local

    def resolve_output(self, topic: str) -> str:
        """The full name of ``topic`` at the operators: remapped where it is on the ROS graph, too."""
        return super().resolve_output(topic) if self._is_local else topic

    def subscribers(self, topic: str) -> Sequence[Endpoint]:
        local = super().subscribers(topic) if self._is_local else ()
        return [*local, *self._operator()]

    def subscriber_count(self, topic: str) -> int:
        local = super().subscriber_count(topic) if self._is_local else 0
        return local + self._link.state.is_connected

    def local_subscriber_count(self, topic: str) -> int:
        """How many subscribe to ``topic`` on the graph: what goes over the link has its own watchers."""
        return super().subscriber_count(topic)

    def poll_graph(self, poll: PollGraph) -> None:
        """Have ``poll`` called; an operator's end that comes or goes is a change of the graph."""
        was_connected = False

        def poll_both(graph: GraphChange) -> None:
            nonlocal was_connected
            before, was_connected = was_connected, self._link.state.is_connected
            poll(graph if was_connected is before else GraphChange.REPORTED)

        super().poll_graph(poll_both)

    def text_publisher(self, topic: str, qos: Qos, *, goes_over_link: bool = True) -> Callable[[str], None]:
        """Sender of a std_msgs/msg/String on ``topic``: on the graph and, where wanted, over the link."""
        publish_here = super().text_publisher(topic, qos)
        if not goes_over_link:
            return publish_here
        linked = self._link.advertise(_stream(topic, _TEXT_TYPE, qos, 0))

        def publish(text: str) -> None:
            publish_here(text)
            linked.publish(string_message(text))

        return publish

    def _operator(self) -> Iterator[Endpoint]:
        if self._link.state.is_connected:
            yield Endpoint(node=OPERATOR_NODE, type_name="", reliable=False, transient_local=False)


class LinkedPath:
    """A data path whose messages go out over a link, and by ``path`` too where that ``is_local``."""

    keeps_newest = True

    def __init__(self, path: DataPath, link: OutgoingLink, *, is_local: bool) -> None:
        self._path = path
        self._link = link
        self._is_local = is_local
        self._numbers: defaultdict[str, Iterator[int]] = defaultdict(itertools.count)
        # Messages come in as by that path; no compiled relay publishes over a link.
        self.knows, self.subscribe, self.decode = path.knows, path.subscribe, path.decode
        self.identifies_publishers, self.can_pause = path.identifies_publishers, path.can_pause
        self.compiled = path.compiled

    @property
    def description(self) -> str:
        """Which path messages come in by, and that they go out over a link."""
        return f"{self._path.description}; out over the link{' and on the graph' * self._is_local}"

    def advertise(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """Send over the link what is published. Raises ``RosError`` and ``LinkError``."""
        linked = self._link.advertise(_stream(topic, type_name, qos, next(self._numbers[topic])))
        if not self._is_local:
            return linked
        with ExitStack() as undone:
            undone.callback(linked.close)
            both = _Both(linked, self._path.advertise(topic, type_name, qos))
            undone.pop_all()
        return both


class _Both:
    """Publishes in two places."""

    def __init__(self, first: Publisher, second: Publisher) -> None:
        self._publishers = (first, second)

    def publish(self, payload: Payload) -> None:
        for publisher in self._publishers:
            publisher.publish(payload)

    def close(self) -> None:
        for publisher in self._publishers:
            publisher.close()


def _stream(topic: str, type_name: str, qos: Qos, publisher: int) -> StreamInfo:
    definition = message_definition(type_name)
    return StreamInfo(topic=topic, type_name=type_name, qos=qos, publisher=publisher, definition=definition)
