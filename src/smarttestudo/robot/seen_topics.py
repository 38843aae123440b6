# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics that the nodes of a robot publish, and what is known of their types."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from smarttestudo.domain.robot import UNKNOWN_NODE, Robot, relaying_nodes
from smarttestudo.domain.type_definition import TypeDefinition
from smarttestudo.language.known_types import KnownTypes


class SeenTopics:
    """The topics that ``may_join``, of those that a robot's own nodes publish; once seen, they stay.

    A node may be discovered later than its topics: one that turns out to be SmartTestudo's takes them along.
    """

    def __init__(self, robot: Robot, may_join: Callable[[str], bool]) -> None:
        self.types: dict[str, str] = {}
        """By the names of the topics."""
        self._robot = robot
        self._may_join = may_join
        self._of_unknown_nodes: set[str] = set()
        self._definitions = _Definitions(robot, self.types)

    def known(self) -> KnownTypes:
        """They with their types."""
        return KnownTypes(topics=dict(self.types), definitions=self._definitions)

    def poll(self) -> bool:
        """Whether topics or types are others than at the last poll."""
        there = self._robot.topics()
        unknown = [
            topic
            for topic, types in there.items()
            if self.types.get(topic) not in types
            and self._may_join(topic)
            and self._robot.publisher_count(topic)
        ]
        if not unknown and not self._of_unknown_nodes:
            return False
        testudos = relaying_nodes(self._robot)
        left = self._leave(testudos)
        joined = [topic for topic in sorted(unknown) if self._join(topic, testudos)]
        return left or bool(joined)

    def _join(self, topic: str, testudos: frozenset[str]) -> bool:
        types = {one.node: one.type_name for one in self._robot.publishers(topic)}
        if any(node.endswith(UNKNOWN_NODE) for node in types):
            self._of_unknown_nodes.add(topic)
        own = [name for node, name in types.items() if node not in testudos]
        if own:
            self.types[topic] = own[0]
        return bool(own)

    def _leave(self, testudos: frozenset[str]) -> bool:
        """Whether topics are given up, as they turn out to be of SmartTestudo nodes alone."""
        nodes_of = {topic: self._nodes(topic) for topic in self._of_unknown_nodes}
        self._of_unknown_nodes = {
            topic for topic, nodes in nodes_of.items() if any(one.endswith(UNKNOWN_NODE) for one in nodes)
        }
        left = [topic for topic, nodes in nodes_of.items() if nodes and nodes <= testudos]
        before = len(self.types)
        for topic in left:
            self.types.pop(topic, None)
        return len(self.types) < before

    def _nodes(self, topic: str) -> frozenset[str]:
        return frozenset(endpoint.node for endpoint in self._robot.publishers(topic))


class _Definitions(Mapping[str, TypeDefinition]):
    """The types that are installed on a robot; those of its topics can be gone through."""

    def __init__(self, robot: Robot, types: Mapping[str, str]) -> None:
        self._robot = robot
        self._types = types
        self._found: dict[str, TypeDefinition | None] = {}

    def __getitem__(self, name: str) -> TypeDefinition:
        if name not in self._found:
            self._found[name] = self._robot.type_definition(name)
        known = self._found[name]
        if known is None:
            raise KeyError(name)
        return known

    def __iter__(self) -> Iterator[str]:
        return iter([name for name in dict.fromkeys(self._types.values()) if name in self])

    def __len__(self) -> int:
        return sum(1 for _ in self)
