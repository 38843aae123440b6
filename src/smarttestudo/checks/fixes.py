# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Fixes that several lint rules offer."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import NamedTuple

from smarttestudo.domain.finding import Fix, Span
from smarttestudo.language.syntax import Block, Collection, RuleFile, TopicName


def close_topic(topic: str, known: Iterable[str]) -> str | None:
    """The known topic that is spelt almost like ``topic``; ``None`` where there is none."""
    return next(iter(difflib.get_close_matches(topic, known, n=1, cutoff=0.75)), None)


def write_topic(name: TopicName, topic: str | None) -> Fix | None:
    """A fix that writes ``topic`` in the place of ``name``."""
    return None if topic is None else Fix(span=name.span, replacement=topic, title=f"write {topic}")


class DefaultPlace(NamedTuple):
    """Where a new default belongs: behind statement ``last`` of ``part``, or before its rules."""

    part: Collection
    last: int | None


def default_place(file: RuleFile) -> DefaultPlace | None:
    """The place in the last ``begin … end`` with a default, else in the first one with a rule.

    ``None`` for a file without any statement.
    """
    places = [DefaultPlace(part, _last_default(part)) for part in file.collections if part.statements]
    with_default = (place for place in reversed(places) if place.last is not None)
    return next(with_default, next(iter(places), None))


def new_default(place: DefaultPlace | None, topic: str) -> Fix | None:
    """Write ``SetFrequency topic Full`` at ``place``, if there is one."""
    if place is None:
        return None
    default = f"SetFrequency {topic} Full"
    span, replacement = _insertion(place, default)
    return Fix(span=span, replacement=replacement, title=f"add {default}")


def _last_default(part: Collection) -> int | None:
    """The number of the last statement that is no rule."""
    return max((at for at, one in enumerate(part.statements) if not isinstance(one, Block)), default=None)


def _insertion(place: DefaultPlace, default: str) -> tuple[Span, str]:
    """Where to write and what: a line of its own wherever the text has lines for its statements."""
    part, last = place
    if last is None:
        first = part.statements[0].span
        if first.line > part.span.line:
            return _at(part.span.line + 1, 1), f"{' ' * (first.column - 1)}{default}\n"
        return _at(first.line, first.column), f"{default} "
    before = part.statements[last].span
    behind = part.statements[last + 1 : last + 2]
    next_line = behind[0].span.line if behind else part.span.end_line
    if next_line > before.end_line:
        return _at(before.end_line + 1, 1), f"{' ' * (before.column - 1)}{default}\n"
    return _at(before.end_line, before.end_column), f" {default}"


def _at(line: int, column: int) -> Span:
    return Span(line=line, column=column, end_line=line, end_column=column)
