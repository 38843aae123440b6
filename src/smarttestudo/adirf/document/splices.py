# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Changes of a text at places, and where lines of it come and go."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from smarttestudo.adirf.comments import COMMENT_START, Comment
from smarttestudo.adirf.document.places import Places
from smarttestudo.adirf.document.stretch import Stretch
from smarttestudo.adirf.parser.tokens import TokenKind

_BREAK = re.compile(r"\r\n|\r|\n")


@dataclass(frozen=True, slots=True, order=True)
class Splice:
    """``replacement`` in the place of the text from ``start`` to ``end``."""

    start: int
    end: int
    replacement: str


def apply(text: str, splices: Iterable[Splice]) -> str:
    """``text`` with all ``splices``, which do not overlap; those at one place keep their order."""
    ordered = sorted(splices, key=lambda one: (one.start, one.end))
    for splice in reversed(ordered):
        text = text[: splice.start] + splice.replacement + text[splice.end :]
    return text


def comment_lines(comments: Iterable[str]) -> list[str]:
    """``comments`` as lines of a rule file; one that has line breaks becomes several."""
    return [f"{COMMENT_START} {line}".rstrip() for comment in comments for line in _BREAK.split(comment)]


def comment_texts(comments: Iterable[Comment]) -> list[str]:
    """What ``comments`` say, without their slashes."""
    return [comment.text.lstrip("/").removeprefix(" ") for comment in comments]


def removal(stretch: Stretch, following: Stretch | None) -> Splice:
    """Takes ``stretch`` out with its own comments, and the lines that were its own.

    ``following`` are the words behind it. The empty lines above go too where others would stay below.
    """
    start, end, text, places = stretch.own_start, stretch.own_end, stretch.text, stretch.places
    if stretch.indent is None:
        start -= len(stretch.before) - len(stretch.before.rstrip())
        return Splice(start, end, " " if stretch.after.strip() else "")
    if stretch.after.strip():
        return Splice(start, end + len(stretch.after) - len(stretch.after.lstrip()), "")
    line_end = places.line_range(end)[1]
    after = places.after_break(line_end)
    start -= len(stretch.indent or "")
    if after == line_end:
        return Splice(_before_break(text, start), after, "")
    if _is_followed_by_gap(text, places, after, following):
        start = _above_blanks(places, text, start)
    return Splice(start, after, "")


def _is_followed_by_gap(text: str, places: Places, at: int, following: Stretch | None) -> bool:
    is_blank = at < len(text) and not text[at : places.line_range(at)[1]].strip()
    is_last = following is None or following.tokens[0].kind is TokenKind.END
    return is_blank or (is_last and (following is None or not following.tokens[0].above))


def _above_blanks(places: Places, text: str, start: int) -> int:
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


def addition(point: Stretch, lines: str, line_end: str) -> Splice:
    """Puts ``lines``, indented and without a break at their end, on lines of their own behind ``point``."""
    at = point.own_end
    if not point.after.strip():
        at = point.places.line_range(at)[1]
        return Splice(at, at, line_end + lines)
    blanks = len(point.after) - len(point.after.lstrip())
    indent = lines[: len(lines) - len(lines.lstrip())]
    return Splice(at, at + blanks, f"{line_end}{lines}{line_end}{indent}")
