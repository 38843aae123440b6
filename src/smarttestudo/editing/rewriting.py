# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statements rewritten, with their comments kept."""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import TypeVar

from smarttestudo.editing.condition_edits import changed_words, condition_edits
from smarttestudo.editing.document import Entry, Meaning, condition_meaning, margin_meaning, meaning
from smarttestudo.editing.text_edit import TextEdit, TokenRange, addition, removal
from smarttestudo.language.formatter import (
    bound_text,
    duration_text,
    format_condition,
    format_heading,
    format_statement,
    margin_text,
    rate_text,
)
from smarttestudo.language.parser.lexer import TokenKind
from smarttestudo.language.parser.values import quoted
from smarttestudo.language.syntax import (
    NO_TRIVIA,
    Action,
    And,
    Block,
    CallService,
    Check,
    Comment,
    Condition,
    Group,
    KeepAtLeast,
    KeepWithin,
    Not,
    Notify,
    Or,
    RecordIncident,
    SetFrequency,
    SetParameter,
    Statement,
    Timed,
)
from smarttestudo.language.syntax_walks import (
    checks_in,
)


def with_comments(old: Block, new: Block, *, inside: TokenRange) -> Block:
    """``new`` with the comments of ``old`` that stand ``inside`` its words, and its way to end."""
    above = tuple(
        comment for comment in old.trivia.above if inside.places.range(comment.span)[0] >= inside.start
    )
    from_else = _gone(old.otherwise, new.otherwise)
    from_then = _gone(old.then, new.then)
    return replace(
        new,
        condition=with_comments_preserved(old.condition, new.condition),
        then=tuple(_with_comments(action, old.then, from_else) for action in new.then),
        otherwise=tuple(_with_comments(action, old.otherwise, from_then) for action in new.otherwise),
        has_end_if=old.has_end_if,
        trivia=replace(old.trivia, above=above, blank_above=False),
        if_trivia=old.if_trivia,
        then_trivia=old.then_trivia,
        else_trivia=old.else_trivia,
        end_if_trivia=old.end_if_trivia,
    )


def with_comments_preserved(old: Condition, new: Condition, *, beside: Comment | None = None) -> Condition:
    """``new`` with the comments and spellings of the checks that it has in common with ``old``.

    The comment ``beside`` stays where it is and is left out.
    """
    if isinstance(old, Timed):
        inner = new.operand if isinstance(new, Timed) else new
        kept = with_comments_preserved(old.operand, inner, beside=beside)
        return replace(new, operand=kept) if isinstance(new, Timed) else kept
    checks: dict[Meaning, deque[Check]] = defaultdict(deque)
    for check in checks_in(old):
        checks[condition_meaning(check)].append(_without(check, beside))
    found = _with_checks(new, checks)
    if isinstance(old, Group) and isinstance(found, And | Or):
        found = Group(operand=found, span=found.span)
    if isinstance(old, Group) and isinstance(found, Group):
        return replace(found, trivia=_without(old, beside).trivia, closing=old.closing)
    return found


_Commented = TypeVar("_Commented", Check, Group)


def _without(condition: _Commented, beside: Comment | None) -> _Commented:
    if beside is None or condition.trivia.beside != beside:
        return condition
    return replace(condition, trivia=replace(condition.trivia, beside=None))


def _with_checks(condition: Condition, checks: Mapping[Meaning, deque[Check]]) -> Condition:
    """``condition`` with the next of ``checks`` that says the same in the place of each of its own."""
    match condition:
        case Check():
            written = checks.get(condition_meaning(condition))
            return written.popleft() if written else condition
        case Not() | Group() | Timed():
            return replace(condition, operand=_with_checks(condition.operand, checks))
        case And() | Or():
            operands = tuple(_with_checks(operand, checks) for operand in condition.operands)
            return replace(condition, operands=operands)


def _gone(old: Sequence[Action], new: Sequence[Action]) -> list[Action]:
    """Actions of one side of a block that it has no more: they may have gone to the other."""
    left = set(map(_subject, new))
    return [action for action in old if _subject(action) not in left]


def _with_comments(new: Action, *sides: Sequence[Action]) -> Action:
    """``new`` with the comments of the action of its subject on the first of ``sides`` that has one."""
    for action in chain(*sides):
        if _subject(action) == _subject(new):
            return action if meaning(action) == meaning(new) else replace(new, trivia=action.trivia)
    return new


def _subject(action: Action) -> Meaning:
    """The subject of an action, whatever it says of it."""
    match action:
        case SetFrequency():
            return (SetFrequency, action.topic.text)
        case KeepWithin():
            return (KeepWithin, action.topic.text, action.property)
        case RecordIncident():
            return (RecordIncident, action.name)
        case SetParameter():
            return (SetParameter, action.node.text, action.parameter)
        case CallService():
            return (CallService, action.service.text)
        case Notify():
            return (Notify, action.text)


