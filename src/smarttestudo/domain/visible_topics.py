# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The topics of a ROS graph that are the robot's own."""

from __future__ import annotations

from collections.abc import Callable

from smarttestudo.domain.names import DECISIONS_TOPIC, NAME_OPTION
from smarttestudo.domain.robot import Endpoint, Robot

_OF_ROS = frozenset({"/rosout", "/parameter_events"})
UNKNOWN_NODE = "/_NODE_NAME_UNKNOWN_"
"""How the name ends that an endpoint has until its node is discovered, too."""


def receiving_node(receiver: int) -> str:
    """The name of the node that publishes what the operator's end of that number receives."""
    return f"testudo_receive_{receiver}"


def relaying_nodes(robot: Robot, warn: Callable[[str], None] | None = None) -> frozenset[str]:
    """The nodes that relay, this one among them: they publish decisions, or what this one sends.

    ``warn`` is told where another one has the name of this one.
    """
    relaying = [endpoint.node for endpoint in robot.publishers(DECISIONS_TOPIC)]
    if warn is not None and relaying.count(robot.name) > 1:
        warn(
            f"another {robot.name} relays on this ROS graph, or was killed a moment ago: "
            "end one of them, as what both relay arrives twice; or, for two robots, give each a name, as "
            f"with {NAME_OPTION}: rules can be pushed to neither so"
        )
    return frozenset({*relaying, robot.name, *robot.fed_nodes})


def visible_topics(robot: Robot) -> dict[str, list[Endpoint]]:
    """The publishers of each topic, without hidden topics, those of ROS and those of SmartTestudo nodes."""
    testudos = relaying_nodes(robot)
    names = [name for name in robot.topics() if is_visible(name)]
    published = {
        name: [endpoint for endpoint in robot.publishers(name) if endpoint.node not in testudos]
        for name in sorted(names)
    }
    return {name: endpoints for name, endpoints in published.items() if endpoints}


def topic_types(robot: Robot) -> dict[str, str]:
    """The types of the visible topics."""
    return {topic: publishers[0].type_name for topic, publishers in visible_topics(robot).items()}


def is_visible(name: str) -> bool:
    """Whether it is neither ROS's own nor hidden, as those of which a part begins with an underscore."""
    return name not in _OF_ROS and "/_" not in name
