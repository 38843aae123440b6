# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of blocks without a default."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.analysis import Gap
from smarttestudo.checks.new_default import new_default
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity


def _find(book: RuleModel) -> Iterator[Found]:
    yield from (_without_rate(gap, book) for gap in book.analysis.gaps)
    rated = {topic for branch in book.branches for topic in branch.settings}.union(book.defaults)
    yield from (
        _found(topic, "no block bounds it", book) for topic in book.bound_in_rules_only if topic not in rated
    )


def _without_rate(gap: Gap, book: RuleModel) -> Found:
    state = wording.state(gap.state or {})
    return _found(gap.topic, f"no block sets it{f', for example at {state},' if state else ''}", book)


def _found(topic: str, where: str, book: RuleModel) -> Found:
    first = book.relayed[topic]
    return Found(
        path=first.path,
        span=first.statement.topic.span,
        message=f"{topic} has no default: it is Full{_cost(topic, book)} where {where} and while values are "
        "unknown",
        hint=f"add a default: SetFrequency {first.statement.topic.text} and a rate",
        fix=new_default(book.files.get(first.path), first.statement.topic.text),
    )


def _cost(topic: str, book: RuleModel) -> str:
    known = book.context.topic(topic)
    if known.message_kb is None or known.source_hz is None:
        return ""
    kb_per_s = known.message_kb * known.source_hz
    return f" ({kb_per_s:.{0 if kb_per_s >= 100 else 1}f} KB/s)"


CHECK = RuleCheck(
    code="missing-default",
    severity=Severity.WARNING,
    meaning="A block sets or bounds a topic that has neither a default nor a block for every case.",
    why="Where no block sets it, or bounds it, and while the values that the blocks read are unknown, the "
    "topic is Full: every message travels. For a camera that can be more than the whole link.",
    bad=Example(
        rules="""\
begin
  If CheckValue /battery_state level < 20 Then
    SetFrequency /camera/image_raw 2
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /camera/image_raw 10
  If CheckValue /battery_state level < 20 Then
    SetFrequency /camera/image_raw 2
end
"""
    ),
    find=_find,
    needs_all_statements=True,
)
