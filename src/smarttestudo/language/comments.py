# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Comments and blank lines: what a rule file holds beside its meaning."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from smarttestudo.domain.finding import Span

COMMENT_START = "//"
_DECORATION = "/-=*#_~ \t"


@dataclass(frozen=True, slots=True, kw_only=True)
class Comment:
    """One comment; ``text`` starts with ``//`` and ends before the blanks at the line's end.

    ``own_line`` is whether nothing stands before it on its line, ``blank_above`` whether the file has an
    empty line between it and what is above.
    """

    text: str
    span: Span
    own_line: bool
    blank_above: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Trivia:
    """The comments of a statement, condition or keyword, and whether an empty line stands before it.

    ``above`` stands on lines of its own before it, ``beside`` at the end of its last line; ``blank_above``
    is an empty line between ``above`` and it.
    """

    above: tuple[Comment, ...] = ()
    beside: Comment | None = None
    blank_above: bool = False


NO_TRIVIA = Trivia()


def label_in(comments: Sequence[Comment]) -> str | None:
    """The words of the last comment that has any; a ruler such as ``// -----`` has none."""
    for comment in reversed(comments):
        words = comment.text.strip(_DECORATION)
        if words:
            return words
    return None
