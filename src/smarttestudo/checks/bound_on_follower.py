# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bounds of topics that are paced with another one."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import ProfileFix, Severity
from smarttestudo.domain.profile import Profile, TopicProfile


def _find(book: RuleModel) -> Iterator[Found]:
    for one in book.bounds:
        leader = book.context.topic(one.topic).paced_with
        if leader is not None:
            yield Found(
                path=one.path,
                span=one.statement.span,
                message=f"{one.topic} is paced with {leader}, so this bound has no effect",
                hint=f"bind {leader}, or remove paced_with from the profile",
                profile_fix=ProfileFix(
                    topic=one.topic,
                    key="paced_with",
                    value=None,
                    title=f"no longer pace {one.topic} with {leader}",
                ),
            )


_PROFILE = Profile(
    path="profile.toml", topics={"/odom": TopicProfile(paced_with="/scan"), "/scan": TopicProfile()}
)


CHECK = RuleCheck(
    code="bound-on-follower",
    severity=Severity.WARNING,
    meaning="A KeepWithin names a topic that the profile paces with another one.",
    why="A topic that is paced with another one passes exactly the stamps that the other passed. Its own "
    "picture is not looked at, and may be off by more than the bound.",
    bad=Example(
        rules="""\
begin
  SetFrequency /scan 5
  SetFrequency /odom 5
  KeepWithin /odom position 0.05
end
""",
        profile=_PROFILE,
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /scan 5
  SetFrequency /odom 5
  KeepWithin /scan distance 0.1
end
""",
        profile=_PROFILE,
    ),
    find=_find,
)
