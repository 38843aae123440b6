# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rates of blocks that hold without them as well."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from smarttestudo.checks import wording
from smarttestudo.checks.analysis import RedundantRate
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Fix, Severity


def _find(book: RuleModel) -> Iterator[Found]:
    for _, alike in itertools.groupby(book.analysis.redundant_rates, lambda one: one.branch.order):
        of_branch = list(alike)
        branch = of_branch[0].branch
        actions = branch.block.block.otherwise if branch.is_else else branch.block.block.then
        if len(of_branch) == len(actions):
            yield _whole_branch(of_branch)
        else:
            yield from map(_one_rate, of_branch)


def _one_rate(one: RedundantRate) -> Found:
    setting = one.setting
    return Found(
        path=setting.path,
        span=setting.span,
        message=f"{setting.topic} is {setting.rate} without this as well, by the default ({_place(one)})",
        hint="remove it, or set another rate",
        fix=Fix(span=setting.span, replacement="", title="remove the rate without effect"),
    )


def _whole_branch(rates: Sequence[RedundantRate]) -> Found:
    branch = rates[0].branch
    same = [f"{one.setting.topic} is {one.setting.rate} by default ({_place(one)})" for one in rates]
    return Found(
        path=branch.block.path,
        span=branch.written[0].span.to(branch.written[-1].span),
        message=f"{wording.sentence(wording.branch_name(branch))} changes nothing: {wording.listed(same)}",
        hint="remove it, or set other rates",
    )


def _place(one: RedundantRate) -> str:
    return wording.place(one.default.path, one.default.span, seen_from=one.setting.path)


CHECK = RuleCheck(
    code="rate-without-effect",
    severity=Severity.INFO,
    meaning="A block sets a topic to the rate that it has by default, and overrules no other block there.",
    why="The rate is the same without it, whatever is known or unknown. A changed default would make it "
    "matter, which may be meant; mostly another number was.",
    bad=Example(
        rules="""\
begin
  SetFrequency /odom 10
  SetFrequency /scan 3
  If CheckValue /odom pose_x < 6 Then
    SetFrequency /odom 10
    SetFrequency /scan 5
end
"""
    ),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  SetFrequency /scan 3
  If CheckValue /odom pose_x < 6 Then
    SetFrequency /scan 5
end
"""
    ),
    find=_find,
)
