# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""/tf without /tf_static."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.new_default import new_default
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity


def _find(book: RuleModel) -> Iterator[Found]:
    relayed = book.relayed
    for topic, first in relayed.items():
        if topic.endswith("/tf") and f"{topic}_static" not in relayed:
            yield Found(
                path=first.path,
                span=first.statement.topic.span,
                message=f"{topic} is relayed without {topic}_static",
                hint=f"add SetFrequency {first.statement.topic.text}_static Full",
                fix=new_default(book.files.get(first.path), f"{first.statement.topic.text}_static"),
            )


CHECK = RuleCheck(
    code="tf-without-tf-static",
    severity=Severity.INFO,
    meaning="/tf is relayed and /tf_static is not.",
    why="The fixed frames, for instance from the base to the LiDAR, travel on /tf_static only. Without them "
    "the operator's RViz cannot place the scan. They cost one message for each new "
    "subscriber.",
    bad=Example(
        rules="""\
begin
  SetFrequency /tf 10
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /tf 10
  SetFrequency /tf_static Full
end
"""
    ),
    find=_find,
    needs_all_statements=True,
)
