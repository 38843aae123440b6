# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Relayed topics while there are no rules: everything that an operator may need."""

from __future__ import annotations

from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.visible_topics import is_visible, relaying_nodes
from smarttestudo.language.rule_set import fallback_rules
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.output_topics import OutputTopic, is_output_topic, output_topics

# Time has to come from one place.
_CLOCK_TOPIC = "/clock"


class Fallback:
    """The topics of a robot that its own nodes publish, below ``topic_prefix``; once seen, they stay.

    Hidden topics, those of every node, the clock and what SmartTestudo nodes publish are left out, and with
    a warning those for which ``output_topic`` makes no name of their own; ``UsageError`` where it never does.
    """

    def __init__(self, robot: Robot, *, output_topic: OutputTopic, topic_prefix: str) -> None:
        self._robot = robot
        self._output_topic = output_topic
        self._topic_prefix = topic_prefix
        self._output_topics: dict[str, str] = {}
        self._refused: set[str] = set()
        output_topics(fallback_rules(["/any"]), output_topic)

    def poll(self) -> bool:
        """Whether there are more topics than at the last poll."""
        seen = len(self._output_topics)
        unknown = [topic for topic in self._robot.topics() if self._may_join(topic)]
        if unknown:
            testudos = relaying_nodes(self._robot)
            for topic in sorted(unknown):
                if self._nodes(topic) - testudos:
                    self._join(topic)
        return len(self._output_topics) > seen

    def rules(self) -> LiveRules:
        """All of them at Full."""
        return LiveRules(
            rule_set=fallback_rules(self._output_topics), output_topics=dict(self._output_topics)
        )

    def _join(self, topic: str) -> None:
        try:
            in_use = self._output_topics.values()
            named = output_topics(fallback_rules([topic]), self._output_topic, in_use=in_use)
            self._output_topics.update(named)
        except UsageError as error:
            self._refused.add(topic)
            self._robot.log.warning(str(error))

    def _may_join(self, topic: str) -> bool:
        return not (
            topic in self._output_topics
            or topic in self._refused
            or topic == _CLOCK_TOPIC
            or not is_visible(topic)
            or is_output_topic(topic, self._output_topic)
            or not topic.startswith(f"{self._topic_prefix}/")
        )

    def _nodes(self, topic: str) -> frozenset[str]:
        return frozenset(endpoint.node for endpoint in self._robot.publishers(topic))
