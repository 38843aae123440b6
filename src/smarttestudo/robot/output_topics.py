# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The names of output topics: what is published for each relayed source."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.names import (
    MAX_NAME_LENGTH,
    OWN_TOPICS,
    output_name,
)
from smarttestudo.domain.robot import Robot
from smarttestudo.language.normal_form import Resolve
from smarttestudo.language.rule_set import RuleSet

DEFAULT_OUTPUT_TOPIC = "/testudo{topic}"


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputTopic:
    """How output topics are named: ``pattern`` has ``{topic}`` for the source's full name.

    ``is_elsewhere``: they are in another domain than their sources, whose names they may have.
    ``resolve`` gives the name that a publisher really has, which ROS may remap.
    """

    pattern: str = DEFAULT_OUTPUT_TOPIC
    is_elsewhere: bool = False
    resolve: Resolve = str

    @staticmethod
    def of(robot: Robot, pattern: str) -> OutputTopic:
        """The names that ``robot`` gives by ``pattern``."""
        return OutputTopic(
            pattern=pattern, is_elsewhere=robot.has_output_domain, resolve=robot.resolve_output
        )

    def resolved(self, name: str) -> str:
        """The name that a publisher of ``name`` has; none has one that is too long, which costs its topic."""
        return self.resolve(name) if len(name) <= MAX_NAME_LENGTH else name


def output_topics(
    rule_set: RuleSet, output_topic: OutputTopic, *, in_use: Collection[str] = ()
) -> dict[str, str]:
    """The output topic of each relayed one; ``UsageError`` if a name is invalid, taken or ``in_use``."""
    named = {topic: output_name(topic, output_topic.pattern) for topic in rule_set.relayed}
    names = {topic: output_topic.resolved(name) for topic, name in named.items()}
    sources = {*rule_set.relayed, *rule_set.topics_read}
    taken = OWN_TOPICS if output_topic.is_elsewhere else OWN_TOPICS | sources
    used = set(in_use)
    for topic, name in names.items():
        if name in taken:
            is_source = name == topic and name not in OWN_TOPICS
            whose = "its own name" if is_source else f"{name}, which is another topic's name"
            cause = f"{topic} would be relayed to {whose}"
            remedy = f"choose another pattern, such as {DEFAULT_OUTPUT_TOPIC}"
            raise UsageError(cause, place="--output-topic", remedy=remedy)
        if name in used:
            cause = f"{topic} would be relayed to {name}, as another topic is"
            raise UsageError(cause, place="--ros-args", remedy="remap each to a name of its own")
        used.add(name)
    # ROS remaps what a publisher is given: a name that it would remap once more stays as it was.
    return {
        topic: name if output_topic.resolved(name) == name else named[topic] for topic, name in names.items()
    }
