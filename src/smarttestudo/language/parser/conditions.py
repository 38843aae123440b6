# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Conditions: checks joined by ``AND``, ``OR``, ``Not`` and parentheses."""

from __future__ import annotations

from smarttestudo.language.parser.comparisons import parse_comparison, parse_until
from smarttestudo.language.parser.cursor import BrokenStatementError, Cursor
from smarttestudo.language.parser.lexer import CONNECTIVES, Token, TokenKind
from smarttestudo.language.parser.values import parse_property, parse_read, parse_time_parts, timed
from smarttestudo.language.properties.field_path import ANY
from smarttestudo.language.syntax import And, Check, Condition, Group, Not, Or, Trivia

MAX_NESTING = 100
# Below Python 3.12, looking a member up in its enum costs as much as a call.
_CHECK_VALUE, _OPEN, _CLOSE, _NOT, _AND, _OR, _WORD = (
    TokenKind.CHECK_VALUE,
    TokenKind.OPEN,
    TokenKind.CLOSE,
    TokenKind.NOT,
    TokenKind.AND,
    TokenKind.OR,
    TokenKind.WORD,
)
_CONDITION_WORDS = frozenset({_CHECK_VALUE, _NOT})
_EXPECTED = "a condition ('CheckValue', 'Not' or '(')"
_EXPECTED_IN_GROUP = "'AND', 'OR' or ')'"


def parse_condition(cursor: Cursor, depth: int = 0) -> Condition:
    """A check or a group in parentheses with its times, or a ``Not``.

    ``depth`` counts the groups and ``Not`` around it.
    """
    if depth > MAX_NESTING:
        cursor.report("nested-too-deep", f"conditions nest at most {MAX_NESTING} deep", hint="split the rule")
        raise BrokenStatementError
    if cursor.kind is not _CHECK_VALUE:
        cursor.mend("expected-condition", _EXPECTED, _CONDITION_WORDS)
    kind = cursor.kind
    if kind is _CHECK_VALUE:
        return _check(cursor)
    if kind is _OPEN:
        return _group(cursor, depth)
    if kind is _NOT:
        return _not(cursor, depth)
    hint = "put 'CheckValue' before it" if kind is _WORD else ""
    raise cursor.failure("expected-condition", _EXPECTED, hint=hint)


def _not(cursor: Cursor, depth: int) -> Not:
    first = cursor.advance()
    trivia = Trivia(above=cursor.take_above())
    operand = parse_condition(cursor, depth + 1)
    return Not(operand=operand, span=cursor.span_from(first), trivia=trivia)


def _group(cursor: Cursor, depth: int) -> Condition:
    first = cursor.advance()
    above = cursor.take_above()
    operand = _expression(cursor, depth + 1)
    if cursor.kind is not _CLOSE:
        _refuse_end_of_group(cursor, first)
    cursor.advance()
    span = cursor.span_from(first)
    parts = parse_time_parts(cursor)
    end = cursor.take_trivia(first)
    group = Group(
        operand=operand, span=span, trivia=Trivia(above=above, beside=end.beside), closing=end.above
    )
    return timed(group, parts)


def _refuse_end_of_group(cursor: Cursor, opened: Token) -> None:
    expected = _EXPECTED_IN_GROUP
    if cursor.kind in (TokenKind.CHECK_VALUE, TokenKind.OPEN, TokenKind.NOT):
        raise cursor.failure("expected-connective", expected, hint="join conditions with 'AND' or 'OR'")
    hint = f"the '(' at {opened.line}:{opened.column} is still open"
    raise cursor.failure("unclosed-parenthesis", expected, hint=hint)


def _expression(cursor: Cursor, depth: int) -> Condition:
    terms = [_term(cursor, depth)]
    timed_depth = cursor.timed_depth
    while cursor.accept(_OR):
        terms.append(_term(cursor, depth))
        timed_depth = max(timed_depth, cursor.timed_depth)
    cursor.timed_depth = timed_depth
    return terms[0] if len(terms) == 1 else Or(operands=tuple(terms), span=terms[0].span.to(terms[-1].span))


def _term(cursor: Cursor, depth: int) -> Condition:
    factors = [parse_condition(cursor, depth)]
    timed_depth = cursor.timed_depth
    _mend_connective(cursor)
    while cursor.accept(_AND):
        factors.append(parse_condition(cursor, depth))
        timed_depth = max(timed_depth, cursor.timed_depth)
        _mend_connective(cursor)
    cursor.timed_depth = timed_depth
    return (
        factors[0]
        if len(factors) == 1
        else And(operands=tuple(factors), span=factors[0].span.to(factors[-1].span))
    )


def _mend_connective(cursor: Cursor) -> None:
    cursor.mend("expected-connective", _EXPECTED_IN_GROUP, CONNECTIVES)


def _check(cursor: Cursor) -> Condition:
    first = cursor.advance()
    cursor.timed_depth = 0
    topic = parse_read(cursor)
    name = parse_property(cursor, topic.text)
    operator, value, text = parse_comparison(cursor)
    until = parse_until(cursor)
    if until is not None and ANY in name.text:
        message = "a check of any element has no 'Until': each message has other elements"
        cursor.report("until-of-any", message, span=until.span, hint="write 'For' or 'Within'")
    span = cursor.span_from(first)
    parts = parse_time_parts(cursor)
    check = Check(
        topic=topic,
        property=name.text,
        property_span=name.span,
        operator=operator,
        value=value,
        text=text,
        span=span,
        until=until,
        trivia=cursor.take_trivia(first),
    )
    return timed(check, parts)
