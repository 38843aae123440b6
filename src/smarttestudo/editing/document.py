# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rule file as its text and the statements in it, also where it does not parse."""

from __future__ import annotations

import hashlib
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from typing import NamedTuple

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.source import Span
from smarttestudo.editing.later import MadeLater
from smarttestudo.editing.line_index import LineIndex
from smarttestudo.editing.token_range import TokenRange, comments_above
from smarttestudo.language.comments import Comment
from smarttestudo.language.parser import ParseResult, parse
from smarttestudo.language.parser.cursor import STATEMENT_STARTS
from smarttestudo.language.parser.line_numbers import LineNumbers
from smarttestudo.language.parser.stretches import Stretch
from smarttestudo.language.parser.tokens import Token, TokenKind
from smarttestudo.language.recall import Recall
from smarttestudo.language.syntax import Statement

_ABOUT_NEIGHBOURS = frozenset(
    {"missing-end", "missing-end-if", "expected-begin", "foreign-comment", "too-many-errors"}
)
"""Errors that leave the statement whole at whose end they are reported."""


Place = tuple[int, int]
"""The number of a line, as trees have it, and a column."""


def broken_places(result: ParseResult) -> list[Place]:
    """Where errors of syntax are, in order; a statement around one may lack words: it must stay text."""
    broken = (one for one in result.findings if one.code not in _ABOUT_NEIGHBOURS)
    return sorted(result.lines.numbered(one.span)[:2] for one in broken)


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
class WrittenStatement:
    """The words of a statement; ``statement`` is ``None`` for text that does not parse.

    What an edit left in its place is the same object. ``digest`` comes from the words, and ``start`` is where
    the first one stands.
    """

    statement: Statement | None
    tokens: Sequence[Token]
    digest: str
    start: Place

    @property
    def end(self) -> Place:
        """Where the last word ends."""
        last = self.tokens[-1]
        return last.line, last.column + len(last.text)

    @property
    def span(self) -> Span:
        """Where its words stand."""
        return self.tokens[0].span.to(self.tokens[-1].span)

    @property
    def comments(self) -> tuple[Comment, ...]:
        """The comments directly above it."""
        return comments_above(self.tokens[0])


class Entry(NamedTuple):
    """One statement of a text.

    ``id`` names it in this very text. ``key`` comes from its words, so that it survives edits elsewhere.
    """

    id: str
    key: str
    written: WrittenStatement
    places: LineIndex

    @property
    def statement(self) -> Statement | None:
        """The tree of the statement; ``None`` for text that does not parse."""
        return self.written.statement

    @property
    def token_range(self) -> TokenRange:
        """Its words."""
        return TokenRange.of(self.written.tokens, self.places)

    @property
    def comments(self) -> tuple[Comment, ...]:
        """The comments directly above it."""
        return self.written.comments


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
    entries: Sequence[Entry]


@dataclass(frozen=True, slots=True, kw_only=True)
class Document:
    """A text with its parse and its statements; ``written`` and ``entries`` are those of all ``parts``.

    ``places`` are its lines and columns as offsets, ``starts`` those where the entries start, ``names`` their
    ids and keys. Trees and words number lines as the parser did; the lines of ``result`` tell which these
    are. ``recall`` has what is known of statements that the text before had as well.
    """

    text: str
    result: ParseResult
    places: LineIndex
    parts: tuple[CollectionPart, ...]
    written: Sequence[WrittenStatement]
    entries: Sequence[Entry]
    starts: Sequence[Place]
    names: Sequence[tuple[str, str]]
    recall: Recall

    @property
    def words(self) -> TokenRange:
        """All words."""
        return TokenRange.of(self.result.numbered_tokens[:-1], self.places)

    def numbered(self, place: Span) -> Span:
        """A place of the text as trees and words have it."""
        return self.result.lines.numbered(place)

    def number_at(self, place: Span) -> int | None:
        """The number of the statement whose words hold the start of ``place`` in the text."""
        return self.number_of(self.numbered(place))

    def number_of(self, place: Span) -> int | None:
        """The number of the statement whose words hold the start of ``place`` of a tree."""
        at = bisect_right(self.starts, place[:2]) - 1
        return at if at >= 0 and place[:2] <= self.written[at].end else None

    def entry_at(self, place: Span) -> Entry | None:
        """The statement whose words hold the start of ``place`` in the text."""
        at = self.number_at(place)
        return None if at is None else self.entries[at]

    def entry(self, name: str) -> Entry | None:
        """The statement with the id ``name``."""
        return next((one for one in self.entries if one.id == name), None)

    def behind(self, words: TokenRange) -> TokenRange | None:
        """The word behind ``words``."""
        all_words = self.words
        at = bisect_left(all_words.offsets, words.end)
        return all_words[at] if at < len(all_words) else None

    def part_of(self, entry: Entry) -> CollectionPart:
        """The collection that holds ``entry``."""
        return next(part for part in self.parts if entry in part.entries)


