# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Text that is no whole statement, cut where a new statement starts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smarttestudo.adirf.document.places import Places
from smarttestudo.adirf.parser import ParseResult
from smarttestudo.adirf.parser.tokens import Token, TokenKind

_ABOUT_NEIGHBOURS = frozenset(
    {"missing-end", "missing-end-if", "expected-begin", "foreign-comment", "too-many-errors"}
)
"""Errors that leave the statement whole at whose end they are reported."""


def broken_places(result: ParseResult, places: Places) -> list[int]:
    """The offsets of errors of syntax, rising; a statement around one may lack words: it must stay text."""
    return sorted(
        places.range(finding.span)[0] for finding in result.findings if finding.code not in _ABOUT_NEIGHBOURS
    )


def split_unparsed(tokens: Sequence[Token]) -> Iterator[tuple[int, int]]:
    """From which token to before which: one range for each statement that was begun."""
    first, is_block, awaits_if = 0, False, False
    for at, token in enumerate(tokens):
        kind = token.kind
        is_new = (
            kind in (TokenKind.RULE, TokenKind.KEEP_AT_LEAST)
            or (kind is TokenKind.IF and not awaits_if)
            or (kind is TokenKind.SET_FREQUENCY and not is_block)
            or (at > 0 and tokens[at - 1].kind is TokenKind.END_IF)
        )
        if is_new and at > first:
            yield first, at
            first = at
        if is_new:
            is_block, awaits_if = False, kind is TokenKind.RULE
        if kind in (TokenKind.RULE, TokenKind.IF, TokenKind.THEN):
            is_block = True
        if kind is TokenKind.IF:
            awaits_if = False
    if tokens:
        yield first, len(tokens)
