# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks about rules: their statements, edits, formatting, and rules that come and go."""

from __future__ import annotations

from smarttestudo.adirf.document import Document, deleted, inserted, moved, read_document, replaced
from smarttestudo.adirf.formatter import format_rules
from smarttestudo.composition.ruler.checked_text import Draft, check_text, fixed
from smarttestudo.composition.ruler.sharing import download_text, exported, imported
from smarttestudo.web import schemas as schema
from smarttestudo.web.document_json import document_model
from smarttestudo.web.statement_json import new_statement
from smarttestudo.web.statement_schemas import DocumentModel


def document(request: schema.DocumentRequest) -> DocumentModel:
    """Statements and findings of a text."""
    return document_model(check_text(_draft(request)))


def edit(request: schema.EditRequest) -> schema.EditAnswer:
    """A text with one statement edited."""
    before = read_document(request.text, request.name)
    text = _edited(before, request.edit)
    return _answer(request, text, _edited_number(before, request.edit))


def format_text(request: schema.DocumentRequest) -> schema.TextAnswer:
    """A text in the house style; one with errors as it is."""
    return schema.TextAnswer(text=format_rules(request.text, request.name))


def fix(request: schema.FixRequest) -> schema.EditAnswer:
    """A text with one finding's fix."""
    return _answer(request, fixed(_draft(request), request.index), None)


def download(request: schema.DocumentRequest) -> schema.TextAnswer:
    """The rule file with numbers."""
    return schema.TextAnswer(text=download_text(_draft(request)))


def export(request: schema.ExportRequest) -> schema.TextAnswer:
    """A rule file of some statements."""
    return schema.TextAnswer(text=exported(read_document(request.text, request.name), request.ids))


def import_rules(request: schema.ImportRequest) -> schema.EditAnswer:
    """A text with statements of another one."""
    before = read_document(request.text, request.name)
    text = imported(before, read_document(request.other_text, "the imported file"), request.ids)
    return _answer(request, text, None)


def _draft(
    request: schema.DocumentRequest | schema.FixRequest | schema.EditRequest | schema.ImportRequest,
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


def _edited_number(before: Document, change: schema.AnyEdit) -> int | None:
    """Which statement of the new text was edited, counted from 0."""
    ids = [entry.id for entry in before.entries]
    match change:
        case schema.Replace():
            return ids.index(change.id)
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


def _answer(
    request: schema.EditRequest | schema.FixRequest | schema.ImportRequest, text: str, number: int | None
) -> schema.EditAnswer:
    checked = check_text(_draft(request, text))
    entries = checked.document.entries
    return schema.EditAnswer(
        text=text,
        document=document_model(checked),
        id=entries[number].id if number is not None and number < len(entries) else None,
    )