def read_document(text: str, path: str, before: Document | None = None) -> Document:
    """The statements of ``text``; every word of it is in one, but for ``begin`` and ``end``.

    What it has in common with ``before``, such as the same before an edit, is not read again.
    """
    result = parse(text, path, None if before is None else before.result)
    recall = Recall(None if before is None else before.recall)
    places = LineIndex(text, result.stretches)
    bodies = list(_Reader(result, recall).bodies())
    written = list(chain.from_iterable(body.statements for body in bodies))
    names = recall.each("names", _named, written, range(1, len(written) + 1), _repeats(written))
    entries = MadeLater(
        len(written), lambda: (Entry(*name, one, places) for name, one in zip(names, written, strict=True))
    )
    return Document(
        text=text,
        result=result,
        places=places,
        parts=tuple(_parts(bodies, entries, places, result.lines)),
        written=written,
        entries=entries,
        starts=[one.start for one in written],
        names=names,
        recall=recall,
    )


def _parts(
    bodies: Sequence[_Body], entries: Sequence[Entry], places: LineIndex, lines: LineNumbers
) -> Iterator[CollectionPart]:
    start = 0
    for number, body in enumerate(bodies, start=1):
        end = start + len(body.statements)
        yield body.part(f"c{number}", MadeLater.part_of(entries, start, end), places, lines)
        start = end


def _named(written: WrittenStatement, number: int, repeat: int) -> tuple[str, str]:
    """The id and the key of a statement."""
    return f"s{number}", f"{written.digest}-{repeat}"


def _repeats(written: Iterable[WrittenStatement]) -> list[int]:
    """How many statements up to each one have its words."""
    digests = [one.digest for one in written]
    if len(set(digests)) == len(digests):
        return [1] * len(digests)
    counts: dict[str, int] = {}
    repeats: list[int] = []
    for one in digests:
        counts[one] = counts.get(one, 0) + 1
        repeats.append(counts[one])
    return repeats


