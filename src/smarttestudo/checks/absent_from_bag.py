# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics that a recording does not hold, or a robot does not publish."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.close_topic import close_topic, write_topic
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity
from smarttestudo.language.parser.suggestions import did_you_mean


def _find(book: RuleModel) -> Iterator[Found]:
    recorded = book.context.bag_topics
    if recorded is None:
        return
    for topic, mention in book.mentions.items():
        if topic not in recorded:
            close = close_topic(topic, recorded)
            yield Found(
                path=mention.path,
                span=mention.name.span,
                message=f"{book.context.topics_lack} {topic}",
                hint=_hint(close),
                fix=write_topic(mention.name, close),
            )


def _hint(close: str | None) -> str:
    return (
        did_you_mean(close)
        if close
        else "a topic that never publishes is never relayed, and its values stay unknown"
    )


CHECK = RuleCheck(
    code="absent-from-bag",
    severity=Severity.INFO,
    meaning="A rule names a topic that the recording given with --bag does not contain, or that the robot "
    "given with --connect does not publish.",
    why="Usually the name is misspelt. Without such a topic nothing is relayed, and checks of it stay "
    "unknown.",
    bad=Example(
        rules="""\
begin
  SetFrequency /joint_state 3
end
""",
        bag_topics={"/joint_states": "sensor_msgs/msg/JointState"},
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /joint_states 3
end
""",
        bag_topics={"/joint_states": "sensor_msgs/msg/JointState"},
    ),
    find=_find,
)
