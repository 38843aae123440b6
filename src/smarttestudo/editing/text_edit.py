# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A text as lines and words, and edits of it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate

from smarttestudo.domain.finding import Span
from smarttestudo.domain.texts import without_mark
from smarttestudo.language.parser.lexer import Token, TokenKind
from smarttestudo.language.syntax import COMMENT_START, Comment

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


_OF_NAME = re.compile(r"[\w~.\[\]/-]")
_BREAK = re.compile(r"\r\n|\r|\n")


@dataclass(frozen=True, slots=True, order=True)
class TextEdit:
    """``replacement`` in the place of the text from ``start`` to ``end``."""

    start: int
    end: int
    replacement: str


def apply(text: str, text_edits: Iterable[TextEdit]) -> str:
    """``text`` with all ``text_edits``, which do not overlap; those at one place keep their order.

    A keyword in ``text`` may have no blank behind it: what comes there does not make one word with it.
    """
    ordered = sorted(text_edits, key=lambda edit: (edit.start, edit.end))
    for text_edit in reversed(ordered):
        before, after = text[: text_edit.start], text[text_edit.end :]
        left, right = _blank(before, text_edit.replacement), _blank(text_edit.replacement, after)
        text = f"{before}{left}{text_edit.replacement}{right}{after}"
    return text


def _blank(first: str, second: str) -> str:
    """A blank where the last word of ``first`` would go on in ``second``."""
    is_one_word = _OF_NAME.match(first[-1:]) and _OF_NAME.match(second[:1])
    return " " if is_one_word and not second.startswith("/") else ""


def comment_lines(comments: Iterable[str]) -> list[str]:
    """``comments`` as lines of a rule file; one that has line breaks becomes several."""
    return [f"{COMMENT_START} {line}".rstrip() for comment in comments for line in _BREAK.split(comment)]


def comment_texts(comments: Iterable[Comment]) -> list[str]:
    """The words of ``comments``, without their slashes."""
    return [comment.text.lstrip("/").removeprefix(" ") for comment in comments]


def removal(token_range: TokenRange, following: TokenRange | None) -> TextEdit:
    """Takes ``token_range`` out with its own comments, and the lines that were its own.

    ``following`` are the words behind it. The empty lines above go too where others would stay below.
    """
    start, end, text, places = (
        token_range.own_start,
        token_range.own_end,
        token_range.text,
        token_range.places,
    )
    if token_range.indent is None:
        start -= len(token_range.before) - len(token_range.before.rstrip())
        return TextEdit(start, end, " " if token_range.after.strip() else "")
    if token_range.after.strip():
        return TextEdit(start, end + len(token_range.after) - len(token_range.after.lstrip()), "")
    line_end = places.line_range(end)[1]
    after = places.after_break(line_end)
    start -= len(token_range.indent or "")
    if after == line_end:
        return TextEdit(_before_break(text, start), after, "")
    if _is_followed_by_gap(text, places, after, following):
        start = _above_blanks(places, text, start)
    return TextEdit(start, after, "")


def _is_followed_by_gap(text: str, places: LineIndex, at: int, following: TokenRange | None) -> bool:
    is_blank = at < len(text) and not text[at : places.line_range(at)[1]].strip()
    is_last = following is None or following.tokens[0].kind is TokenKind.END
    return is_blank or (is_last and (following is None or not following.tokens[0].above))


def _above_blanks(places: LineIndex, text: str, start: int) -> int:
    while start > 0:
        above = places.line_range(_before_break(text, start))[0]
        if text[above:start].strip("\ufeff").strip() or above == start:
            break
        if text.startswith("\ufeff", above):
            break
        start = above
    return start


def _before_break(text: str, at: int) -> int:
    if text[:at].endswith("\r\n"):
        return at - 2
    return at - 1 if at > 0 and text[at - 1] in "\r\n" else at


def addition(point: TokenRange, lines: str, line_end: str) -> TextEdit:
    """Puts ``lines``, indented and without a break at their end, on lines of their own behind ``point``."""
    at = point.own_end
    if not point.after.strip():
        at = point.places.line_range(at)[1]
        return TextEdit(at, at, line_end + lines)
    blanks = len(point.after) - len(point.after.lstrip())
    indent = lines[: len(lines) - len(lines.lstrip())]
    return TextEdit(at, at + blanks, f"{line_end}{lines}{line_end}{indent}")


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
