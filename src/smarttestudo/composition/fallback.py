# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is relayed while there are no rules: everything that is for an operator to see."""

from __future__ import annotations

from smarttestudo.adirf.rule_set import fallback_rules
from smarttestudo.composition.live_decisions import DECISIONS_TOPIC
from smarttestudo.composition.live_rules import LiveRules
from smarttestudo.composition.monitored_topics import is_monitored
from smarttestudo.composition.replay_topics import output_name
from smarttestudo.domain.robot import Robot

# Every node has the first two, and time has to come from one place.
NOT_RELAYED = frozenset({"/rosout", "/parameter_events", "/clock"})


class Fallback:
    """The topics of a robot that its own nodes publish, below ``topic_prefix``; once seen, they stay.

    Hidden topics, those of every node, the clock and what a SmartTestudo publishes are left out.
    """

    def __init__(self, robot: Robot, *, output_topic: str, topic_prefix: str) -> None:
        self._robot = robot
        self._output_topic = output_topic
        self._topic_prefix = topic_prefix
        self._topics: dict[str, None] = {}

    def look(self) -> bool:
        """Whether there are more topics than at the last look."""
        seen = len(self._topics)
        unknown = [topic for topic in self._robot.topics() if topic not in self._topics]
        unknown = [topic for topic in unknown if self._is_for_operators(topic)]
        if unknown:
            testudos = self._nodes(DECISIONS_TOPIC) | {self._robot.name}
            self._topics.update(dict.fromkeys(one for one in sorted(unknown) if self._nodes(one) - testudos))
        return len(self._topics) > seen

    def rules(self) -> LiveRules:
        """All of them at Full."""
        monitored = {topic: output_name(topic, self._output_topic) for topic in self._topics}
        return LiveRules(rule_set=fallback_rules(monitored), monitored=monitored)

    def _is_for_operators(self, topic: str) -> bool:
        return not (
            topic in NOT_RELAYED
            or is_hidden(topic)
            or is_monitored(topic, self._output_topic)
            or not topic.startswith(f"{self._topic_prefix}/")
        )

    def _nodes(self, topic: str) -> frozenset[str]:
        return frozenset(endpoint.node for endpoint in self._robot.publishers(topic))


def is_hidden(topic: str) -> bool:
    """Whether a part of the name begins with an underscore, as those of actions do."""
    return any(part.startswith("_") for part in topic.split("/"))
