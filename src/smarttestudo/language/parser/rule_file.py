# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rule file, parsed; after an error the parser goes on at the next statement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from smarttestudo.domain.finding import Finding, Fix, Span
from smarttestudo.language.parser.blocks import parse_actions, parse_block, parse_set, parse_within
from smarttestudo.language.parser.cursor import (
    SAFE_PLACES,
    STATEMENT_STARTS,
    BrokenStatementError,
    Cursor,
    FindingLog,
)
from smarttestudo.language.parser.lexer import Token, TokenKind, tokenize
from smarttestudo.language.parser.values import parse_hertz, parse_topics
from smarttestudo.language.syntax import (
    COMMENT_START,
    NO_TRIVIA,
    Collection,
    Comment,
    KeepAtLeast,
    RuleFile,
    Statement,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ParseResult:
    """The statements of ``file`` that are whole, and an error for each that is not, in the order of the file.

    ``tokens`` end with the one that stands for the file's end; their comments are all comments of the file.
    ``steps`` is how often the parser looked at a token.
    """

    file: RuleFile
    findings: tuple[Finding, ...]
    tokens: tuple[Token, ...]
    steps: int

    @property
    def is_valid(self) -> bool:
        """Whether the file has no error of syntax."""
        return not self.findings


_ENDS = frozenset({TokenKind.END, TokenKind.BEGIN, TokenKind.END_OF_FILE})
_EXPECTED = frozenset({*STATEMENT_STARTS, TokenKind.END})
_EXPECTED_TEXT = "a statement ('SetFrequency', 'KeepAtLeast', 'KeepWithin', 'Rule' or 'If') or 'end'"


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
        case TokenKind.KEEP_WITHIN:
            return parse_within(cursor)
        case TokenKind.DISABLED | TokenKind.RULE | TokenKind.IF:
            return parse_block(cursor)
        case TokenKind.THEN | TokenKind.ELSE | TokenKind.END_IF:
            _refuse_part_of_block(cursor)
        case TokenKind.RECORD | TokenKind.SET_PARAMETER | TokenKind.CALL | TokenKind.NOTIFY:
            _refuse_action(cursor)
        case _:
            _refuse_unknown(cursor)
    return None


def _keep(cursor: Cursor) -> KeepAtLeast:
    first = cursor.advance()
    topic = parse_topics(cursor)
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


def _refuse_action(cursor: Cursor) -> None:
    message = f"'{cursor.token.text}' stands in a Then or Else only"
    what = "a recording" if cursor.kind is TokenKind.RECORD else "an action"
    cursor.report("stray-keyword", message, hint=f"{what} begins when a condition begins to hold")
    cursor.advance()
    cursor.skip_to(SAFE_PLACES)


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
        parse_actions(cursor, after_error=True)
    if cursor.accept(TokenKind.END_IF):
        cursor.is_block_open = False


MAX_FILE_BYTES = 4_000_000
_COLLECTION_STARTS = frozenset({*STATEMENT_STARTS, TokenKind.BEGIN, TokenKind.END_OF_FILE})
_START = Span(line=1, column=1, end_line=1, end_column=1)


def parse(text: str, path: str) -> ParseResult:
    """The rule file ``text``; ``path`` names it in findings. Raises nothing, whatever the text is."""
    log = FindingLog(path)
    if len(text.encode("utf-8", "surrogatepass")) > MAX_FILE_BYTES:
        log.report(
            "file-too-large", "a rule file holds at most 4 MB", span=_START, hint="split it into several"
        )
        return ParseResult(
            file=RuleFile(path=path, collections=()), findings=log.findings(), tokens=(), steps=0
        )
    tokens = tokenize(text)
    cursor = Cursor(tokens, log)
    collections = _collections(cursor)
    if "#" in text or "/*" in text:
        _report_foreign_comments(tokens, log)
    return ParseResult(
        file=RuleFile(
            path=path,
            collections=tuple(collections),
            footer=cursor.token.above,
            glued=tuple(token.span for token in tokens if token.is_glued),
        ),
        findings=log.findings(),
        tokens=tuple(tokens),
        steps=cursor.steps,
    )


def _collections(cursor: Cursor) -> list[Collection]:
    if cursor.kind is TokenKind.END_OF_FILE:
        cursor.report("empty-file", "expected 'begin', the file holds no rules", span=_START)
    collections: list[Collection] = []
    while cursor.kind is not TokenKind.END_OF_FILE:
        cursor.begin_statement()
        cursor.mend("expected-begin", "'begin'", (TokenKind.BEGIN,))
        if cursor.kind is TokenKind.BEGIN:
            collections.append(_collection(cursor))
        else:
            _report_outside(cursor, is_first=not collections)
            if cursor.kind in STATEMENT_STARTS:
                collections.append(_collection(cursor))
    return collections


def _report_outside(cursor: Cursor, *, is_first: bool) -> None:
    """Report what stands outside a collection; skip it unless it starts a statement."""
    expected = "'begin'" if is_first else "'begin' or the end of the file"
    if cursor.kind in STATEMENT_STARTS:
        hint = "statements stand between 'begin' and 'end'"
        cursor.report_found("expected-begin", expected, hint=hint)
        return
    cursor.report_found("expected-begin", expected)
    cursor.advance()
    cursor.skip_to(_COLLECTION_STARTS)


def _collection(cursor: Cursor) -> Collection:
    first = cursor.token
    has_begin = cursor.accept(TokenKind.BEGIN) is not None
    trivia = cursor.take_trivia(first) if has_begin else NO_TRIVIA
    statements = parse_statements(cursor)
    end_trivia = NO_TRIVIA
    if end := cursor.accept(TokenKind.END):
        end_trivia = cursor.take_trivia(end)
    elif has_begin and not cursor.is_cut_off:
        cursor.begin_statement()
        cut_off = cursor.kind is TokenKind.END_OF_FILE
        hint = "is the file cut off?" if cut_off else "a collection holds no other"
        cursor.report_missing("missing-end", "'end'", hint=hint)
    return Collection(
        statements=statements, span=cursor.span_from(first), trivia=trivia, end_trivia=end_trivia
    )


def _report_foreign_comments(tokens: Sequence[Token], log: FindingLog) -> None:
    for token in tokens:
        for comment in token.above:
            _refuse_foreign(comment, log)
        if token.beside is not None:
            _refuse_foreign(token.beside, log)


def _refuse_foreign(comment: Comment, log: FindingLog) -> None:
    if not comment.text.startswith(COMMENT_START):
        log.begin_statement()
        words = comment.text.removeprefix("/*").removesuffix("*/").strip("# ")
        fix = Fix(span=comment.span, replacement=f"// {words}", title="write '//'")
        log.report("foreign-comment", "a comment starts with '//'", span=comment.span, fix=fix)
