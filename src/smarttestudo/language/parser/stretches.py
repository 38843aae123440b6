# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Stretches of a text, which are read by themselves; one that the text had before is not read again."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import islice

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.source import Span
from smarttestudo.domain.utf_8 import without_mark
from smarttestudo.language.parser.lexer import lex
from smarttestudo.language.parser.tokens import Token
from smarttestudo.language.syntax import Statement

_END = re.compile(
    r"""(?: EndIf | begin ) [ \t]* (?: //[^\r\n]* )? (?: \r\n | \r | \n )
        (?= (?: \s | //[^\r\n]* [\r\n] )* [A-Za-z] )   # With a comparison behind, it is a property.
    """,
    re.VERBOSE,
)


_LINE_BREAK = re.compile(r"\r\n|\r|\n")

_ROOM = 10_000
_SHARES = 64
_LOOKED_THROUGH = 4096


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """The words from behind one line ``EndIf`` or ``begin`` to the next, or to the end of the file.

    ``line`` is the number of its first line, ``line_starts`` are where its lines start in it, and ``glued``
    are the words that follow a keyword without a blank between. ``may_hold_foreign_comment`` is whether a
    comment that does not start with ``//`` may be in it. ``statements`` are known where the stretch is whole
    statements without an error; ``steps`` is how often the parser looked at a token to know them.
    """

    text: str
    line: int
    line_starts: tuple[int, ...]
    tokens: tuple[Token, ...]
    glued: tuple[Span, ...]
    may_hold_foreign_comment: bool
    statements: tuple[Statement, ...] | None = None
    steps: int = 0

    @property
    def breaks(self) -> int:
        """How many line breaks it has."""
        return len(self.line_starts) - 1

    @property
    def next_line(self) -> int:
        """The first line behind it."""
        return self.line + self.breaks


def stretches_of(text: str, before: Sequence[Stretch] | None = None) -> list[Stretch]:
    """The stretches of ``text``; those that it had ``before``, in their order, are as they were.

    In a text that is read for the first time, lines have their numbers in it. In one that is read with what
    was ``before``, be it nothing, numbers grow from line to line and are left out between stretches, so that
    lines that come have numbers and those below keep theirs.
    """
    return list(_Reading(without_mark(text)[1], before).stretches())


class _Reading:
    """Reads a text from its start to its end; the stretches ``before`` from ``_at`` on may come again."""

    def __init__(self, text: str, before: Sequence[Stretch] | None) -> None:
        self._text = text
        self._has_room = before is not None
        self._before = before or ()
        self._at = 0
        self._start, self._line = 0, 1

    def stretches(self) -> Iterator[Stretch]:
        while True:
            yield from self._alike()
            end = _end_of_stretch(self._text, self._start)
            stretch = self._recalled(end) or self._read(end)
            yield stretch
            if end is None:
                return
            self._start, self._line = end, stretch.next_line

    def _alike(self) -> Sequence[Stretch]:
        """The stretches from here on that come again one after the other, but for the last.

        Whether a stretch ends depends on the first word of the next one.
        """
        first = end = self._at
        start = last_start = self._start
        if end < len(self._before) and self._is_here(end):
            for one in islice(self._before, end, len(self._before) - 1):
                if not self._text.startswith(one.text, start):
                    break
                last_start, start = start, start + len(one.text)
                end += 1
        alike = self._before[first : max(end - 1, first)]
        if alike:
            self._at, self._start, self._line = end - 1, last_start, alike[-1].next_line
        return alike

    def _is_here(self, number: int) -> bool:
        """Whether a stretch can come again here: the first is read as such, and numbers of lines grow."""
        return (number == 0) == (self._start == 0) and self._before[number].line >= self._line

    def _recalled(self, end: int | None) -> Stretch | None:
        """The stretch from here to ``end`` as it was before; the last is read again."""
        if end is None or self._is_in_its_place(end):
            return None
        part = self._text[self._start : end]
        for number in range(self._at, min(self._at + _LOOKED_THROUGH, len(self._before) - 1)):
            # Of several that read alike, one further on is it where the next follows, too.
            if (
                self._before[number].text == part
                and self._is_here(number)
                and (number == self._at or self._text.startswith(self._before[number + 1].text, end))
            ):
                self._at = number + 1
                return self._before[number]
        return None

    def _is_in_its_place(self, end: int | None) -> bool:
        """Whether what stands from here to ``end`` is other than before, and what follows is not."""
        if end is None or self._at + 1 >= len(self._before):
            return end is None
        here, behind = self._before[self._at : self._at + 2]
        return self._text.startswith(behind.text, end) and self._text[self._start : end] != here.text

    def _read(self, end: int | None) -> Stretch:
        text, line = self._text[self._start : end], self._free_line(end)
        tokens = tuple(lex(text, line, is_last=end is None))
        return Stretch(
            text=text,
            line=line,
            line_starts=(0, *(one.end() for one in _LINE_BREAK.finditer(text))),
            tokens=tokens,
            glued=tuple(token.span for token in tokens if token.is_glued),
            may_hold_foreign_comment="#" in text or "/*" in text,
        )

    def _free_line(self, end: int | None) -> int:
        """The number for the first line from here to ``end``: if it may be, that of what stood here before.

        Else it takes a little of the room above the next stretch that may come again. Where there is none,
        what is below is read again.
        """
        if end is None:
            self._at = max(len(self._before) - 1, 0)
        old = [one.line for one in self._before[self._at : self._at + 2]]
        if old and self._is_in_its_place(end):
            self._at += 1
            if self._start > 0 and old[0] >= self._line:
                return old[0]
            del old[0]
        if self._start == 0 or not self._has_room:
            return self._line
        room = old[0] - self._line if old else 0
        return self._line + (room // _SHARES if room > 0 else _ROOM)


def _end_of_stretch(text: str, start: int) -> int | None:
    """Where the stretch from ``start`` on ends, ``None`` for the last."""
    for end in _END.finditer(text, start):
        line_start = max(text.rfind("\n", start, end.start()) + 1, start)
        if not text[line_start : end.start()].strip(" \t"):
            return end.end()
    return None
