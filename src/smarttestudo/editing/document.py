# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rule file as its text and the statements in it, also where it does not parse, and what these mean."""

from __future__ import annotations

import hashlib
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count

from smarttestudo.editing.text_edit import LineIndex, TokenRange
from smarttestudo.language.formatter import value_text
from smarttestudo.language.parser import ParseResult, parse
from smarttestudo.language.parser.cursor import STATEMENT_STARTS
from smarttestudo.language.parser.lexer import Token, TokenKind
from smarttestudo.language.syntax import (
    Action,
    And,
    Block,
    CallService,
    Check,
    Collection,
    Comment,
    Condition,
    Group,
    KeepAtLeast,
    KeepWithin,
    Margin,
    Not,
    Notify,
    Or,
    RecordIncident,
    SetFrequency,
    SetParameter,
    Statement,
    Timed,
)

_ABOUT_NEIGHBOURS = frozenset(
    {"missing-end", "missing-end-if", "expected-begin", "foreign-comment", "too-many-errors"}
)
"""Errors that leave the statement whole at whose end they are reported."""


def broken_places(result: ParseResult, places: LineIndex) -> list[int]:
    """The offsets of errors of syntax, rising; a statement around one may lack words: it must stay text."""
    return sorted(
        places.range(finding.span)[0] for finding in result.findings if finding.code not in _ABOUT_NEIGHBOURS
    )


def split_unparsed(tokens: Sequence[Token]) -> Iterator[tuple[int, int]]:
    """From which token to before which: one range for each statement that was begun."""
    first, is_block, awaits_if = 0, False, False
    for at, token in enumerate(tokens):
        kind = token.kind
        is_new = (at == 0 or tokens[at - 1].kind is not TokenKind.DISABLED) and (
            kind in (TokenKind.DISABLED, TokenKind.RULE, TokenKind.KEEP_AT_LEAST)
            or (kind is TokenKind.IF and not awaits_if)
            or (kind in (TokenKind.SET_FREQUENCY, TokenKind.KEEP_WITHIN) and not is_block)
            or (at > 0 and tokens[at - 1].kind is TokenKind.END_IF)
        )
        if is_new and at > first:
            yield first, at
            first = at
        if is_new:
            is_block, awaits_if = False, kind in (TokenKind.DISABLED, TokenKind.RULE)
        if kind in (TokenKind.RULE, TokenKind.IF, TokenKind.THEN):
            is_block = True
        if kind is TokenKind.IF:
            awaits_if = False
    if tokens:
        yield first, len(tokens)


_KEY_DIGITS = 12


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """One statement of a text; ``statement`` is ``None`` for text that does not parse.

    ``id`` names it in this very text. ``key`` comes from its words, so that it survives edits elsewhere.
    """

    id: str
    key: str
    statement: Statement | None
    token_range: TokenRange

    @property
    def comments(self) -> tuple[Comment, ...]:
        """The comments directly above it."""
        return self.token_range.comments


