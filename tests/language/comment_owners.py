# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which statement of a syntax tree holds which comment."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.language.syntax import (
    Action,
    And,
    Block,
    Comment,
    Condition,
    Group,
    Not,
    Or,
    RuleFile,
    Statement,
    Timed,
    Trivia,
)


def comments_by_owner(file: RuleFile) -> list[tuple[str, int]]:
    """Each comment's text with the number of its owner, in the order of ``rule_strategies.words_of``."""
    return list(_Walker().file(file))


class _Walker:
    def __init__(self) -> None:
        self._owners = 0

    def file(self, file: RuleFile) -> Iterator[tuple[str, int]]:
        for collection in file.collections:
            self._owners += 1
            yield from _owned([*_of(collection.trivia), *_of(collection.end_trivia)], self._owners)
            for statement in collection.statements:
                yield from self._statement(statement)
        yield from _owned(file.footer, 0)

    def _statement(self, statement: Statement | Action) -> Iterator[tuple[str, int]]:
        self._owners += 1
        yield from _owned(_of(statement.trivia), self._owners)
        if isinstance(statement, Block):
            yield from _owned(_of_block(statement), self._owners)
            for inner in (*statement.then, *statement.otherwise):
                yield from self._statement(inner)


def _owned(comments: object, owner: int) -> Iterator[tuple[str, int]]:
    assert isinstance(comments, list | tuple)
    return ((comment.text, owner) for comment in comments)


def _of(trivia: Trivia) -> list[Comment]:
    return [*trivia.above, *([trivia.beside] if trivia.beside else [])]


def _of_block(block: Block) -> list[Comment]:
    keywords = (block.if_trivia, block.then_trivia, block.else_trivia, block.end_if_trivia)
    return [*_of_condition(block.condition), *(comment for trivia in keywords for comment in _of(trivia))]


def _of_condition(condition: Condition) -> list[Comment]:
    match condition:
        case And() | Or():
            return [comment for operand in condition.operands for comment in _of_condition(operand)]
        case Group():
            return [*_of(condition.trivia), *_of_condition(condition.operand), *condition.closing]
        case Timed():
            return _of_condition(condition.operand)
        case Not():
            return [*_of(condition.trivia), *_of_condition(condition.operand)]
        case _:
            return _of(condition.trivia)
