# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lines and columns as offsets into a text."""

from __future__ import annotations

import sys
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from itertools import accumulate

from smarttestudo.domain.source import Span
from smarttestudo.domain.utf_8 import without_mark
from smarttestudo.language.parser.stretches import Stretch


class LineIndex:
    """Where the lines of ``text`` start, by the numbers that they have in the ``stretches`` of the parser.

    A byte order mark counts as an offset, but as no column.
    """

    def __init__(self, text: str, stretches: Sequence[Stretch]) -> None:
        self.text = text
        self._stretches = stretches
        self._lines = [stretch.line for stretch in stretches]
        start = len(without_mark(text)[0])
        self._starts = list(accumulate((len(stretch.text) for stretch in stretches), initial=start))

    def offset(self, line: int, column: int) -> int:
        """The offset of a place that counts from 1; one beyond the text is its end."""
        at = bisect_right(self._lines, line) - 1
        starts = self._stretches[at].line_starts if at >= 0 else (0,)
        within = line - (self._lines[at] if at >= 0 else 1)
        if within >= len(starts):
            return len(self.text)
        return min(self._starts[max(at, 0)] + starts[within] + column - 1, len(self.text))

    def offsets(self, places: Iterable[tuple[int, int]]) -> list[int]:
        """The offset of each of ``places``, lines and columns of words, which grow."""
        offsets: list[int] = []
        stretches = zip(
            [*self._lines[1:], sys.maxsize], self._lines, self._stretches, self._starts, strict=False
        )
        behind, first, stretch, start = next(stretches)
        for line, column in places:
            while line >= behind:
                behind, first, stretch, start = next(stretches)
            offsets.append(start + stretch.line_starts[line - first] + column - 1)
        return offsets

    def range(self, span: Span) -> tuple[int, int]:
        """The offsets at which ``span`` starts and ends."""
        return self.offset(span.line, span.column), self.offset(span.end_line, span.end_column)

    def text_of(self, span: Span) -> str:
        """The text that ``span`` covers."""
        start, end = self.range(span)
        return self.text[start:end]

    def line_range(self, offset: int) -> tuple[int, int]:
        """The start of the line that holds ``offset``, and its end before the line break."""
        start = max(self.text.rfind("\n", 0, offset), self.text.rfind("\r", 0, offset)) + 1
        ends = [end for end in (self.text.find("\n", offset), self.text.find("\r", offset)) if end >= 0]
        return start, min(ends, default=len(self.text))

    def after_break(self, line_end: int) -> int:
        """The offset behind the line break at ``line_end``."""
        if self.text.startswith("\r\n", line_end):
            return line_end + 2
        return min(line_end + 1, len(self.text))
