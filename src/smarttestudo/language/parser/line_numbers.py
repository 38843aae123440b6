# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lines of a text, and the numbers by which its trees know them."""

from __future__ import annotations

import sys
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import fields, is_dataclass, replace
from itertools import accumulate
from typing import Any, TypeVar

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.finding import Fix
from smarttestudo.domain.source import Span
from smarttestudo.language.parser.stretches import Stretch
from smarttestudo.language.parser.tokens import Token
from smarttestudo.language.syntax import Block, unnamed_label

_T = TypeVar("_T")


@dataclass(frozen=True, slots=True, kw_only=True)
class LineNumbers:
    """The ``numbers`` of the first lines of stretches, and which ``lines`` of the text these are.

    A tree that stays while the text above it changes keeps its numbers. Both grow from stretch to stretch.
    """

    numbers: Sequence[int]
    lines: Sequence[int]

    @staticmethod
    def of(stretches: Sequence[Stretch]) -> LineNumbers:
        """The lines of a text that was read in ``stretches``."""
        *lines, _ = accumulate((one.breaks for one in stretches), initial=1)
        return LineNumbers(numbers=[one.line for one in stretches], lines=lines)

    def line(self, number: int) -> int:
        """The line that has ``number``; one more than the last of a stretch is the first of the next."""
        at = bisect_right(self.numbers, number) - 1
        return number - self.numbers[at] + self.lines[at]

    def lines_of(self, numbers: Sequence[int]) -> Sequence[int]:
        """The lines that have ``numbers``, which grow."""
        lines: list[int] = []
        starts = zip([*self.numbers[1:], sys.maxsize], self.numbers, self.lines, strict=True)
        behind, first, line = next(starts)
        for number in numbers:
            while number >= behind:
                behind, first, line = next(starts)
            lines.append(number - first + line)
        return lines

    def number(self, line: int) -> int:
        """The number of ``line``."""
        at = bisect_right(self.lines, line) - 1
        return line - self.lines[at] + self.numbers[at]

    def span(self, span: Span) -> Span:
        """The place of a tree's ``span`` in the text."""
        return Span(self.line(span.line), span.column, self.line(span.end_line), span.end_column)

    def numbered(self, span: Span) -> Span:
        """The place ``span`` of the text as its trees know it."""
        return Span(self.number(span.line), span.column, self.number(span.end_line), span.end_column)

    def fix(self, fix: Fix | None) -> Fix | None:
        """A tree's fix at its place in the text."""
        return None if fix is None else replace(fix, span=self.span(fix.span))

    def numbered_fix(self, fix: Fix | None) -> Fix | None:
        """A fix of the text as its trees know it."""
        return None if fix is None else replace(fix, span=self.numbered(fix.span))

    def label(self, block: Block) -> str:
        """The label of a block of a tree."""
        return unnamed_label(self.line(block.span.line)) if block.is_unnamed else block.label

    def told(self, node: _T) -> _T:
        """A tree or words with the lines of the text in the place of their numbers."""
        return node if self.numbers == self.lines else self._told(node)

    def _told(self, node: Any) -> Any:
        if isinstance(node, Span):
            return self.span(node)
        if isinstance(node, Token):
            above, beside = self._told(node.above), self._told(node.beside)
            return node._replace(line=self.line(node.line), above=above, beside=beside)
        if isinstance(node, tuple):
            return tuple(map(self._told, node))
        if not is_dataclass(node) or isinstance(node, type):
            return node
        parts = {one.name: self._told(getattr(node, one.name)) for one in fields(node)}
        if isinstance(node, Block):
            parts["label"] = self.label(node)
        return type(node)(**parts)
