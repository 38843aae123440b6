# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A tier without a profile that gives it a rate or an accuracy."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.rate import Tier
from smarttestudo.language.syntax import bound_span


def _find(book: RuleModel) -> Iterator[Found]:
    if book.context.profile is not None:
        return
    for one in book.settings:
        tier = one.statement.rate.value
        if isinstance(tier, Tier):
            yield Found(
                path=one.path,
                span=one.statement.rate.span,
                message=f"{tier.value} has no rate without a profile",
                hint=f"write a rate in Hz, or {book.context.way_to_profile}",
            )
    for bound in book.bounds:
        tier = bound.statement.bound
        if isinstance(tier, Tier):
            yield Found(
                path=bound.path,
                span=bound_span(bound.statement),
                message=f"{tier.value} has no accuracy without a profile",
                hint=f"write a number, or {book.context.way_to_profile}",
            )


CHECK = RuleCheck(
    code="tier-without-rate",
    severity=Severity.ERROR,
    meaning="A quality level is written and no profile gives it a rate, or an accuracy in a KeepWithin.",
    why="A level stands for the rate that the optimizer finds for it within the budget, from the profile's "
    "sizes and levels. Without a profile its rate is unknown. The same is true of accuracies.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom Desirable
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 25
end
"""
    ),
    find=_find,
)
