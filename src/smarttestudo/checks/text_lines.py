# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lines of the files that are checked."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from smarttestudo.domain.finding import Finding
from smarttestudo.domain.source import Span
from smarttestudo.language.parser.line_numbers import LineNumbers
from smarttestudo.language.recall import Recall

_T = TypeVar("_T")
_S = TypeVar("_S")

Place = tuple[str, Span]
"""The path of a file, and a place as its tree has it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TextLines:
    """The lines of files by their path; a file that is not among them has those of its tree."""

    by_path: Mapping[str, LineNumbers]

    def line(self, path: str, span: Span) -> int:
        """The line in its file at which ``span`` starts."""
        lines = self.by_path.get(path)
        return span.line if lines is None else lines.line(span.line)

    def told(self, finding: Finding) -> Finding:
        """``finding`` at its place in the text."""
        lines = self.by_path.get(finding.path)
        if lines is None:
            return finding
        return replace(
            finding,
            span=lines.span(finding.span),
            fix=lines.fix(finding.fix),
            related=tuple(map(lines.span, finding.related)),
        )

    def each(
        self,
        recall: Recall,
        name: str,
        make: Callable[[_S], _T],
        things: Sequence[_S],
        places_in: Callable[[_S], Iterable[Place]],
    ) -> Sequence[_T]:
        """Results of ``make`` for ``things``, each made anew where lines of the ``places_in`` it moved."""

        def lines_of(thing: Any, _: TextLines) -> int:
            lines = 0
            for place in places_in(thing):
                lines = lines << _LINE_BITS | self.line(*place)
            return lines

        lines = recall.each((name, "lines"), lines_of, things, [self] * len(things))
        return recall.each(name, lambda thing, _: make(thing), things, lines)


_LINE_BITS = 32


def text_lines(by_path: Mapping[str, LineNumbers], recall: Recall) -> TextLines:
    """The lines of files; the same object for texts whose lines are alike."""
    lines = TextLines(by_path=by_path)
    before = recall.before("text lines")
    return recall.keep("text lines", before if before == lines else lines)


def places_of(finding: Finding) -> Iterable[Place]:
    """All places of a finding."""
    fix = () if finding.fix is None else (finding.fix.span,)
    return ((finding.path, span) for span in (finding.span, *fix, *finding.related))
