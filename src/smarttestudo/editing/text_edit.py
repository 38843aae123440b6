# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Changes of a text at places, and where lines of it come and go."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from smarttestudo.editing.line_index import LineIndex
from smarttestudo.editing.token_range import TokenRange
from smarttestudo.language.parser.lexer import TokenKind
from smarttestudo.language.syntax import COMMENT_START, Comment

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
    ordered = sorted(text_edits, key=lambda one: (one.start, one.end))
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
