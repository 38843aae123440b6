# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The right side of checks: numbers, true and false, texts, and constants of message types."""

from __future__ import annotations

import re
from typing import NoReturn

from smarttestudo.domain.finding import Fix
from smarttestudo.domain.signal import MAX_TEXT_BYTES
from smarttestudo.language.parser.cursor import (
    BrokenStatementError,
    Cursor,
    FindingLog,
    closest,
    did_you_mean,
)
from smarttestudo.language.parser.lexer import Token, TokenKind, tokenize
from smarttestudo.language.parser.values import parse_number, quoted, unquoted
from smarttestudo.language.syntax import Compared, Constant, Operator, Until

_OPERATORS = {operator.value: operator for operator in Operator}
_EQUALITIES = frozenset({Operator.EQUAL, Operator.NOT_EQUAL})
_TRUTHS = {"true": True, "false": False}
_CONSTANT = re.compile(
    r"(?:(?P<type>[A-Za-z][A-Za-z0-9_]*(?:/[A-Za-z0-9_]+)*)\.)?(?P<name>[A-Z](?:_?[A-Z0-9])*)\Z"
)
_EXPECTED_VALUE = "a value to compare with (a number, a text in quotes, 'true', 'false' or a constant)"
_EXPECTED_AFTER_CHECK = "'Until', 'For', 'Within' or the end of the condition"
_UNTIL_WORD = frozenset({TokenKind.UNTIL})
_EXPECTED_OPERATOR = "a comparison (>, <, >=, <=, = or !=)"


def parse_comparison(cursor: Cursor) -> tuple[Operator, Compared, str]:
    """The operator, the value behind it, and its spelling."""
    operator = _operator(cursor)
    first = cursor.token
    value, text = parse_value(cursor)
    if isinstance(value, str | bool) and operator not in _EQUALITIES:
        what = f"'{text}'" if isinstance(value, bool) else "a text"
        cursor.report("text-order", f"{what} is compared with '=' or '!=' only", span=first.span)
    return operator, value, text


def parse_value(cursor: Cursor) -> tuple[Compared, str]:
    """A number, true or false, a text or a constant, and its spelling."""
    token = cursor.token
    if token.kind is TokenKind.STRING:
        value = unquoted(cursor, token, "invalid-text", "a text")
        if len(value.encode("utf-8", "surrogatepass")) > MAX_TEXT_BYTES:
            cursor.report("text-too-long", f"a text has at most {MAX_TEXT_BYTES} bytes")
        cursor.advance()
        return value, token.text
    if token.kind is not TokenKind.WORD:
        return parse_number(cursor, "expected-number", _EXPECTED_VALUE)
    constant = _CONSTANT.match(token.text)
    if token.text not in _TRUTHS and constant is None:
        _refuse_word(cursor, token)
    cursor.advance()
    if constant is None:
        return _TRUTHS[token.text], token.text
    return Constant(type_name=constant["type"] or "", name=constant["name"]), token.text


def _refuse_word(cursor: Cursor, token: Token) -> NoReturn:
    truth = token.text.casefold()
    right = truth if truth in _TRUTHS else quoted(token.text)
    fix = Fix(span=token.span, replacement=right, title=f"write {right}")
    raise cursor.failure("expected-number", _EXPECTED_VALUE, hint=did_you_mean(right), fix=fix)


def parse_until(cursor: Cursor) -> Until | None:
    """``Until op VALUE`` behind a check, if it is there."""
    cursor.mend("expected-connective", _EXPECTED_AFTER_CHECK, _UNTIL_WORD)
    first = cursor.accept(TokenKind.UNTIL)
    if first is None:
        return None
    operator, value, text = parse_comparison(cursor)
    return Until(operator=operator, value=value, text=text, span=cursor.span_from(first))


def _operator(cursor: Cursor) -> Operator:
    token = cursor.token
    if token.kind is TokenKind.OPERATOR:
        cursor.advance()
        return _OPERATORS[token.text]
    right = closest(token.text, _OPERATORS) if token.kind is TokenKind.FOREIGN else None
    if right is None:
        raise cursor.failure("expected-operator", _EXPECTED_OPERATOR)
    fix = Fix(span=token.span, replacement=right, title=f"write {right}")
    cursor.report_found("expected-operator", _EXPECTED_OPERATOR, hint=did_you_mean(right), fix=fix)
    cursor.advance()
    return _OPERATORS[right]


def written_value(text: str) -> Compared | None:
    """The value that ``text`` writes, ``None`` where it writes none, or more."""
    cursor = Cursor(tokenize(text), FindingLog(""))
    try:
        value, spelling = parse_value(cursor)
    except BrokenStatementError:
        return None
    return value if spelling == text.strip() else None
