# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The comments of a statement on another one that takes its place."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TypeVar

from smarttestudo.adirf.comments import Comment, Trivia
from smarttestudo.adirf.document.meaning import Meaning, condition_meaning, meaning
from smarttestudo.adirf.document.stretch import Stretch
from smarttestudo.adirf.syntax import And, Block, Check, Condition, Group, Not, Or, SetFrequency, checks_in


def grafted(old: Block, new: Block, *, inside: Stretch) -> Block:
    """``new`` with the comments of ``old`` that stand ``inside`` its words, and its way to end."""
    above = tuple(
        comment for comment in old.trivia.above if inside.places.range(comment.span)[0] >= inside.start
    )
    sets = {one.topic.text: one.trivia for one in (*old.then, *old.otherwise)}
    written = {meaning(one): one for one in (*old.then, *old.otherwise)}
    return replace(
        new,
        condition=grafted_condition(old.condition, new.condition),
        then=tuple(_with_comments(one, sets, written) for one in new.then),
        otherwise=tuple(_with_comments(one, sets, written) for one in new.otherwise),
        has_end_if=old.has_end_if,
        trivia=replace(old.trivia, above=above, blank_above=False),
        if_trivia=old.if_trivia,
        then_trivia=old.then_trivia,
        else_trivia=old.else_trivia,
        end_if_trivia=old.end_if_trivia,
    )


def grafted_condition(old: Condition, new: Condition, *, beside: Comment | None = None) -> Condition:
    """``new`` with the comments and spellings of the checks that it has in common with ``old``.

    The comment ``beside`` stays where it is and is left out.
    """
    checks = {condition_meaning(one): _without(one, beside) for one in checks_in(old)}
    found = _with_checks(new, checks)
    if isinstance(old, Group) and isinstance(found, And | Or):
        found = Group(operand=found, span=found.span)
    if isinstance(old, Group) and isinstance(found, Group):
        return replace(found, trivia=_without(old, beside).trivia, closing=old.closing)
    return found


_Commented = TypeVar("_Commented", Check, Group)


def _without(condition: _Commented, beside: Comment | None) -> _Commented:
    if beside is None or condition.trivia.beside != beside:
        return condition
    return replace(condition, trivia=replace(condition.trivia, beside=None))


def _with_checks(condition: Condition, checks: Mapping[Meaning, Check]) -> Condition:
    match condition:
        case Check():
            return checks.get(condition_meaning(condition), condition)
        case Not() | Group():
            return replace(condition, operand=_with_checks(condition.operand, checks))
        case And() | Or():
            operands = tuple(_with_checks(one, checks) for one in condition.operands)
            return replace(condition, operands=operands)


def _with_comments(
    new: SetFrequency, sets: Mapping[str, Trivia], written: Mapping[Meaning, SetFrequency]
) -> SetFrequency:
    same = written.get(meaning(new))
    if same is not None:
        return same
    return replace(new, trivia=sets.get(new.topic.text, new.trivia))
