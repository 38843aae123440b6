# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lint rules of what blocks set, call and notify."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

from smarttestudo.checks import wording
from smarttestudo.checks.analysis.conflicts import sample_state
from smarttestudo.checks.lint_rule import Found, lint_rule
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.action import ActionKind, ActRequest, value_text
from smarttestudo.domain.finding import Severity, Span
from smarttestudo.domain.profile import Profile
from smarttestudo.language.boxes import Box, Effort, TooComplexError, find_box
from smarttestudo.language.resolved_rules import Branch
from smarttestudo.language.rule_set import act_request

_LOOKS_IN_ALL, _LOOKS_AT_A_PAIR = 200_000, 10_000
"""How much is compared to find blocks that clash."""


class _Written(NamedTuple):
    """A statement where it stands."""

    branch: Branch
    span: Span
    action: ActRequest

    @property
    def path(self) -> str:
        return self.branch.block.path


def _actions(rules: RuleModel) -> Iterator[_Written]:
    for branch in rules.acting:
        for act in branch.acts:
            yield _Written(branch, act.span, act_request(act, rules.context.resolve))


@lint_rule("action-not-allowed", Severity.WARNING)
def action_not_allowed(rules: RuleModel) -> Iterator[Found]:
    """A rule sets a parameter or calls a service that the profile does not allow.

    On the robot it is not done. Only the profile there can allow it, which rules that are pushed do not
    change: a parameter in allow_parameters, below its node, a service in allow_calls.
    """
    profile = rules.context.profile or Profile()
    for written in _actions(rules):
        action = written.action
        if profile.allows(action):
            continue
        is_call = action.kind is ActionKind.CALL
        entry = f'allow_calls = ["{action.target}"]'
        if not is_call:
            entry = f'allow_parameters = {{ "{action.target}" = ["{action.parameter}"] }}'
        yield Found(
            path=written.path,
            span=written.span,
            message=f"nothing allows rules to {'call' if is_call else 'set'} {action.place}",
            hint=f"write {entry} in the profile of the robot",
        )


@lint_rule("parameter-twice", Severity.ERROR)
def parameter_twice(rules: RuleModel) -> Iterator[Found]:
    """A Then or Else sets one parameter twice.

    One block can give a parameter only one value; a program cannot know which of the two was meant.
    """
    first: dict[tuple[int, str], _Written] = {}
    for written in _actions(rules):
        if written.action.kind is not ActionKind.SET_PARAMETER:
            continue
        earlier = first.setdefault((written.branch.order, written.action.place), written)
        if earlier is not written:
            yield Found(
                path=written.path,
                span=written.span,
                message=f"{written.action.place} is already set at line {earlier.span.line}",
                hint="keep one of the two",
            )


@lint_rule("parameters-clash", Severity.WARNING)
def parameters_clash(rules: RuleModel) -> Iterator[Found]:
    """Two blocks of one priority can hold together and set a parameter to different values.

    The block that comes first in the files wins. If the other one was meant, the node is not as planned.
    """
    by_place: dict[str, list[_Written]] = {}
    for written in _actions(rules):
        if written.action.kind is ActionKind.SET_PARAMETER:
            by_place.setdefault(written.action.place, []).append(written)
    in_all = Effort(_LOOKS_IN_ALL)
    try:
        for setters in by_place.values():
            for one, other in combinations(setters, 2):
                in_all.spend(1)
                if _may_clash(one, other) and (box := _common(one, other, rules, in_all)) is not None:
                    yield _clashing(one, other, box)
    except TooComplexError:
        return


def _may_clash(one: _Written, other: _Written) -> bool:
    mine, others = one.branch.block, other.branch.block
    return mine is not others and mine.priority == others.priority and not one.action.is_same(other.action)


def _common(one: _Written, other: _Written, rules: RuleModel, in_all: Effort) -> Box | None:
    """Where both hold, if that is found; raises ``TooComplexError`` once all effort is spent."""
    try:
        forms = (one.branch.form, other.branch.form)
        return find_box(forms, rules.context.domain, Effort(_LOOKS_AT_A_PAIR, in_all))
    except TooComplexError:
        return None


def _clashing(one: _Written, other: _Written, box: Box) -> Found:
    state = wording.state(sample_state(box))
    earlier = wording.branch_with_place(one.branch, seen_from=other.path)
    return Found(
        path=other.path,
        span=other.span,
        message=f"{wording.branch_name(other.branch)} sets {other.action.place} to "
        f"{value_text(other.action.value)}, {earlier} to {value_text(one.action.value)}, and both hold "
        f"{f'for example at {state}' if state else 'in some state'}",
        related=wording.places_in(other.path, [one.branch]),
        hint="the first block wins; give one a higher Priority, or keep their conditions apart",
    )
