# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of the profile that no rule names."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.source import Span

_START = Span(line=1, column=1, end_line=1, end_column=1)


def _find(book: RuleModel) -> Iterator[Found]:
    profile = book.context.profile
    if profile is None:
        return
    unnamed = [topic for topic in profile.topics if topic not in book.mentions]
    if unnamed:
        yield Found(
            path=profile.path,
            span=_START,
            message=f"no rule names {wording.listed(unnamed)}, which the profile holds",
            hint="only topics of a SetFrequency or KeepAtLeast are relayed",
        )


_PROFILE = Profile(path="profile.toml", topics={"/odom": TopicProfile(), "/scan": TopicProfile()})

CHECK = RuleCheck(
    code="unnamed-in-profile",
    severity=Severity.INFO,
    meaning="A topic is in the profile and in no rule file.",
    why="Only topics of a SetFrequency or KeepAtLeast are relayed. The operator does not see this one at "
    "all.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
end
""",
        profile=_PROFILE,
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  SetFrequency /scan 3
end
""",
        profile=_PROFILE,
    ),
    find=_find,
    needs_all_statements=True,
)