@dataclass(frozen=True, slots=True, kw_only=True)
class CollectionPart:
    """A collection: its statements in order, and where the first would be put.

    ``begin`` is the keyword, ``None`` for statements and other text outside any ``begin … end``.
    """

    id: str
    begin: TokenRange | None
    start: int
    end: int
    line: int
    entries: tuple[Entry, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Document:
    """A text with its parse, its words, and its statements; ``entries`` are those of all ``parts``."""

    text: str
    result: ParseResult
    words: TokenRange
    parts: tuple[CollectionPart, ...]
    entries: tuple[Entry, ...]

    @property
    def places(self) -> LineIndex:
        """The lines and columns of the text as offsets."""
        return self.words.places

    def entry_at(self, offset: int) -> Entry | None:
        """The statement whose words hold ``offset``."""
        entries = self.entries
        at = bisect_right(entries, offset, key=lambda entry: entry.token_range.start) - 1
        return entries[at] if at >= 0 and offset <= entries[at].token_range.end else None

    def entry(self, name: str) -> Entry | None:
        """The statement with the id ``name``."""
        return next((entry for entry in self.entries if entry.id == name), None)

    def behind(self, words: TokenRange) -> TokenRange | None:
        """The word behind ``words``."""
        at = bisect_left(self.words.offsets, words.end)
        return self.words[at] if at < len(self.words) else None

    def part_of(self, entry: Entry) -> CollectionPart:
        """The collection that holds ``entry``."""
        return next(part for part in self.parts if entry in part.entries)


def read_document(text: str, path: str) -> Document:
    """The statements of ``text``; every word of it is in one, but for ``begin`` and ``end``."""
    result = parse(text, path)
    places = LineIndex(text)
    words = TokenRange.of(result.tokens[:-1], text, places)
    parts = tuple(_Reader(result, places).parts(words))
    entries = tuple(entry for part in parts for entry in part.entries)
    return Document(text=text, result=result, words=words, parts=parts, entries=entries)


class _Reader:
    def __init__(self, result: ParseResult, places: LineIndex) -> None:
        self._collections: Mapping[int, Collection] = {
            places.range(collection.span)[0]: collection for collection in reversed(result.file.collections)
        }
        broken = broken_places(result, places)
        ranges = ((places.range(statement.span), statement) for statement in result.file.statements)
        self._statements: Mapping[int, tuple[int, Statement | None]] = {
            start: (end, None if _is_any_between(broken, start, end) else one) for (start, end), one in ranges
        }
        self._places = places
        self._ids = count(1)
        self._keys: Counter[str] = Counter()

    def parts(self, words: TokenRange) -> Iterator[CollectionPart]:
        at, number = 0, count(1)
        while at < len(words):
            found = self._collections.get(words.offsets[at])
            if found:
                after = bisect_left(words.offsets, self._places.range(found.span)[1], lo=at + 1)
            else:
                after = next(
                    (i for i in range(at + 1, len(words)) if words.offsets[i] in self._collections),
                    len(words),
                )
            yield self._part(f"c{next(number)}", words[at:after], is_collection=found is not None)
            at = after

    def _part(self, name: str, words: TokenRange, *, is_collection: bool) -> CollectionPart:
        has_begin = is_collection and words.tokens[0].kind not in STATEMENT_STARTS
        has_end = is_collection and words.tokens[-1].kind is TokenKind.END
        body = words[int(has_begin) : len(words) - int(has_end)]
        return CollectionPart(
            id=name,
            begin=words[0] if has_begin else None,
            start=words.start,
            end=words.end,
            line=words.tokens[0].line,
            entries=tuple(self._entries(body)),
        )

    def _entries(self, words: TokenRange) -> Iterator[Entry]:
        at, loose = 0, 0
        while at < len(words):
            end, statement = self._statements.get(words.offsets[at], (0, None))
            if not end:
                at += 1
                continue
            yield from self._unparsed(words[loose:at])
            loose = bisect_left(words.offsets, end, lo=at + 1)
            yield self._entry(statement, words[at:loose])
            at = loose
        yield from self._unparsed(words[loose:at])

    def _unparsed(self, words: TokenRange) -> Iterator[Entry]:
        for first, last in split_unparsed(words.tokens):
            yield self._entry(None, words[first:last])

    def _entry(self, statement: Statement | None, words: TokenRange) -> Entry:
        return Entry(
            id=f"s{next(self._ids)}",
            key=self._key([token.text for token in words.tokens]),
            statement=statement,
            token_range=words,
        )

    def _key(self, words: Sequence[str]) -> str:
        digest = hashlib.sha256(" ".join(words).encode("utf-8", "surrogatepass")).hexdigest()[:_KEY_DIGITS]
        self._keys[digest] += 1
        return f"{digest}-{self._keys[digest]}"


def _is_any_between(places: Sequence[int], start: int, end: int) -> bool:
    at = bisect_left(places, start)
    return at < len(places) and places[at] <= end


Meaning = tuple[object, ...]
"""Nested tuples; two statements mean the same when these are equal."""


def meaning(statement: Statement | Action) -> Meaning:
    """Words and numbers of a statement: no places, comments, spellings or parentheses."""
    match statement:
        case Block():
            return (
                statement.name,
                statement.priority or 0,
                statement.is_disabled,
                condition_meaning(statement.condition),
                tuple(map(meaning, statement.then)),
                tuple(map(meaning, statement.otherwise)),
            )
        case RecordIncident():
            topics = tuple(topic.text for topic in statement.topics)
            return ("record", statement.name, topics, statement.before.ns, statement.after.ns)
        case KeepAtLeast():
            return ("keep", statement.topic.text, statement.rate.value)
        case KeepWithin():
            return ("within", statement.topic.text, statement.property, statement.bound)
        case SetFrequency():
            return ("set", statement.topic.text, statement.rate.value, margin_meaning(statement.margin))
        case SetParameter():
            return ("parameter", statement.node.text, statement.parameter, statement.text)
        case CallService():
            return ("call", statement.service.text, statement.argument)
        case Notify():
            return ("notify", statement.text)


def margin_meaning(margin: Margin | None) -> Meaning:
    """The words and numbers of a margin."""
    if margin is None:
        return ()
    return margin.to.value, margin.topic.text, margin.property, margin.from_value, margin.to_value


def condition_meaning(condition: Condition) -> Meaning:
    """The checks of a condition and how they are joined."""
    match condition:
        case Check():
            until = condition.until and (condition.until.operator, value_text(condition.until.value))
            value = value_text(condition.value)  # True is no 1, which turns stale.
            return (condition.topic.text, condition.property, condition.operator, value, until)
        case Group():
            return condition_meaning(condition.operand)
        case Not():
            return (Not, condition_meaning(condition.operand))
        case Timed():
            return (condition.word, condition.duration.ns, condition_meaning(condition.operand))
        case And() | Or():
            return (type(condition), *map(condition_meaning, condition.operands))
