# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One statement in the place of another, with as few changes of the text as there are changes of meaning."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from smarttestudo.adirf.document.document import Entry
from smarttestudo.adirf.document.grafting import grafted, grafted_condition
from smarttestudo.adirf.document.meaning import condition_meaning, meaning, shape
from smarttestudo.adirf.document.splices import Splice, addition, removal
from smarttestudo.adirf.document.stretch import Stretch
from smarttestudo.adirf.formatter import format_condition, format_heading, format_statement
from smarttestudo.adirf.formatter.values import number_text, rate_text
from smarttestudo.adirf.parser.headings import quoted
from smarttestudo.adirf.parser.tokens import TokenKind
from smarttestudo.adirf.syntax import Block, Check, Condition, KeepAtLeast, SetFrequency, Statement, checks_in

_TOPIC, _PROPERTY, _OPERATOR, _NUMBER = 1, 2, 3, 4
"""Which word of a check is what."""


def rewritten(entry: Entry, new: Statement | str, line_end: str) -> list[Splice]:
    """The changes that make ``entry`` say ``new``; none where it does."""
    old, words = entry.statement, entry.stretch
    match old, new:
        case (_, str(text)):
            return _as_text(words, text)
        case (Block(), Block()):
            return _block(old, new, words, line_end)
        case (SetFrequency(), SetFrequency()):
            return _set(old, new, words)
        case (KeepAtLeast(), KeepAtLeast()):
            return _set(old, new, words)
        case (_, statement):
            return [Splice(words.start, words.end, _lines(statement, words, line_end))]


def _as_text(words: Stretch, new: str) -> list[Splice]:
    if words.text[words.start : words.end] == new:
        return []
    hides_next = "//" in new.rpartition("\n")[2] and words.after.strip()
    return [Splice(words.start, words.end, f"{new}\n" if hides_next else new)]


def _lines(statement: Statement, words: Stretch, line_end: str) -> str:
    return _indented(format_statement(statement), words.indent or "", line_end)


def _indented(lines: str, indent: str, line_end: str) -> str:
    """``lines`` below each other, the first one where it stands."""
    return f"{line_end}{indent}".join(lines.rstrip("\n").split("\n"))


def _set(old: SetFrequency | KeepAtLeast, new: SetFrequency | KeepAtLeast, words: Stretch) -> list[Splice]:
    splices = []
    if old.topic.text != new.topic.text:
        splices.append(Splice(*words.places.range(old.topic.span), new.topic.text))
    if old.rate.value != new.rate.value:
        rate = replace(new.rate, has_unit=old.rate.has_unit)
        splices.append(Splice(*words.places.range(old.rate.span), rate_text(rate)))
    return splices


def _block(old: Block, new: Block, words: Stretch, line_end: str) -> list[Splice]:
    if meaning(old) == meaning(new):
        return []
    parts = (
        _heading(old, new, words, line_end),
        _condition(old.condition, new.condition, words, line_end),
        _sets(old.then, new.then, words, line_end),
        _sets(old.otherwise, new.otherwise, words, line_end),
    )
    splices: list[Splice] = []
    for part in parts:
        if part is None:
            whole = grafted(old, new, inside=words)
            return [Splice(words.start, words.own_end, _lines(whole, words, line_end))]
        splices += part
    return splices


def _heading(old: Block, new: Block, words: Stretch, line_end: str) -> list[Splice] | None:
    """The changes of ``Rule "name" Priority n``; ``None`` where comments stand in it."""
    if (old.name, old.priority or 0) == (new.name, new.priority or 0):
        return []
    at = next(index for index, token in enumerate(words.tokens) if token.kind is TokenKind.IF)
    text = format_heading(new)
    if at == 0:
        return [Splice(words.start, words.start, f"{text}{line_end}{words.indent or ''}")]
    heading, start_of_if = words[:at], words[at]
    if any(token.above for token in heading.tokens[1:]) or any(token.beside for token in heading.tokens[:-1]):
        return None
    if text and old.name != new.name and (old.priority or 0) == (new.priority or 0) and new.name is not None:
        return [Splice(heading.offsets[1], heading[1].end, quoted(new.name))]
    keeps_line = bool(text or start_of_if.tokens[0].above or heading.tokens[-1].beside)
    if text and heading.end == start_of_if.start:
        text += " "
    return [Splice(heading.start, heading.end if keeps_line else start_of_if.start, text)]


def _condition(old: Condition, new: Condition, words: Stretch, line_end: str) -> list[Splice]:
    if condition_meaning(old) == condition_meaning(new):
        return []
    if shape(old) == shape(new):
        pairs = zip(checks_in(old), checks_in(new), strict=True)
        return [splice for before, after in pairs for splice in _check(before, after, words)]
    start, end = words.places.range(old.span)
    place = words.between(start, end)
    lines = format_condition(grafted_condition(old, new, beside=place.tokens[-1].beside)).rstrip("\n")
    text = _indented(lines, words.indent or "", line_end)
    # A comment at the end would hide what stands behind it.
    is_hiding = (
        "//" in lines.rpartition("\n")[2] and words.text[end : words.places.line_range(end)[1]].strip()
    )
    return [Splice(start, end, f"{text}{line_end}" if is_hiding else text)]


def _check(old: Check, new: Check, words: Stretch) -> list[Splice]:
    first = words.index_at(words.places.range(old.span)[0])
    changes = (
        (_TOPIC, old.topic.text != new.topic.text, new.topic.text),
        (_PROPERTY, old.property != new.property, new.property),
        (_OPERATOR, old.operator is not new.operator, new.operator.value),
        (_NUMBER, old.value != new.value, number_text(new.value)),
    )
    return [
        Splice(words.offsets[first + word], words[first + word].end, text)
        for word, differs, text in changes
        if differs
    ]


def _sets(
    old: Sequence[SetFrequency], new: Sequence[SetFrequency], words: Stretch, line_end: str
) -> list[Splice] | None:
    """The changes of the statements of a branch; ``None`` where a branch comes, goes or is reordered."""
    before, after = [meaning(one) for one in old], [meaning(one) for one in new]
    if len(old) == len(new):
        pairs = zip(old, new, strict=True)
        return [splice for one, other in pairs for splice in _set(one, other, words)]
    if not old or not new:
        return None
    stretches = [words.between(*words.places.range(one.span)) for one in old]
    if after[: len(before)] == before:
        last = stretches[-1]
        indent = last.indent if last.indent is not None else words.indent or ""
        added = [format_statement(one).rstrip("\n") for one in new[len(old) :]]
        return [addition(last, line_end.join(f"{indent}{line}" for line in added), line_end)]
    kept = [one for one in before if one in after]
    if kept != after:
        return None
    return [
        removal(stretch, None) for stretch, one in zip(stretches, before, strict=True) if one not in after
    ]
