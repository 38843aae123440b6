# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Edits of a rule file, by the ids of its statements."""

from __future__ import annotations

from msgspec import Struct

from smarttestudo.editing import (
    Document,
    EditError,
    TextEdit,
    apply,
    deleted,
    duplicated,
    inserted,
    moved,
    read_document,
    replaced,
)
from smarttestudo.language.formatter import format_rules
from smarttestudo.ruler.job import TextAnswer, job
from smarttestudo.ruler.rules.document import CheckedTexts, Draft, RuleDocument, Substitute, rule_document
from smarttestudo.ruler.rules.statement_trees import Utf16, new_statement
from smarttestudo.ruler.rules.statements import Statement
from smarttestudo.ruler.rules.zones import MoveZone, NewZone, ResizeZone, zone_edited


class Replace(Struct, frozen=True, kw_only=True, tag_field="kind", tag="replace"):
    """Write ``statement`` in the place of statement ``id``; only what differs is touched.

    Comments stay where ``statement.comments`` is null; a list replaces those directly above.
    """

    id: str
    statement: Statement


class Insert(Struct, frozen=True, kw_only=True, tag_field="kind", tag="insert"):
    """Put ``statement`` before number ``index`` of ``collection``; its length puts it at the end."""

    collection: str
    index: int
    statement: Statement


class Delete(Struct, frozen=True, kw_only=True, tag_field="kind", tag="delete"):
    """Delete statement ``id`` with its own comments."""

    id: str


class Duplicate(Struct, frozen=True, kw_only=True, tag_field="kind", tag="duplicate"):
    """Put a copy of statement ``id``, as it is written, behind it; a rule's copy has a name of its own."""

    id: str


class Move(Struct, frozen=True, kw_only=True, tag_field="kind", tag="move"):
    """Move statement ``id``; ``index`` counts the other statements of ``collection``."""

    id: str
    collection: str
    index: int


StatementEdit = Replace | Insert | Delete | Duplicate | Move | NewZone | MoveZone | ResizeZone
Edit = StatementEdit | Substitute


class EditRequest(Draft, frozen=True, kw_only=True):
    """Edits that are all made in their order, or none of them.

    Each speaks of the text that those before it made: its ids, indices and offsets.
    """

    edits: tuple[Edit, ...]


class EditAnswer(Struct, frozen=True, kw_only=True):
    """The new text and its document."""

    text: str
    document: RuleDocument


@job("POST /api/edit", reads=True)
def edit(request: EditRequest, texts: CheckedTexts) -> EditAnswer:
    """A text with edits. Raises ``EditError`` for one that the text or the language does not allow."""
    text = request.text
    for number, one in enumerate(request.edits):
        if isinstance(one, Substitute):
            text = _substituted(text, one)
        else:
            document = read_document(text, request.name) if number else texts.checked(request).document
            text = _edited(document, one)
    return edit_answer(request, text, texts)


def edit_answer(draft: Draft, text: str, texts: CheckedTexts) -> EditAnswer:
    """The answer with the text that a draft became."""
    return EditAnswer(text=text, document=rule_document(texts.checked(draft, text)))


@job("POST /api/format", reads=True)
def format_text(draft: Draft) -> TextAnswer:
    """A text in the house style; one with errors as it is."""
    return TextAnswer(text=format_rules(draft.text, draft.name))


def _edited(before: Document, edit: StatementEdit) -> str:
    match edit:
        case Replace():
            return replaced(before, edit.id, new_statement(edit.statement))
        case Insert():
            return inserted(before, edit.collection, edit.index, new_statement(edit.statement))
        case Delete():
            return deleted(before, edit.id)
        case Duplicate():
            return duplicated(before, edit.id)
        case Move():
            return moved(before, edit.id, edit.collection, edit.index)
        case NewZone() | MoveZone() | ResizeZone():
            return zone_edited(before, edit)


def _substituted(text: str, edit: Substitute) -> str:
    utf16 = Utf16(text)
    start, end = utf16.characters(edit.offset), utf16.characters(edit.end_offset)
    if not 0 <= start <= end <= len(text):
        raise EditError("the text has no such place", remedy="read the document again")
    return apply(text, [TextEdit(start, end, edit.replacement)])
