# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Edits of a rule file, by the ids of its statements."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

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
from smarttestudo.ruler.rules.document import (
    CheckedText,
    Draft,
    RuleDocument,
    Substitute,
    check_text,
    rule_document,
)
from smarttestudo.ruler.rules.sharing import ExportRequest, ImportRequest, exported, imported
from smarttestudo.ruler.rules.statement_trees import Utf16, new_statement
from smarttestudo.ruler.rules.statements import Statement
from smarttestudo.ruler.rules.zones import (
    MoveZone,
    NewZone,
    ResizeZone,
    ZonesAnswer,
    zone_edited,
    zones_answer,
)

_TEXTS_KEPT = 4


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
    """``POST /api/edit`` → ``EditAnswer``: all edits in their order, or none of them.

    Each speaks of the text that those before it made: its ids, indices and offsets.
    """

    edits: tuple[Edit, ...]


class EditAnswer(Struct, frozen=True, kw_only=True):
    """The new text and its document."""

    text: str
    document: RuleDocument


class TextAnswer(Struct, frozen=True, kw_only=True):
    """One text."""

    text: str


class EditedTexts:
    """Texts of rule files, read and checked once however often the page asks about the last few."""

    def __init__(self) -> None:
        self._check: Callable[[Draft], CheckedText] = lru_cache(maxsize=_TEXTS_KEPT)(check_text)

    def document(self, draft: Draft) -> RuleDocument:
        """Statements and findings of a text."""
        return rule_document(self._checked(draft))

    def zones(self, draft: Draft) -> ZonesAnswer:
        """The zones of a text."""
        return zones_answer(self._checked(draft))

    def edit(self, request: EditRequest) -> EditAnswer:
        """A text with edits. Raises ``EditError`` for one that the text or the language does not allow."""
        text = request.text
        for number, edit in enumerate(request.edits):
            if isinstance(edit, Substitute):
                text = _substituted(text, edit)
            else:
                document = read_document(text, request.name) if number else self._checked(request).document
                text = _edited(document, edit)
        return self._answer(request, text)

    def import_rules(self, request: ImportRequest) -> EditAnswer:
        """A text with statements of another one."""
        return self._answer(request, imported(self._checked(request).document, request))

    def _answer(self, request: Draft, text: str) -> EditAnswer:
        return EditAnswer(text=text, document=rule_document(self._checked(request, text)))

    def _checked(self, request: Draft, text: str | None = None) -> CheckedText:
        """Checked text of a request, or another ``text`` where one is given."""
        return self._check(
            Draft(
                text=request.text if text is None else text,
                name=request.name,
                profile_text=request.profile_text,
                profile_name=request.profile_name,
            )
        )


def format_text(draft: Draft) -> TextAnswer:
    """``POST /api/format``: a text in the house style; one with errors as it is."""
    return TextAnswer(text=format_rules(draft.text, draft.name))


def export(request: ExportRequest) -> TextAnswer:
    """A rule file of some statements."""
    return TextAnswer(text=exported(request))


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
