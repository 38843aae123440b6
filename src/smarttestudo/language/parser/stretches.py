# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Stretches of a text, which are read by themselves; one that stands where it stood is not read again."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from smarttestudo.domain.source import Span
from smarttestudo.language.parser.lexer import BYTE_ORDER_MARK, lex
from smarttestudo.language.parser.tokens import Token
from smarttestudo.language.syntax import Statement

_END = re.compile(
    r"""EndIf [ \t]* (?: //[^\r\n]* )? (?: \r\n | \r | \n )
        (?= (?: \s | //[^\r\n]* [\r\n] )* [A-Za-z] )   # With a comparison behind it, EndIf is a property.
    """,
    re.VERBOSE,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """The words from behind one line ``EndIf`` to the next, or to the end of the file.

    ``line`` is its first, ``glued`` are the words that follow a keyword without a blank between.
    ``statements`` are known where the stretch is whole statements without an error; ``steps`` is how often
    the parser looked at a token to know them.
    """

    text: str
    line: int
    tokens: tuple[Token, ...]
    glued: tuple[Span, ...]
    statements: tuple[Statement, ...] | None = None
    steps: int = 0

    @property
    def may_hold_foreign_comment(self) -> bool:
        """Whether a comment that does not start with ``//`` may be in it."""
        return "#" in self.text or "/*" in self.text


def stretches_of(text: str, before: Iterable[Stretch]) -> Iterator[Stretch]:
    """The stretches of ``text``; what stands where it stood ``before`` is as it was."""
    known: Mapping[tuple[int, str], Stretch] = {(one.line, one.text): one for one in before}
    text = text.removeprefix(BYTE_ORDER_MARK)
    start, line = 0, 1
    for end in _END.finditer(text):
        line_start = max(text.rfind("\n", start, end.start()) + 1, start)
        if not text[line_start : end.start()].strip(" \t"):
            part = text[start : end.end()]
            stretch = known.get((line, part)) or _read(part, line, is_last=False)
            yield stretch
            start, line = end.end(), stretch.tokens[-1].line + 1
    yield _read(text[start:], line, is_last=True)


def _read(text: str, line: int, *, is_last: bool) -> Stretch:
    tokens = tuple(lex(text, line, is_last=is_last))
    return Stretch(
        text=text, line=line, tokens=tokens, glued=tuple(token.span for token in tokens if token.is_glued)
    )