_TOPIC, _PROPERTY, _BOUND = 1, 2, 3
"""Which word of a KeepWithin is what."""
_NAME = 1
"""Which word of a Record is its name."""


def rewritten(entry: Entry, new: Statement | str, line_end: str) -> list[TextEdit]:
    """The changes that make ``entry`` say ``new``; none where it does."""
    old, words = entry.statement, entry.token_range
    match old, new:
        case (_, str(text)):
            return _as_text(words, text)
        case (Block(), Block()):
            return _block(old, new, words, line_end)
        case (SetFrequency(), SetFrequency()):
            return _set(old, new, words)
        case (KeepAtLeast(), KeepAtLeast()):
            return _set(old, new, words)
        case (KeepWithin(), KeepWithin()):
            return _within(old, new, words)
        case (_, statement):
            return [TextEdit(words.start, words.end, _lines(statement, words, line_end))]


def _as_text(words: TokenRange, new: str) -> list[TextEdit]:
    if words.text[words.start : words.end] == new:
        return []
    return [TextEdit(words.start, words.end, _ended(new, words, "\n"))]


def _ended(new: str, words: TokenRange, line_end: str) -> str:
    """``new`` in the place of ``words``, with a line's end where its last comment would hide what follows."""
    hides_next = "//" in new.rpartition("\n")[2] and words.after.strip()
    return f"{new}{line_end}" if hides_next else new


def _lines(statement: Statement, words: TokenRange, line_end: str) -> str:
    return _indented(format_statement(statement), words.indent or "", line_end)


def _indented(lines: str, indent: str, line_end: str) -> str:
    """``lines`` below each other, the first one where it stands."""
    return f"{line_end}{indent}".join(lines.rstrip("\n").split("\n"))


def _set(
    old: SetFrequency | KeepAtLeast, new: SetFrequency | KeepAtLeast, words: TokenRange
) -> list[TextEdit]:
    text_edits = []
    if old.topic.text != new.topic.text:
        text_edits.append(TextEdit(*words.places.range(old.topic.span), new.topic.text))
    if old.rate.value != new.rate.value:
        rate = replace(new.rate, has_unit=old.rate.has_unit)
        text_edits.append(TextEdit(*words.places.range(old.rate.span), rate_text(rate)))
    if isinstance(old, SetFrequency) and isinstance(new, SetFrequency):
        text_edits += _margin(old, new, words)
    return text_edits


def _margin(old: SetFrequency, new: SetFrequency, words: TokenRange) -> list[TextEdit]:
    if margin_meaning(old.margin) == margin_meaning(new.margin):
        return []
    text = "" if new.margin is None else f" {margin_text(new.margin)}"
    start = words.places.range(old.rate.span)[1]
    end = start if old.margin is None else words.places.range(old.margin.span)[1]
    return [TextEdit(start, end, text)]


def _action(old: Action, new: Action, words: TokenRange) -> list[TextEdit]:
    if isinstance(old, KeepWithin) and isinstance(new, KeepWithin):
        return _within(old, new, words)
    if isinstance(old, SetFrequency) and isinstance(new, SetFrequency):
        return _set(old, new, words)
    if isinstance(old, RecordIncident) and isinstance(new, RecordIncident):
        return _record(old, new, words)
    if meaning(old) == meaning(new):
        return []
    bare = replace(new, trivia=NO_TRIVIA)
    return [TextEdit(*words.places.range(old.span), format_statement(bare).rstrip("\n"))]


def _record(old: RecordIncident, new: RecordIncident, words: TokenRange) -> list[TextEdit]:
    first = words.index_at(words.places.range(old.span)[0])
    changes = (
        (_NAME, old.name != new.name, quoted(new.name)),
        *(
            (_NAME + number, before.text != after.text, after.text)
            for number, (before, after) in enumerate(zip(old.topics, new.topics, strict=False), 1)
        ),
    )
    durations = ((old.before, new.before), (old.after, new.after))
    return [
        *changed_words(first, changes, words),
        *_more_topics(words[first + _NAME :], len(old.topics), [topic.text for topic in new.topics]),
        *(
            TextEdit(*words.places.range(before.span), duration_text(after))
            for before, after in durations
            if before.ns != after.ns
        ),
    ]


def _more_topics(words: TokenRange, count: int, topics: Sequence[str]) -> list[TextEdit]:
    """Puts what is more than ``count`` behind the last topic, or takes out the topics that are too many."""
    added = "".join(f" {topic}" for topic in topics[count:])
    end = words[count].end
    removed = (words[at - 1 : at + 1] for at in range(len(topics) + 1, count + 1))
    return [
        *(TextEdit(two.offsets[1] if _has_comment(two) else two[0].end, two.end, "") for two in removed),
        *([TextEdit(end, end, added)] if added else []),
    ]


