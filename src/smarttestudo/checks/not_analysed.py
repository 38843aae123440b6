# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Blocks that are too complex for the interval analysis."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.rule_check import Example, Found, RuleCheck
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Severity


def _find(book: RuleModel) -> Iterator[Found]:
    unfinished = book.analysis.unfinished
    if unfinished:
        first = unfinished[0]
        more = f" (and {len(unfinished) - 1} more)" if len(unfinished) > 1 else ""
        yield Found(
            path=first.path,
            span=first.block.condition.span,
            message=f"{wording.block_name(first.block)}{more} is too complex to find all clashes "
            "and dead blocks",
            hint="the rules work regardless; several small blocks are easier to check",
        )


def _pigeons(count: int) -> str:
    """A condition that never holds, although each part of it can: more pigeons than holes.

    A. Haken, "The intractability of resolution", 1985.
    """
    holes = range(1, count)
    somewhere = [
        "(" + " OR ".join(f"CheckValue /pigeon_{pigeon} hole[{hole}] > 0" for hole in holes) + ")"
        for pigeon in range(count)
    ]
    alone = [
        f"(CheckValue /pigeon_{one} hole[{hole}] <= 0 OR CheckValue /pigeon_{other} hole[{hole}] <= 0)"
        for hole in holes
        for one, other in itertools.combinations(range(count), 2)
    ]
    condition = "\n    AND ".join([*somewhere, *alone])
    return f"begin\n  SetFrequency /odom 10\n  If ({condition}) Then\n    SetFrequency /odom 4\nend\n"


CHECK = RuleCheck(
    code="not-analysed",
    severity=Severity.INFO,
    meaning="A condition is too complex for the checker to analyse completely.",
    why="Finding all clashes and dead blocks is NP-hard in general, so the checker stops after a bounded "
    "effort. What it reports is still right; it may have missed something.",
    bad=Example(rules=_pigeons(7)),
    good=Example(
        rules="""\
begin
  SetFrequency /odom 10
  If (CheckValue /odom pose_x > 6 OR CheckValue /odom pose_y > 3) Then
    SetFrequency /odom 4
end
"""
    ),
    find=_find,
)
