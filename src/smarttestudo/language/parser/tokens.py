# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The words of a rule file."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from smarttestudo.domain.finding import Span
from smarttestudo.language.comments import Comment


class TokenKind(Enum):
    """The kind of a token; a keyword's value is its spelling.

    ``Hz``, ``Full``, ``Off``, the tiers and units of time are words: they mean something in one place only.
    ``FOREIGN`` is whatever the language does not have, such as ``==``, ``1,5`` or a quote without its end.
    """

    BEGIN = "begin"
    END = "end"
    SET_FREQUENCY = "SetFrequency"
    KEEP_AT_LEAST = "KeepAtLeast"
    KEEP_WITHIN = "KeepWithin"
    RECORD = "Record"
    BEFORE = "Before"
    AFTER = "After"
    DISABLED = "Disabled"
    RULE = "Rule"
    PRIORITY = "Priority"
    IF = "If"
    THEN = "Then"
    ELSE = "Else"
    END_IF = "EndIf"
    NOT = "Not"
    AND = "AND"
    OR = "OR"
    CHECK_VALUE = "CheckValue"
    FOR = "For"
    WITHIN = "Within"
    UNTIL = "Until"
    OPEN = "("
    CLOSE = ")"
    WORD = "word"
    NUMBER = "number"
    STRING = "string"
    OPERATOR = "operator"
    FOREIGN = "foreign"
    END_OF_FILE = "end of file"

    __hash__ = object.__hash__  # Sets of kinds are asked once a word; the hash of an enum is a slow call.


_NO_KEYWORDS = frozenset(
    {
        TokenKind.OPEN,
        TokenKind.CLOSE,
        TokenKind.WORD,
        TokenKind.NUMBER,
        TokenKind.STRING,
        TokenKind.OPERATOR,
        TokenKind.FOREIGN,
        TokenKind.END_OF_FILE,
    }
)
KEYWORDS = {kind.value: kind for kind in TokenKind if kind not in _NO_KEYWORDS}
CONNECTIVES = frozenset({TokenKind.AND, TokenKind.OR})


class Token(NamedTuple):
    """A word of the file and where it starts; no token goes over the end of its line.

    ``starts_line`` is whether it is the first of its line, ``blank_above`` whether an empty line is directly
    above it. ``above`` are the comments on lines of their own since the token before, ``beside`` is the one
    on the rest of its line. ``is_glued`` is whether the keyword before it is written without a blank behind.
    """

    kind: TokenKind
    text: str
    line: int
    column: int
    starts_line: bool = False
    blank_above: bool = False
    above: tuple[Comment, ...] = ()
    beside: Comment | None = None
    is_glued: bool = False

    @property
    def span(self) -> Span:
        """The stretch that the token covers."""
        return Span(self.line, self.column, self.line, self.column + len(self.text))

    @property
    def start(self) -> Span:
        """The empty stretch just before the token."""
        return Span(self.line, self.column, self.line, self.column)

    @property
    def end(self) -> Span:
        """The empty stretch just after the token."""
        column = self.column + len(self.text)
        return Span(self.line, column, self.line, column)
