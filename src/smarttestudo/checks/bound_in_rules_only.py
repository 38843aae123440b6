# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics that only rules bound."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.checks.written import WrittenBound
from smarttestudo.domain.finding import Severity


def _find(book: RuleModel) -> Iterator[Found]:
    first: dict[str, WrittenBound] = {}
    for one in book.bounds:
        first.setdefault(one.topic, one)
    for topic in book.bound_in_rules_only:
        default = book.defaults.get(topic)
        if default is not None and not (default.rate is not None and default.rate.is_off):
            yield _found(first[topic], book)


def _found(bound: WrittenBound, book: RuleModel) -> Found:
    statement, rate = bound.statement, book.defaults[bound.topic].rate
    passes = "every message" if rate is not None and rate.is_full else "what its rate lets through"
    return Found(
        path=bound.path,
        span=statement.span,
        message=f"only rules bound {bound.topic}: while none of them is known to hold, also in doubt, "
        f"{passes} passes",
        hint=f"add KeepWithin {statement.topic.text} {statement.property} outside the rules for a bound that "
        "always holds",
    )


CHECK = RuleCheck(
    code="bound-in-rules-only",
    severity=Severity.INFO,
    meaning="A topic has a KeepWithin in rules, and none outside them.",
    why="No bound is more than any bound. So while values are unknown the bound of a rule that may hold does "
    "not count, unless another one is known to: what the rate of the topic lets through passes. With a bound "
    "outside the rules the tightest of those that may hold counts.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If CheckValue /battery_state level < 20 Then
    KeepWithin /odom position 0.1
  EndIf
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  KeepWithin /odom position 0.02
  If CheckValue /battery_state level < 20 Then
    KeepWithin /odom position 0.1
  EndIf
end
"""
    ),
    find=_find,
    needs_all_statements=True,
)
