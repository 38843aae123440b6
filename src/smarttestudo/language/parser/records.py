# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``Record "name" {TOPIC} Before DURATION After DURATION``."""

from __future__ import annotations

from smarttestudo.language.parser.cursor import Cursor
from smarttestudo.language.parser.durations import parse_duration
from smarttestudo.language.parser.headings import parse_name
from smarttestudo.language.parser.tokens import TokenKind
from smarttestudo.language.parser.values import parse_topic
from smarttestudo.language.syntax import Duration, RecordIncident, TopicName


def parse_record(cursor: Cursor) -> RecordIncident:
    """The whole statement; both durations are written, and they are not both 0."""
    first = cursor.advance()
    name = parse_name(
        cursor, "the recording's name in quotes", example='Record "near miss" Before 30 s After 10 s'
    )
    topics: list[TopicName] = []
    while cursor.kind is TokenKind.WORD and not cursor.mend(
        "expected-before", "'Before'", (TokenKind.BEFORE,)
    ):
        topics.append(parse_topic(cursor))
    before = _part(cursor, TokenKind.BEFORE)
    after = _part(cursor, TokenKind.AFTER)
    span = cursor.span_from(first)
    if not before.ns and not after.ns:
        cursor.report(
            "empty-window", "the window is empty", span=span, hint="a duration above 0 s records something"
        )
    return RecordIncident(
        name=name,
        topics=tuple(topics),
        before=before,
        after=after,
        span=span,
        trivia=cursor.take_trivia(first),
    )


def _part(cursor: Cursor, keyword: TokenKind) -> Duration:
    word = f"'{keyword.value}'"
    code = f"expected-{keyword.value.lower()}"
    cursor.mend(code, word, (keyword,))
    if cursor.accept(keyword) is None:
        hint = 'for instance Record "near miss" Before 30 s After 10 s'
        raise cursor.failure(code, word, hint=hint)
    return parse_duration(cursor)
