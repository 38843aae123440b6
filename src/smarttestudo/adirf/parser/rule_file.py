# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rule files to syntax trees: recursive descent with one token of lookahead.

Every error of a file is reported at once. After one, parsing goes on at the next keyword that starts or ends
a statement; a misspelt keyword counts as what it should be. Time and depth are bounded for any text.
"""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.adirf.comments import COMMENT_START, NO_TRIVIA, Comment
from smarttestudo.adirf.parser.cursor import STATEMENT_STARTS, Cursor
from smarttestudo.adirf.parser.finding_log import FindingLog
from smarttestudo.adirf.parser.lexer import tokenize
from smarttestudo.adirf.parser.result import ParseResult
from smarttestudo.adirf.parser.statements import parse_statements
from smarttestudo.adirf.parser.tokens import Token, TokenKind
from smarttestudo.adirf.syntax import Collection, RuleFile
from smarttestudo.domain.finding import Fix
from smarttestudo.domain.source import Span

MAX_FILE_BYTES = 1_000_000
_COLLECTION_STARTS = frozenset({*STATEMENT_STARTS, TokenKind.BEGIN, TokenKind.END_OF_FILE})
_START = Span(line=1, column=1, end_line=1, end_column=1)


def parse(text: str, path: str) -> ParseResult:
    """The rule file ``text``; ``path`` names it in findings. Raises nothing, whatever the text is."""
    log = FindingLog(path)
    if len(text.encode("utf-8", "surrogatepass")) > MAX_FILE_BYTES:
        log.report(
            "file-too-large", "a rule file holds at most 1 MB", span=_START, hint="split it into several"
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
        file=RuleFile(path=path, collections=tuple(collections), footer=cursor.token.above),
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
    has_begin = cursor.take(TokenKind.BEGIN) is not None
    trivia = cursor.take_trivia(first) if has_begin else NO_TRIVIA
    statements = parse_statements(cursor)
    end_trivia = NO_TRIVIA
    if end := cursor.take(TokenKind.END):
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
