# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics of blocks without a default."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.adirf.checks import wording
from smarttestudo.adirf.checks.analysis import Gap
from smarttestudo.adirf.checks.new_default import new_default
from smarttestudo.adirf.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.adirf.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity


def _find(book: RuleModel) -> Iterator[Found]:
    return (_found(gap, book) for gap in book.analysis.gaps)


def _found(gap: Gap, book: RuleModel) -> Found:
    first = book.relayed[gap.topic]
    state = wording.state(gap.state or {})
    return Found(
        path=first.path,
        span=first.statement.topic.span,
        message=f"{gap.topic} has no default: it is Full{_cost(gap.topic, book)} where no block sets it"
        f"{f', for example at {state},' if state else ''} and while values are unknown",
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
    meaning="A block sets a topic that has neither a default nor a block for every case.",
    why="Where no block sets it, and while the values that the blocks read are unknown, the topic is Full: "
    "every message travels. For a camera that can be more than the whole link.",
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