_Piece = Token | Stretch
"""A word, or a stretch that is whole statements, of a body."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Body:
    """Statements of a collection, or outside any."""

    begin: Token | None
    first: Token
    last: Token
    statements: Sequence[WrittenStatement]

    def part(
        self, name: str, entries: Sequence[Entry], places: LineIndex, lines: LineNumbers
    ) -> CollectionPart:
        return CollectionPart(
            id=name,
            begin=None if self.begin is None else TokenRange.of([self.begin], places),
            start=places.range(self.first.span)[0],
            end=places.range(self.last.span)[1],
            line=lines.line(self.first.line),
            entries=entries,
        )


class _Reader:
    """Reads bodies; a stretch that the parser knew keeps its statements."""

    def __init__(self, result: ParseResult, recall: Recall) -> None:
        self._collections = {one.span[:2]: one for one in reversed(result.numbered.collections)}
        self._statements = result.numbered.statements
        self._broken = broken_places(result)
        broken = {bisect_right(result.lines.numbers, line) - 1 for line, _ in self._broken}
        known = [
            one for number, one in enumerate(result.stretches) if one.statements and number not in broken
        ]
        self._known = dict(zip(map(id, known), recall.each("statements", _split, known), strict=True))
        self._pieces: list[_Piece] = []
        for stretch in result.stretches:
            if id(stretch) in self._known:
                self._pieces.append(stretch)
            else:
                self._pieces += stretch.tokens
        del self._pieces[-1:]

    def bodies(self) -> Iterator[_Body]:
        """All in their order."""
        pieces = self._pieces
        at = 0
        while at < len(pieces):
            found = self._collections.get(_start(pieces[at]))
            if found:
                after = bisect_left(pieces, found.span[2:], lo=at + 1, key=_start)
            else:
                after = next(
                    (i for i in range(at + 1, len(pieces)) if _start(pieces[i]) in self._collections),
                    len(pieces),
                )
            yield self._body(pieces[at:after], is_collection=found is not None)
            at = after

    def _body(self, pieces: Sequence[_Piece], *, is_collection: bool) -> _Body:
        first, last = _words(pieces[0])[0], _words(pieces[-1])[-1]
        has_begin = is_collection and first.kind not in STATEMENT_STARTS
        has_end = is_collection and last.kind is TokenKind.END
        inner = pieces[int(has_begin) : len(pieces) - int(has_end)]
        return _Body(
            begin=first if has_begin else None, first=first, last=last, statements=list(self._written(inner))
        )

    def _written(self, pieces: Sequence[_Piece]) -> Iterator[WrittenStatement]:
        loose: list[Token] = []
        at = 0
        while at < len(pieces):
            piece = pieces[at]
            after = at + 1
            if isinstance(piece, Stretch):
                if loose:
                    yield from _unparsed(loose)
                    loose = []
                yield from self._known[id(piece)]
            elif statement := self._statement_at(_start(piece)):
                yield from _unparsed(loose)
                loose = []
                start, end = statement.span[:2], statement.span[2:]
                after = bisect_left(pieces, end, lo=after, key=_start)
                words = [word for one in pieces[at:after] for word in _words(one)]
                yield _written(None if self._is_broken(start, end) else statement, words)
            else:
                loose.append(piece)
            at = after
        yield from _unparsed(loose)

    def _statement_at(self, start: Place) -> Statement | None:
        at = bisect_left(self._statements, start, key=lambda one: one.span[:2])
        found = self._statements[at : at + 1]
        return found[0] if found and found[0].span[:2] == start else None

    def _is_broken(self, start: Place, end: Place) -> bool:
        at = bisect_left(self._broken, start)
        return at < len(self._broken) and self._broken[at] <= end


def _words(piece: _Piece) -> Sequence[Token]:
    return piece.tokens if isinstance(piece, Stretch) else (piece,)


def _start(piece: _Piece) -> Place:
    first = _words(piece)[0]
    return first.line, first.column


def _split(stretch: Stretch) -> Sequence[WrittenStatement]:
    """The statements of a stretch that is known."""
    statements = stretch.statements or ()
    starts = [bisect_left(stretch.tokens, one.span[:2], key=_start) for one in statements]
    ends = [*starts[1:], len(stretch.tokens)]
    words = (stretch.tokens[start:end] for start, end in zip(starts, ends, strict=True))
    return [_written(one, its_words) for one, its_words in zip(statements, words, strict=True)]


def _unparsed(words: Sequence[Token]) -> Iterator[WrittenStatement]:
    for first, last in split_unparsed(words):
        yield _written(None, words[first:last])


def _written(statement: Statement | None, words: Sequence[Token]) -> WrittenStatement:
    text = " ".join(word.text for word in words)
    digest = hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:_KEY_DIGITS]
    return WrittenStatement(statement=statement, tokens=words, digest=digest, start=_start(words[0]))
