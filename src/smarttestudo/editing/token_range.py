# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Successive words of a text with their offsets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from smarttestudo.editing.line_index import LineIndex
from smarttestudo.language.parser.lexer import Token
from smarttestudo.language.syntax import Comment


@dataclass(frozen=True, slots=True, kw_only=True)
class TokenRange:
    """The words of something; ``offsets`` are where they start in ``text``."""

    tokens: Sequence[Token]
    offsets: Sequence[int]
    text: str
    places: LineIndex

    @staticmethod
    def of(tokens: Sequence[Token], text: str, places: LineIndex) -> TokenRange:
        """The words ``tokens`` of ``text``."""
        return TokenRange(tokens=tokens, offsets=places.offsets(tokens), text=text, places=places)

    def __len__(self) -> int:
        return len(self.tokens)

    def __getitem__(self, at: int | slice) -> TokenRange:
        part = at if isinstance(at, slice) else slice(at, at + 1)
        return TokenRange(
            tokens=self.tokens[part], offsets=self.offsets[part], text=self.text, places=self.places
        )

    @property
    def start(self) -> int:
        """Where the first word starts."""
        return self.offsets[0]

    @property
    def end(self) -> int:
        """Where the last word ends."""
        return self.offsets[-1] + len(self.tokens[-1].text)

    @property
    def comments(self) -> tuple[Comment, ...]:
        """The comments directly above the first word, no empty line between."""
        first = self.tokens[0]
        own: list[Comment] = []
        has_blank = first.blank_above
        for comment in reversed(first.above):
            if has_blank:
                break
            own.append(comment)
            has_blank = comment.blank_above
        return tuple(reversed(own))

    @property
    def own_start(self) -> int:
        """Where the comments directly above start, else the first word."""
        comments = self.comments
        return self.places.range(comments[0].span)[0] if comments else self.start

    @property
    def own_end(self) -> int:
        """Where the comment beside the last word ends, else the last word."""
        beside = self.tokens[-1].beside
        return self.places.range(beside.span)[1] if beside else self.end

    @property
    def before(self) -> str:
        """The text on the line before it."""
        return self.text[self.places.line_range(self.own_start)[0] : self.own_start]

    @property
    def after(self) -> str:
        """The text on the line behind it."""
        return self.text[self.own_end : self.places.line_range(self.own_end)[1]]

    @property
    def indent(self) -> str | None:
        """The blanks before it, ``None`` where it does not start its line."""
        return None if self.before.strip() else self.before.lstrip("\ufeff")

    def index_at(self, offset: int) -> int:
        """The number of the word that starts at ``offset``."""
        return self.offsets.index(offset)

    def between(self, start: int, end: int) -> TokenRange:
        """The words from ``start`` to ``end``."""
        first = self.index_at(start)
        last = first
        while last + 1 < len(self) and self.offsets[last + 1] < end:
            last += 1
        return self[first : last + 1]
