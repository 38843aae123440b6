# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Conditions as text: on one line where they fit, else one operand a line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from smarttestudo.language.comments import Comment
from smarttestudo.language.formatter.text import INDENT, LineWriter, duration_text, number_text
from smarttestudo.language.syntax import And, Check, Condition, Group, Not, Or, Timed

MAX_WIDTH = 100


def write_condition(writer: LineWriter, level: int, lead: str, condition: Condition) -> None:
    """Add the whole condition of a block; ``lead`` stands before it on its first line."""
    _write(writer, level, lead, _grouped(condition))


def _write(writer: LineWriter, level: int, lead: str, condition: Condition, tail: str = "") -> None:
    """Add ``condition``; ``tail`` stands behind it on its last line."""
    match condition:
        case Check():
            _write_comments(writer, level, condition.trivia.above)
            writer.line(level, f"{lead}{_check(condition)}{tail}", condition.trivia.beside)
        case Not():
            _write_comments(writer, level, condition.trivia.above)
            _write(writer, level, f"{lead}Not ", _grouped(condition.operand))
        case Group():
            _write_group(writer, level, lead, condition, tail)
        case Timed():
            _write(writer, level, lead, _timed_operand(condition), f"{_time(condition)}{tail}")
        case And() | Or():
            _write_joined(writer, level, lead, condition, level)


def _write_group(writer: LineWriter, level: int, lead: str, group: Group, tail: str) -> None:
    _write_comments(writer, level, group.trivia.above)
    line = _one_line(_group_pieces(group), _room(level, lead) - len(tail))
    if line is not None:
        writer.line(level, f"{lead}{line}{tail}", group.trivia.beside)
        return
    writer.line(level, f"{lead}(")
    _write(writer, level + 1, "", group.operand)
    _write_comments(writer, level + 1, group.closing)
    writer.line(level, f"){tail}", group.trivia.beside)


def _write_joined(
    writer: LineWriter, level: int, lead: str, condition: And | Or, level_of_others: int
) -> None:
    """One operand a line; those of an ``AND`` inside an ``OR`` stand one level in, but for the first."""
    connective = "AND " if isinstance(condition, And) else "OR "
    at, before = level, lead
    for operand in condition.operands:
        _write_operand(writer, at, before, _bound(operand, condition))
        at, before = level_of_others, connective


def _write_operand(writer: LineWriter, level: int, lead: str, operand: Condition) -> None:
    line = _one_line(_pieces(operand), _room(level, lead))
    if line is not None:
        writer.line(level, f"{lead}{line}")
    elif isinstance(operand, And | Or):
        _write_joined(writer, level, lead, operand, level + 1)
    else:
        _write(writer, level, lead, operand)


def _write_comments(writer: LineWriter, level: int, comments: Iterable[Comment]) -> None:
    for comment in comments:
        writer.line(level, comment.text)


def _grouped(condition: Condition) -> Condition:
    """Where the language wants one condition, several need parentheses."""
    return Group(operand=condition, span=condition.span) if isinstance(condition, And | Or) else condition


def _bound(operand: Condition, around: And | Or) -> Condition:
    """An ``OR`` inside an ``AND`` needs parentheses."""
    return _grouped(operand) if isinstance(around, And) and isinstance(operand, Or) else operand


def _timed_operand(timed: Timed) -> Condition:
    """Without parentheses, a time behind a ``Not`` would belong to what the ``Not`` is about."""
    operand = timed.operand
    return Group(operand=operand, span=operand.span) if isinstance(operand, And | Or | Not) else operand


def _time(timed: Timed) -> str:
    return f" {timed.word.value} {duration_text(timed.duration)}"


def _room(level: int, lead: str) -> int:
    return MAX_WIDTH - INDENT * level - len(lead)


def _one_line(pieces: Iterable[str | None], room: int) -> str | None:
    """The pieces on one line; ``None`` when they need more than ``room`` or hold a comment."""
    line: list[str] = []
    for piece in pieces:
        if piece is None or len(piece) > room:
            return None
        room -= len(piece)
        line.append(piece)
    return "".join(line)


def _pieces(condition: Condition) -> Iterator[str | None]:
    """The condition in pieces of text, with ``None`` for a comment."""
    if not isinstance(condition, And | Or | Timed) and (condition.trivia.above or condition.trivia.beside):
        yield None
    match condition:
        case Check():
            yield _check(condition)
        case Not():
            yield "Not "
            yield from _pieces(_grouped(condition.operand))
        case Group():
            yield from _group_pieces(condition)
        case Timed():
            yield from _pieces(_timed_operand(condition))
            yield _time(condition)
        case And() | Or():
            connective = " AND " if isinstance(condition, And) else " OR "
            for index, operand in enumerate(condition.operands):
                yield connective if index else ""
                yield from _pieces(_bound(operand, condition))


def _group_pieces(group: Group) -> Iterator[str | None]:
    yield "("
    yield from _pieces(group.operand)
    if group.closing:
        yield None
    yield ")"


def _check(check: Check) -> str:
    number = check.text or number_text(check.value)
    text = f"CheckValue {check.topic.text} {check.property} {check.operator.value} {number}"
    if check.until is None:
        return text
    return f"{text} Until {check.until.operator.value} {check.until.text or number_text(check.until.value)}"
