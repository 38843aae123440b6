# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks about rules: their statements, edits, formatting, and rules that come and go."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

from smarttestudo.adirf.document import Document, deleted, inserted, moved, read_document, replaced
from smarttestudo.adirf.formatter import format_rules
from smarttestudo.adirf.parser import parse
from smarttestudo.composition.ruler.checked_text import CheckedText, Draft, check_sound, check_text, fixed
from smarttestudo.composition.ruler.difference import differences
from smarttestudo.composition.ruler.importing import encounters, imported
from smarttestudo.composition.ruler.sharing import download_text, exported
from smarttestudo.composition.ruler.zones import part_for_zone
from smarttestudo.web import schemas as schema
from smarttestudo.web import sharing_schemas as sharing
from smarttestudo.web.document_json import document_model
from smarttestudo.web.statement_json import new_statement
from smarttestudo.web.statement_schemas import DocumentModel
from smarttestudo.web.zone_schemas import MoveZone, NewZone, ResizeZone, ZonesAnswer
from smarttestudo.web.zones_json import zone_edited, zones_answer

_TEXTS_KEPT = 4


class RulesApi:
    """Texts are read and checked once, however often the page asks about the last few."""

    def __init__(self) -> None:
        self._check: Callable[[Draft], CheckedText] = lru_cache(maxsize=_TEXTS_KEPT)(check_text)

    def document(self, request: schema.DocumentRequest) -> DocumentModel:
        """Statements and findings of a text."""
        return document_model(self._check(_draft(request)))

    def zones(self, request: schema.DocumentRequest) -> ZonesAnswer:
        """The zones of a text."""
        return zones_answer(self._check(_draft(request)))

    def edit(self, request: schema.EditRequest) -> schema.EditAnswer:
        """A text with one statement edited."""
        before = self._check(_draft(request)).document
        text = _edited(before, request.edit)
        return self._answer(request, text, _edited_number(before, request.edit))

    def fix(self, request: schema.FixRequest) -> schema.EditAnswer:
        """A text with one finding's fix."""
        text = fixed(self._check(_draft(request)), request.index)
        return self._answer(request, text, None)

    def import_rules(self, request: sharing.ImportRequest) -> schema.EditAnswer:
        """A text with statements of another one."""
        before = self._check(_draft(request)).document
        other = read_document(request.other_text, "the imported file")
        text = imported(before, other, request.ids, request.replace_ids)
        return self._answer(request, text, None)

    def _answer(
        self,
        request: schema.EditRequest | schema.FixRequest | sharing.ImportRequest,
        text: str,
        number: int | None,
    ) -> schema.EditAnswer:
        checked = self._check(_draft(request, text))
        entries = checked.document.entries
        return schema.EditAnswer(
            text=text,
            document=document_model(checked),
            id=entries[number].id if number is not None and number < len(entries) else None,
        )


def format_text(request: schema.DocumentRequest) -> schema.TextAnswer:
    """A text in the house style; one with errors as it is."""
    return schema.TextAnswer(text=format_rules(request.text, request.name))


def download(request: schema.DocumentRequest) -> schema.TextAnswer:
    """The rule file with numbers."""
    return schema.TextAnswer(text=download_text(_draft(request)))


def export(request: sharing.ExportRequest) -> schema.TextAnswer:
    """A rule file of some statements."""
    return schema.TextAnswer(text=exported(read_document(request.text, request.name), request.ids))


def import_preview(request: sharing.ImportPreviewRequest) -> sharing.ImportPreview:
    """What another text could bring into a text."""
    other = check_sound(request.other_text, request.other_name)
    met = encounters(read_document(request.text, request.name), other.document)
    return sharing.ImportPreview(
        document=document_model(other),
        encounters=tuple(
            sharing.EncounterModel(id=one.id, is_same=one.is_same, message=one.message) for one in met
        ),
    )


def difference(request: schema.DifferenceRequest) -> schema.DifferenceAnswer:
    """What differs between two texts, in words."""
    old, new = parse(request.old_text, "before"), parse(request.new_text, "after")
    return schema.DifferenceAnswer(changes=differences(old, new))


def _draft(
    request: schema.DocumentRequest | schema.FixRequest | schema.EditRequest | sharing.ImportRequest,
    text: str | None = None,
) -> Draft:
    """What the request is about, with another ``text`` where one is given."""
    return Draft(
        text=request.text if text is None else text,
        name=request.name,
        profile_text=request.profile_text,
        profile_name=request.profile_name,
    )


def _edited(before: Document, change: schema.AnyEdit) -> str:
    match change:
        case schema.Replace():
            return replaced(before, change.id, new_statement(change.statement))
        case schema.Insert():
            return inserted(before, change.collection, change.index, new_statement(change.statement))
        case schema.Delete():
            return deleted(before, change.id)
        case schema.Move():
            return moved(before, change.id, change.collection, change.index)
        case NewZone() | MoveZone() | ResizeZone():
            return zone_edited(before, change)


def _edited_number(before: Document, change: schema.AnyEdit) -> int | None:
    """Which statement of the new text was edited, counted from 0."""
    ids = [entry.id for entry in before.entries]
    match change:
        case schema.Replace() | MoveZone() | ResizeZone():
            return ids.index(change.id)
        case NewZone():
            if change.into is not None:
                return ids.index(change.into)
            part = part_for_zone(before)
            return _number_at(before, part.id, len(part.entries), without=None)
        case schema.Delete():
            return None
        case schema.Insert():
            return _number_at(before, change.collection, change.index, without=None)
        case schema.Move():
            return _number_at(before, change.collection, change.index, without=change.id)


def _number_at(before: Document, collection: str, index: int, *, without: str | None) -> int:
    number = 0
    for part in before.parts:
        if part.id == collection:
            break
        number += sum(entry.id != without for entry in part.entries)
    return number + index
