# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What monitored topics are called."""

from __future__ import annotations

from smarttestudo.adirf.rule_set import RuleSet
from smarttestudo.composition.live_decisions import DECISIONS_TOPIC
from smarttestudo.composition.replay_topics import TOPIC_PLACEHOLDER, output_name
from smarttestudo.composition.status_announcer import DIAGNOSTICS_TOPIC, STATUS_TOPIC
from smarttestudo.domain.errors import UsageError

DEFAULT_OUTPUT_TOPIC = "/testudo{topic}"
OWN_TOPICS = frozenset({DECISIONS_TOPIC, STATUS_TOPIC, DIAGNOSTICS_TOPIC})
"""What a SmartTestudo publishes beside monitored topics."""


def monitored_topics(rule_set: RuleSet, output_topic: str) -> dict[str, str]:
    """The monitored topic of each relayed one; ``UsageError`` where a name is invalid or taken."""
    monitored = {topic: output_name(topic, output_topic) for topic in rule_set.relayed}
    taken = {*rule_set.relayed, *(signal.topic for signal in rule_set.signals), *OWN_TOPICS}
    for topic, name in monitored.items():
        if name in taken:
            cause = f"{topic} would be relayed to {name}, which is another topic's name"
            remedy = f"choose another pattern, such as {DEFAULT_OUTPUT_TOPIC}"
            raise UsageError(cause, place="--output-topic", remedy=remedy)
    return monitored


def is_monitored(topic: str, output_topic: str) -> bool:
    """Whether ``topic`` is named like a monitored one; never where those have the names of their sources."""
    before, _, after = output_topic.partition(TOPIC_PLACEHOLDER)
    return bool(before or after) and topic.startswith(f"{before}/") and topic.endswith(after)
