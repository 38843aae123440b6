# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Conditions changed word by word, so that all else that is written in them stays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from smarttestudo.editing.text_edit import TextEdit, TokenRange
from smarttestudo.language.formatter import compared_text, duration_text, time_text, until_text, value_text
from smarttestudo.language.syntax import And, Check, Condition, Group, Not, Or, Timed

_TOPIC, _PROPERTY, _OPERATOR, _NUMBER = 1, 2, 3, 4
"""Which word of a check is what."""
_UNTIL_OPERATOR, _UNTIL_NUMBER = 6, 7


class _Changed(NamedTuple):
    """A condition without its times, innermost first; ``core`` has the parentheses around it."""

    core: Condition
    times: Sequence[Timed]


def condition_edits(old: Condition, new: Condition, words: TokenRange) -> list[TextEdit] | None:
    """The words that differ.

    ``None`` where checks come or go, are joined otherwise, or comments are in the way.
    """
    before, after = _changed(old), _changed(new)
    times = _time_edits(before, after.times, words)
    core = _core_edits(_bare(before.core), _bare(after.core), words)
    return None if times is None or core is None else [*core, *times]


def changed_words(first: int, changes: Iterable[tuple[int, bool, str]], words: TokenRange) -> list[TextEdit]:
    """Replacements of the words, counted from ``first``, that differ."""
    return [
        TextEdit(words.offsets[first + word], words[first + word].end, text)
        for word, differs, text in changes
        if differs
    ]


def _changed(condition: Condition) -> _Changed:
    times: list[Timed] = []
    core = at = condition
    while isinstance(at, Timed | Group):
        if isinstance(at, Timed):
            times.append(at)
            core = at.operand
        at = at.operand
    return _Changed(core, times[::-1])


def _bare(condition: Condition) -> Condition:
    return _bare(condition.operand) if isinstance(condition, Group) else condition


def _core_edits(old: Condition, new: Condition, words: TokenRange) -> list[TextEdit] | None:
    match old, new:
        case Check(), Check():
            return _check_edits(old, new, words)
        case Not(), Not():
            return condition_edits(old.operand, new.operand, words)
        case And(operands=before), And(operands=after):
            return _operand_edits(before, after, words)
        case Or(operands=before), Or(operands=after):
            return _operand_edits(before, after, words)
        case _:
            return None


def _operand_edits(
    old: Sequence[Condition], new: Sequence[Condition], words: TokenRange
) -> list[TextEdit] | None:
    if len(old) != len(new):
        return None
    found: list[TextEdit] = []
    for before, after in zip(old, new, strict=True):
        part = condition_edits(before, after, words)
        if part is None:
            return None
        found += part
    return found


def _check_edits(old: Check, new: Check, words: TokenRange) -> list[TextEdit] | None:
    first = words.index_at(words.places.range(old.span)[0])
    changes = [
        (_TOPIC, old.topic.text != new.topic.text, new.topic.text),
        (_PROPERTY, old.property != new.property, new.property),
        (_OPERATOR, old.operator is not new.operator, new.operator.value),
        (_NUMBER, value_text(old.value) != value_text(new.value), compared_text(new)),
    ]
    if old.until is not None and new.until is not None:
        changes += [
            (_UNTIL_OPERATOR, old.until.operator is not new.until.operator, new.until.operator.value),
            (
                _UNTIL_NUMBER,
                value_text(old.until.value) != value_text(new.until.value),
                compared_text(new.until),
            ),
        ]
        return changed_words(first, changes, words)
    found = changed_words(first, changes, words)
    if new.until is not None:
        end = words[first + _NUMBER].end
        return [*found, TextEdit(end, end, f" {until_text(new.until)}")]
    if old.until is not None:
        removed = _removed(words[first + _NUMBER : first + _UNTIL_NUMBER + 1])
        return None if removed is None else [*found, removed]
    return found


def _time_edits(old: _Changed, new: Sequence[Timed], words: TokenRange) -> list[TextEdit] | None:
    if len(old.times) == len(new):
        pairs = zip(old.times, new, strict=True)
        return [text_edit for one, other in pairs for text_edit in _time_changes(one, other, words)]
    if len(old.times) < len(new):
        return _added_times(old, new, words)
    return _removed_times(old, new, words)


def _time_changes(old: Timed, new: Timed, words: TokenRange) -> list[TextEdit]:
    start, end = words.places.range(old.duration.span)
    at = words.index_at(start)
    found = changed_words(at - 1, [(0, old.word is not new.word, new.word.value)], words)
    if old.duration.ns != new.duration.ns:
        found.append(TextEdit(start, end, duration_text(new.duration)))
    return found


def _added_times(old: _Changed, new: Sequence[Timed], words: TokenRange) -> list[TextEdit] | None:
    """The text behind the times that stay, which are in both in the same order."""
    start, end = words.places.range(old.core.span)
    needs_group = isinstance(old.core, Not | And | Or)
    found = [TextEdit(start, start, "("), TextEdit(end, end, ")")] if needs_group else []
    staying = list(old.times)
    for timed in new:
        if staying and _is_same(staying[0], timed):
            end = words.places.range(staying.pop(0).duration.span)[1]
        else:
            found.append(TextEdit(end, end, f" {time_text(timed)}"))
    return None if staying else found


def _removed_times(old: _Changed, new: Sequence[Timed], words: TokenRange) -> list[TextEdit] | None:
    staying, found = list(new), []
    for timed in old.times:
        if staying and _is_same(staying[0], timed):
            staying.pop(0)
            continue
        at = words.index_at(words.places.range(timed.duration.span)[0])
        removed = _removed(words[at - 2 : at + 2])
        if removed is None:
            return None
        found.append(removed)
    return None if staying else found


def _is_same(one: Timed, other: Timed) -> bool:
    return (one.word, one.duration.ns) == (other.word, other.duration.ns)


def _removed(part: TokenRange) -> TextEdit | None:
    """Takes out all but the first word of ``part``; ``None`` where a comment stands between."""
    if any(token.above for token in part.tokens[1:]) or any(token.beside for token in part.tokens[:-1]):
        return None
    return TextEdit(part[0].end, part.end, "")
