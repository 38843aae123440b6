# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules that leave an editor, and rules that come into one."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from itertools import zip_longest

from msgspec import Struct

from smarttestudo.domain.errors import RuleFileError
from smarttestudo.editing import (
    CollectionPart,
    Document,
    EditError,
    Entry,
    NewStatement,
    comment_texts,
    inserted_all,
    meaning,
    read_document,
    replaced_all,
    takes_in,
)
from smarttestudo.language.formatter import first_line_end
from smarttestudo.language.syntax import Block, KeepAtLeast, KeepWithin, SetFrequency, Statement
from smarttestudo.optimizer.model import Model
from smarttestudo.ruler.job import TextAnswer, job
from smarttestudo.ruler.rules.document import (
    CheckedTexts,
    Draft,
    RuleDocument,
    check_sound,
    require_sound,
    require_usable,
    rule_document,
)
from smarttestudo.ruler.rules.edits import EditAnswer, edit_answer
from smarttestudo.ruler.rules.optimize import optimize_draft
from smarttestudo.rules.rule_sets import has_tiers


class ExportRequest(Struct, frozen=True, kw_only=True):
    """A rule file that is to have the statements ``ids`` only.

    409 with findings where these statements have errors.
    """

    text: str
    ids: tuple[str, ...]
    name: str = "rules.adirf"


class ImportRequest(Draft, frozen=True, kw_only=True):
    """Statements of ``other_text`` that come into ``text``.

    ``ids`` are statements of ``other_text``; null means all of them. Those of ``replace_ids`` go into the
    place of the one of the same name, the others into the last collection.
    """

    other_text: str
    ids: tuple[str, ...] | None = None
    replace_ids: tuple[str, ...] = ()


class ImportPreviewRequest(Struct, frozen=True, kw_only=True):
    """A text, and another one that could bring statements."""

    text: str
    other_text: str
    name: str = "rules.adirf"
    other_name: str = "the imported file"


class ImportConflict(Struct, frozen=True, kw_only=True):
    """A statement ``id`` that would come, and one that is there: the same, or one of the same name.

    ``message`` says so in a sentence about the one that is there.
    """

    id: str
    is_same: bool
    message: str


class ImportPreview(Struct, frozen=True, kw_only=True):
    """The statements of the other file with what the checker says of it alone, and whom they meet here."""

    document: RuleDocument
    conflicts: tuple[ImportConflict, ...]


def download_text(draft: Draft) -> str:
    """The rule file as a robot takes it: tiers as numbers, everything else as it is.

    Raises ``RefusedTextError`` for rules with errors, ``RuleFileError`` for tiers that do not fit.
    """
    checked = require_usable(draft)
    if not has_tiers([checked.document.result.file]):
        return draft.text
    outcome = optimize_draft(draft, Model.QUPER, only_named=False).outcome
    if outcome.rewritten is None:
        first = outcome.infeasible[0]
        raise RuleFileError(
            first.message, place=first.solved.subproblem.place, remedy="; ".join(first.remedies) or None
        )
    return outcome.rewritten


@job("POST /api/export", reads=True)
def export(request: ExportRequest) -> TextAnswer:
    """A rule file of the statements ``ids``, as they are written, in their order.

    Raises ``RefusedTextError`` where these have errors; errors of the others do not matter.
    """
    document = read_document(request.text, request.name)
    line_end = first_line_end(document.text)
    entries = chosen(document, request.ids)
    body = (line_end + line_end).join(
        _closed(entry, following, line_end) for entry, following in zip_longest(entries, entries[1:])
    )
    text = line_end.join(["begin", body, "end", ""])
    require_sound(text, request.name)
    return TextAnswer(text=text)


def _closed(entry: Entry, following: Entry | None, line_end: str) -> str:
    """The lines of a statement, with an ``EndIf`` where ``following`` would become a part of it."""
    text = text_of(entry)
    if following is None or not takes_in(entry, following.statement):
        return text
    return f"{text}{line_end}{entry.token_range.indent or '    '}EndIf"


