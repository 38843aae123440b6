# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Stretches of a text, which are read by themselves; one that stands where it stood is not read again."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from operator import attrgetter

from smarttestudo.domain.source import Span
from smarttestudo.domain.utf_8 import without_mark
from smarttestudo.language.parser.lexer import lex
from smarttestudo.language.parser.tokens import Token
from smarttestudo.language.syntax import Statement

_END = re.compile(
    r"""EndIf [ \t]* (?: //[^\r\n]* )? (?: \r\n | \r | \n )
        (?= (?: \s | //[^\r\n]* [\r\n] )* [A-Za-z] )   # With a comparison behind it, EndIf is a property.
    """,
    re.VERBOSE,
)


_LINE_BREAK = re.compile(r"\r\n|\r|\n")


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """The words from behind one line ``EndIf`` to the next, or to the end of the file.

    ``line`` is its first, ``line_starts`` are where its lines start in it, and ``glued`` are the words that
    follow a keyword without a blank between. ``may_hold_foreign_comment`` is whether a comment that does not
    start with ``//`` may be in it. ``statements`` are known where the stretch is whole statements without an
    error; ``steps`` is how often the parser looked at a token to know them.
    """

    text: str
    line: int
    line_starts: tuple[int, ...]
    tokens: tuple[Token, ...]
    glued: tuple[Span, ...]
    may_hold_foreign_comment: bool
    statements: tuple[Statement, ...] | None = None
    steps: int = 0


def stretches_of(text: str, before: Sequence[Stretch]) -> Iterator[Stretch]:
    """The stretches of ``text``; what stands where it stood ``before`` is as it was, but for the last."""
    _, text = without_mark(text)
    before = before[:-1]
    start, line = 0, 1
    is_at_end = False
    while not is_at_end:
        at = bisect_left(before, line, key=attrgetter("line"))
        known = before[at:] if at < len(before) and before[at].line == line else ()
        alike = _alike(text, start, known)
        end = None if alike else _end_of_stretch(text, start)
        is_at_end = end is None and not alike
        if not alike:
            part = text[start:end]
            is_known = not is_at_end and known and known[0].text == part
            alike = known[:1] if is_known else (_read(part, line, is_last=is_at_end),)
        yield from alike
        start += sum(len(one.text) for one in alike)
        line = alike[-1].tokens[-1].line + 1


def _alike(text: str, start: int, before: Sequence[Stretch]) -> Sequence[Stretch]:
    """The first ones of ``before`` that ``text`` has from ``start`` on.

    Whether a stretch ends depends on the first word of the next one, so that the last that is alike is not
    among them.
    """
    count = 0
    for stretch in before:
        if not text.startswith(stretch.text, start):
            break
        start += len(stretch.text)
        count += 1
    return before[: max(count - 1, 0)]


def _end_of_stretch(text: str, start: int) -> int | None:
    """Where the stretch from ``start`` on ends, ``None`` for the last."""
    for end in _END.finditer(text, start):
        line_start = max(text.rfind("\n", start, end.start()) + 1, start)
        if not text[line_start : end.start()].strip(" \t"):
            return end.end()
    return None


def _read(text: str, line: int, *, is_last: bool) -> Stretch:
    tokens = tuple(lex(text, line, is_last=is_last))
    return Stretch(
        text=text,
        line=line,
        line_starts=(0, *(end.end() for end in _LINE_BREAK.finditer(text))),
        tokens=tokens,
        glued=tuple(token.span for token in tokens if token.is_glued),
        may_hold_foreign_comment="#" in text or "/*" in text,
    )
