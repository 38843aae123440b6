# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The statements between ``begin`` and ``end``."""

from __future__ import annotations

from smarttestudo.adirf.parser.blocks import parse_block, parse_set, parse_sets
from smarttestudo.adirf.parser.cursor import SAFE_PLACES, STATEMENT_STARTS, BrokenStatementError, Cursor
from smarttestudo.adirf.parser.tokens import TokenKind
from smarttestudo.adirf.parser.values import parse_hertz, parse_topic
from smarttestudo.adirf.syntax import KeepAtLeast, Statement
from smarttestudo.domain.finding import Fix

_ENDS = frozenset({TokenKind.END, TokenKind.BEGIN, TokenKind.END_OF_FILE})
_EXPECTED = frozenset({*STATEMENT_STARTS, TokenKind.END})
_EXPECTED_TEXT = "a statement ('SetFrequency', 'KeepAtLeast', 'Rule' or 'If') or 'end'"


def parse_statements(cursor: Cursor) -> tuple[Statement, ...]:
    """The whole statements up to ``end``, the next ``begin`` or the end of the file."""
    statements: list[Statement] = []
    cursor.is_block_open = False
    while cursor.kind not in _ENDS:
        cursor.begin_statement()
        if cursor.is_block_open and cursor.kind is TokenKind.KEEP_AT_LEAST:
            _report_open_block(cursor)
        cursor.is_block_open = False
        try:
            statement = _statement(cursor)
        except BrokenStatementError:
            cursor.skip_to(SAFE_PLACES)
        else:
            statements.extend([statement] if statement is not None else [])
    return tuple(statements)


def _report_open_block(cursor: Cursor) -> None:
    fix = Fix(span=cursor.previous.end, replacement="\nEndIf", title="put EndIf before it")
    message = "'KeepAtLeast' cannot follow a block that has no 'EndIf'"
    cursor.report("missing-end-if", message, hint="put EndIf before it", fix=fix)


def _statement(cursor: Cursor) -> Statement | None:
    match cursor.kind:
        case TokenKind.SET_FREQUENCY:
            return parse_set(cursor)
        case TokenKind.KEEP_AT_LEAST:
            return _keep(cursor)
        case TokenKind.RULE | TokenKind.IF:
            return parse_block(cursor)
        case TokenKind.THEN | TokenKind.ELSE | TokenKind.END_IF:
            _refuse_part_of_block(cursor)
        case _:
            _refuse_unknown(cursor)
    return None


def _keep(cursor: Cursor) -> KeepAtLeast:
    first = cursor.advance()
    topic = parse_topic(cursor)
    rate = parse_hertz(cursor, "expected-rate", "a number of Hz")
    return KeepAtLeast(topic=topic, rate=rate, span=cursor.span_from(first), trivia=cursor.take_trivia(first))


def _refuse_part_of_block(cursor: Cursor) -> None:
    token = cursor.token
    is_end = token.kind is TokenKind.END_IF
    fix = Fix(span=token.span, replacement="", title="delete it") if is_end else None
    cursor.report("stray-keyword", f"no 'If' is open for this '{token.text}'", fix=fix)
    if is_end:
        cursor.advance()
    else:
        _skip_body(cursor)


def _refuse_unknown(cursor: Cursor) -> None:
    if cursor.mend("expected-statement", _EXPECTED_TEXT, _EXPECTED):
        return
    is_condition = cursor.kind in (TokenKind.CHECK_VALUE, TokenKind.OPEN, TokenKind.NOT)
    fix = Fix(span=cursor.token.start, replacement="If ", title="put 'If' here") if is_condition else None
    hint = "a condition stands behind 'If'" if is_condition else ""
    cursor.report_found("expected-statement", _EXPECTED_TEXT, hint=hint, fix=fix)
    cursor.advance()
    cursor.skip_to(SAFE_PLACES)
    cursor.mend("expected-then", "'Then'", (TokenKind.THEN,))
    if cursor.kind is TokenKind.THEN:
        _skip_body(cursor)


def _skip_body(cursor: Cursor) -> None:
    """Check the statements of a block whose head is lost."""
    while cursor.kind in (TokenKind.THEN, TokenKind.ELSE):
        cursor.advance()
        parse_sets(cursor, after_error=True)
    if cursor.take(TokenKind.END_IF):
        cursor.is_block_open = False
