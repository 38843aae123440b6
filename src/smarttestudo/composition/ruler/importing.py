# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules that come into an editor, and which of its own they meet."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass

from smarttestudo.adirf.document import (
    Document,
    EditError,
    Entry,
    NewStatement,
    Part,
    comment_texts,
    inserted_all,
    meaning,
    read_document,
    replaced_all,
)
from smarttestudo.adirf.syntax import Block, KeepAtLeast, SetFrequency, Statement
from smarttestudo.composition.ruler.sharing import chosen, text_of

_Word = tuple[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Encounter:
    """A statement ``id`` that would come, and one that is there: the same, or one of the same name.

    ``message`` says so in a sentence about the one that is there.
    """

    id: str
    is_same: bool
    message: str


def encounters(document: Document, other: Document) -> Iterator[Encounter]:
    """What statements of ``other`` meet in ``document``."""
    same = {meaning(one.statement): one for one in reversed(document.entries) if one.statement is not None}
    named = _by_word(document)
    for entry in other.entries:
        if entry.statement is None:
            continue
        if twin := same.get(meaning(entry.statement)):
            yield Encounter(id=entry.id, is_same=True, message=f"is here already, in line {_line(twin)}")
        elif rival := named.get(_word(entry.statement)):
            yield Encounter(id=entry.id, is_same=False, message=_said(entry.statement, rival))


def imported(
    document: Document, other: Document, ids: Collection[str] | None, replacing: Collection[str] = ()
) -> str:
    """The text of ``document`` with statements of ``other``; ``ids`` ``None`` means all.

    Those of ``replacing`` go into the place of the one of the same name. Of the others, defaults and floors
    go before the first rule of the last collection, and rules to its end.
    """
    entries = list(other.entries) if ids is None else chosen(other, ids)
    places = _places(document, [one for one in entries if one.id in replacing])
    text = replaced_all(document, {places[one.id]: _instead(one) for one in entries if one.id in places})
    path = document.result.file.path
    added = [entry for entry in entries if entry.id not in places]
    loose = [_new(entry) for entry in added if isinstance(entry.statement, SetFrequency | KeepAtLeast)]
    tall = [_new(entry) for entry in added if not isinstance(entry.statement, SetFrequency | KeepAtLeast)]
    if loose:
        target = read_document(text, path)
        part = _last_part(target)
        text = inserted_all(target, part.id, _first_block(part), loose)
    if tall:
        target = read_document(text, path)
        part = _last_part(target)
        text = inserted_all(target, part.id, len(part.entries), tall)
    return text


def _places(document: Document, entries: Iterable[Entry]) -> Mapping[str, str]:
    """Which statement each of ``entries`` replaces; no two the same."""
    named = dict(_by_word(document))
    places: dict[str, str] = {}
    for entry in entries:
        rival = None if entry.statement is None else named.pop(_word(entry.statement), None)
        if rival is not None:
            places[entry.id] = rival.id
    return places


def _by_word(document: Document) -> Mapping[_Word | None, Entry]:
    """The first statement of each word, as a name is looked for from above."""
    found: dict[_Word | None, Entry] = {}
    for entry in document.entries:
        word = None if entry.statement is None else _word(entry.statement)
        if word is not None:
            found.setdefault(word, entry)
    return found


def _word(statement: Statement) -> _Word | None:
    """What a file should hold once: a rule's name, a topic's default, a topic's floor."""
    match statement:
        case Block():
            return None if statement.name is None else ("rule", statement.name)
        case KeepAtLeast():
            return "floor", statement.topic.text
        case SetFrequency():
            return "default", statement.topic.text


def _said(statement: Statement, rival: Entry) -> str:
    match statement:
        case Block():
            return f"another rule has this name here, in line {_line(rival)}"
        case KeepAtLeast():
            return f"the topic has another floor here, in line {_line(rival)}"
        case SetFrequency():
            return f"the topic has another default here, in line {_line(rival)}"


def _line(entry: Entry) -> int:
    return entry.stretch.tokens[0].line


def _new(entry: Entry) -> NewStatement:
    return NewStatement(content=entry.statement or text_of(entry).lstrip())


def _instead(entry: Entry) -> NewStatement:
    return NewStatement(content=entry.statement or "", comments=comment_texts(entry.comments))


def _last_part(document: Document) -> Part:
    part = next((one for one in reversed(document.parts) if one.begin is not None), None)
    if part is None:
        raise EditError("the text has no 'begin … end' to import into", remedy="write one first")
    return part


def _first_block(part: Part) -> int:
    numbers = (
        at for at, one in enumerate(part.entries) if not isinstance(one.statement, SetFrequency | KeepAtLeast)
    )
    return next(numbers, len(part.entries))