def _within(old: KeepWithin, new: KeepWithin, words: TokenRange) -> list[TextEdit]:
    first = words.index_at(words.places.range(old.span)[0])
    changes = (
        (_TOPIC, old.topic.text != new.topic.text, new.topic.text),
        (_PROPERTY, old.property != new.property, new.property),
        (_BOUND, old.bound != new.bound, bound_text(replace(new, text=""))),
    )
    return changed_words(first, changes, words)


def _has_comment(two: TokenRange) -> bool:
    """Whether a comment stands between two words."""
    return bool(two.tokens[0].beside or two.tokens[1].above)


def _block(old: Block, new: Block, words: TokenRange, line_end: str) -> list[TextEdit]:
    if meaning(old) == meaning(new):
        return []
    parts = (
        _disabled(old, new, words),
        _heading(old, new, words, line_end),
        _condition(old.condition, new.condition, words, line_end),
        _actions(old.then, new.then, words, line_end),
        _actions(old.otherwise, new.otherwise, words, line_end),
    )
    text_edits: list[TextEdit] = []
    for part in parts:
        if part is None:
            whole = with_comments(old, new, inside=words)
            text = _ended(_lines(whole, words, line_end), words, line_end)
            return [TextEdit(words.start, words.own_end, text)]
        text_edits += part
    return text_edits


def _disabled(old: Block, new: Block, words: TokenRange) -> list[TextEdit]:
    """Puts ``Disabled`` before the block, or takes it out."""
    if old.is_disabled == new.is_disabled:
        return []
    if new.is_disabled:
        return [TextEdit(words.start, words.start, f"{TokenKind.DISABLED.value} ")]
    first = words[0]
    return [TextEdit(first.start, first.end if _has_comment(words[:2]) else words.offsets[1], "")]


def _heading(old: Block, new: Block, words: TokenRange, line_end: str) -> list[TextEdit] | None:
    """The changes of ``Rule "name" Priority n``; ``None`` where comments stand in it."""
    if (old.name, old.priority or 0) == (new.name, new.priority or 0):
        return []
    at = next(index for index, token in enumerate(words.tokens) if token.kind is TokenKind.IF)
    heading, start_of_if = words[int(old.is_disabled) : at], words[at]
    text = format_heading(new)
    if not len(heading):
        return [TextEdit(start_of_if.start, start_of_if.start, f"{text}{line_end}{words.indent or ''}")]
    if any(token.above for token in heading.tokens[1:]) or any(token.beside for token in heading.tokens[:-1]):
        return None
    if text and old.name != new.name and (old.priority or 0) == (new.priority or 0) and new.name is not None:
        return [TextEdit(heading.offsets[1], heading[1].end, quoted(new.name))]
    keeps_line = bool(text or start_of_if.tokens[0].above or heading.tokens[-1].beside)
    if text and heading.end == start_of_if.start:
        text += " "
    return [TextEdit(heading.start, heading.end if keeps_line else start_of_if.start, text)]


def _condition(old: Condition, new: Condition, words: TokenRange, line_end: str) -> list[TextEdit]:
    if condition_meaning(old) == condition_meaning(new):
        return []
    text_edits = condition_edits(old, new, words)
    if text_edits is not None:
        return text_edits
    start, end = words.places.range(old.span)
    place = words.between(start, end)
    lines = format_condition(with_comments_preserved(old, new, beside=place.tokens[-1].beside)).rstrip("\n")
    text = _indented(lines, words.indent or "", line_end)
    # A comment at the end would hide what stands behind it.
    is_hiding = (
        "//" in lines.rpartition("\n")[2] and words.text[end : words.places.line_range(end)[1]].strip()
    )
    return [TextEdit(start, end, f"{text}{line_end}" if is_hiding else text)]


def _actions(
    old: Sequence[Action], new: Sequence[Action], words: TokenRange, line_end: str
) -> list[TextEdit] | None:
    """The changes of the statements of a branch; ``None`` where a branch comes, goes or is reordered."""
    before, after = [meaning(one) for one in old], [meaning(one) for one in new]
    if len(old) == len(new):
        if any(type(one) is not type(other) for one, other in zip(old, new, strict=True)):
            return None
        pairs = zip(old, new, strict=True)
        return [text_edit for one, other in pairs for text_edit in _action(one, other, words)]
    if not old or not new:
        return None
    token_ranges = [words.between(*words.places.range(one.span)) for one in old]
    if after[: len(before)] == before:
        last = token_ranges[-1]
        indent = last.indent if last.indent is not None else words.indent or ""
        added = [format_statement(one).rstrip("\n") for one in new[len(old) :]]
        return [addition(last, line_end.join(f"{indent}{line}" for line in added), line_end)]
    kept = [one for one in before if one in after]
    if kept != after:
        return None
    return [
        removal(token_range, None)
        for token_range, one in zip(token_ranges, before, strict=True)
        if one not in after
    ]
