# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Words and lines as the formatter writes them."""

from __future__ import annotations

from collections.abc import Iterable

from smarttestudo.domain.rate import Tier
from smarttestudo.language.comments import Comment, Trivia
from smarttestudo.language.syntax import Duration, KeepWithin, RateExpression, RateWord

INDENT = 4
BEFORE_COMMENT = "  "


class LineWriter:
    """Collects lines; two blank lines never follow each other, and none opens or ends an indented part."""

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._can_be_blank = False

    def line(self, level: int, text: str, beside: Comment | None = None) -> None:
        """Add ``text`` at indentation ``level``, with the comment beside it."""
        comment = f"{BEFORE_COMMENT}{beside.text}" if beside is not None else ""
        self._lines.append(f"{' ' * (INDENT * level)}{text}{comment}")
        self._can_be_blank = True

    def opening_line(self, level: int, text: str, beside: Comment | None = None) -> None:
        """Add a line after which an indented part begins."""
        self.line(level, text, beside)
        self._can_be_blank = False

    def blank(self) -> None:
        """Add a blank line where one may be."""
        if self._can_be_blank:
            self._lines.append("")
        self._can_be_blank = False

    def comments(self, level: int, comments: Iterable[Comment]) -> None:
        """Add comments on lines of their own, with the blank lines above them."""
        for comment in comments:
            if comment.blank_above:
                self.blank()
            self.line(level, comment.text)

    def above(self, level: int, trivia: Trivia) -> None:
        """Add what stands above a statement."""
        self.comments(level, trivia.above)
        if trivia.blank_above:
            self.blank()

    def text(self) -> str:
        """All lines, the last one ended like the others."""
        return "".join(f"{line}\n" for line in self._lines)


def number_text(value: float) -> str:
    """The shortest spelling that reads back as ``value``, a whole number without its ``.0``."""
    return repr(float(value)).removesuffix(".0")


def within_text(statement: KeepWithin) -> str:
    """The statement on one line, without its comments."""
    return f"KeepWithin {statement.topic.text} {statement.property} {bound_text(statement)}"


def bound_text(statement: KeepWithin) -> str:
    """The bound as written, or as one would write it where the tree holds no spelling."""
    bound = statement.bound
    return bound.value if isinstance(bound, Tier) else statement.text or number_text(bound)


def duration_text(duration: Duration) -> str:
    """The duration as written."""
    return f"{duration.text} {duration.unit.value}"


def rate_text(rate: RateExpression) -> str:
    """The rate as written, or as one would write it where the tree holds no spelling."""
    if isinstance(rate.value, Tier | RateWord):
        name: str = rate.value.value
        return name
    unit = " Hz" if rate.has_unit else ""
    return f"{rate.text or number_text(rate.value)}{unit}"