def chosen(document: Document, ids: Collection[str]) -> list[Entry]:
    """The statements ``ids`` in their order; ``EditError`` where there are none or fewer."""
    wanted = set(ids)
    found = [entry for entry in document.entries if entry.id in wanted]
    if not found or len(found) < len(wanted):
        raise EditError("the text has no such statements", remedy="read the document again")
    return found


def text_of(entry: Entry) -> str:
    """The lines of a statement with its comments."""
    words = entry.token_range
    return (words.indent or "    ") + words.text[words.own_start : words.own_end]


_Word = tuple[str, str]


@job("POST /api/import/preview", reads=True)
def import_preview(request: ImportPreviewRequest) -> ImportPreview:
    """Preview of what another text could bring into a text."""
    other = check_sound(request.other_text, request.other_name)
    met = _conflicts(read_document(request.text, request.name), other.document)
    return ImportPreview(document=rule_document(other), conflicts=tuple(met))


def _conflicts(document: Document, other: Document) -> Iterator[ImportConflict]:
    """Conflicts of statements of ``other`` with those of ``document``."""
    same = {meaning(one.statement): one for one in reversed(document.entries) if one.statement is not None}
    named = _by_word(document)
    for entry in other.entries:
        if entry.statement is None:
            continue
        if twin := same.get(meaning(entry.statement)):
            yield ImportConflict(id=entry.id, is_same=True, message=f"is here already, in line {_line(twin)}")
        elif rival := named.get(_word(entry.statement)):
            yield ImportConflict(id=entry.id, is_same=False, message=_said(entry.statement, rival))


@job("POST /api/import", reads=True)
def import_rules(request: ImportRequest, texts: CheckedTexts) -> EditAnswer:
    """A text with statements of another one."""
    text = imported(texts.checked(request).document, request)
    return edit_answer(request, text, texts)


def imported(document: Document, request: ImportRequest) -> str:
    """The text of ``document`` with statements of another.

    Of those that replace none, defaults and floors go before the first rule of the last collection, and rules
    to its end.
    """
    other = read_document(request.other_text, "the imported file")
    entries = list(other.entries) if request.ids is None else chosen(other, request.ids)
    places = _places(document, [one for one in entries if one.id in request.replace_ids])
    text = replaced_all(document, {places[one.id]: _instead(one) for one in entries if one.id in places})
    path = document.result.file.path
    added = [entry for entry in entries if entry.id not in places]
    loose = [
        _new(entry) for entry in added if isinstance(entry.statement, SetFrequency | KeepAtLeast | KeepWithin)
    ]
    tall = [
        _new(entry)
        for entry in added
        if not isinstance(entry.statement, SetFrequency | KeepAtLeast | KeepWithin)
    ]
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
    """Key of what a file should hold once: a rule's name, a topic's default, floor or bound."""
    match statement:
        case Block():
            return None if statement.name is None else ("rule", statement.name)
        case KeepAtLeast():
            return "floor", statement.topic.text
        case KeepWithin():
            return f"bound of {statement.property}", statement.topic.text
        case SetFrequency():
            return "default", statement.topic.text


def _said(statement: Statement, rival: Entry) -> str:
    match statement:
        case Block():
            return f"another rule has this name here, in line {_line(rival)}"
        case KeepAtLeast():
            return f"the topic has another floor here, in line {_line(rival)}"
        case KeepWithin():
            return f"the topic has another bound of {statement.property} here, in line {_line(rival)}"
        case SetFrequency():
            return f"the topic has another default here, in line {_line(rival)}"


def _line(entry: Entry) -> int:
    return entry.token_range.tokens[0].line


def _new(entry: Entry) -> NewStatement:
    return NewStatement(content=entry.statement or text_of(entry).lstrip())


def _instead(entry: Entry) -> NewStatement:
    return NewStatement(content=entry.statement or "", comments=comment_texts(entry.comments))


def _last_part(document: Document) -> CollectionPart:
    part = next((one for one in reversed(document.parts) if one.begin is not None), None)
    if part is None:
        raise EditError("the text has no 'begin … end' to import into", remedy="write one first")
    return part


def _first_block(part: CollectionPart) -> int:
    numbers = (
        at
        for at, one in enumerate(part.entries)
        if not isinstance(one.statement, SetFrequency | KeepAtLeast | KeepWithin)
    )
    return next(numbers, len(part.entries))
