# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings of topics that nobody publishes, as far as is known."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.close_topic import close_topic, write_topic
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.profile import Profile, TopicProfile


def _find(book: RuleModel) -> Iterator[Found]:
    profile = book.context.profile
    if profile is None or not profile.topics or book.context.bag_topics is not None:
        # What a recording lacks is said of all topics at once, see absent-from-bag.
        return
    for one in book.recordings:
        for name, topic in zip(one.record.topics, one.topics, strict=True):
            if topic not in profile.topics:
                yield Found(
                    path=one.block.path,
                    span=name.span,
                    message=f"the profile has no {topic}, so that its recordings may lack it",
                    hint="is the name misspelt? else measure the profile again",
                    fix=write_topic(name, close_topic(topic, profile.topics)),
                )


_PROFILE = Profile(topics={"/scan": TopicProfile(), "/odom": TopicProfile()})

CHECK = RuleCheck(
    code="record-unpublished",
    severity=Severity.WARNING,
    meaning="A Record names a topic that the profile does not contain.",
    why="Usually the name is misspelt, and the one topic that would explain an incident is not in it.",
    bad=Example(
        rules="""\
begin
  SetFrequency /scan 5
  SetFrequency /odom 5
  If CheckValue /scan distance < 0.5 Then
    Record "near miss" /scan /odometry Before 30 s After 10 s
end
""",
        profile=_PROFILE,
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /scan 5
  SetFrequency /odom 5
  If CheckValue /scan distance < 0.5 Then
    Record "near miss" /scan /odom Before 30 s After 10 s
end
""",
        profile=_PROFILE,
    ),
    find=_find,
)
