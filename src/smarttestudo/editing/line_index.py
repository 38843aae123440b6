# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lines and columns as offsets into a text."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import accumulate

from smarttestudo.domain.finding import Span
from smarttestudo.domain.texts import without_mark
from smarttestudo.language.parser.lexer import Token

_LINE = re.compile(r"[^\r\n]*(?:\r\n|\r|\n|\Z)")


class LineIndex:
    """Where the lines of ``text`` start; a byte order mark counts as an offset, but as no column."""

    def __init__(self, text: str) -> None:
        self._text = text
        lengths = (len(line) for line in _LINE.findall(text))
        self._starts = list(accumulate(lengths, initial=0))
        self._starts[0] = len(without_mark(text)[0])

    def offset(self, line: int, column: int) -> int:
        """The offset of a place that counts from 1; one beyond the text is its end."""
        start = self._starts[min(line, len(self._starts)) - 1]
        return min(start + column - 1, len(self._text))

    def offsets(self, tokens: Iterable[Token]) -> list[int]:
        """The offset of each of ``tokens`` of the text."""
        starts = self._starts
        return [starts[token.line - 1] + token.column - 1 for token in tokens]

    def range(self, span: Span) -> tuple[int, int]:
        """The offsets at which ``span`` starts and ends."""
        return self.offset(span.line, span.column), self.offset(span.end_line, span.end_column)

    def line_range(self, offset: int) -> tuple[int, int]:
        """The start of the line that holds ``offset``, and its end before the line break."""
        start = max(self._text.rfind("\n", 0, offset), self._text.rfind("\r", 0, offset)) + 1
        ends = [end for end in (self._text.find("\n", offset), self._text.find("\r", offset)) if end >= 0]
        return start, min(ends, default=len(self._text))

    def after_break(self, line_end: int) -> int:
        """The offset behind the line break at ``line_end``."""
        if self._text.startswith("\r\n", line_end):
            return line_end + 2
        return min(line_end + 1, len(self._text))
