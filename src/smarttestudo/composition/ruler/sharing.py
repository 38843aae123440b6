# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules that leave an editor or come into it."""

from __future__ import annotations

from collections.abc import Collection

from smarttestudo.adirf.document import (
    Document,
    EditError,
    Entry,
    NewStatement,
    inserted,
    read_document,
)
from smarttestudo.adirf.formatter import first_line_end
from smarttestudo.composition.optimize_tiers import has_tiers
from smarttestudo.composition.ruler.checked_text import Draft, require_usable
from smarttestudo.composition.ruler.optimizing import optimize_draft
from smarttestudo.domain.errors import RuleFileError
from smarttestudo.optimizer.model import Model


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
            first.message, place=first.solved.part.place, remedy="; ".join(first.remedies) or None
        )
    return outcome.rewritten


def exported(document: Document, ids: Collection[str]) -> str:
    """A rule file of the statements ``ids``, as they are written, in their order."""
    chosen = _chosen(document, ids)
    line_end = first_line_end(document.text)
    body = (line_end + line_end).join(_text_of(entry) for entry in chosen)
    return line_end.join(["begin", body, "end", ""])


def imported(document: Document, other: Document, ids: Collection[str] | None) -> str:
    """The text of ``document`` with statements of ``other`` at its end; ``ids`` ``None`` means all."""
    chosen = list(other.entries) if ids is None else _chosen(other, ids)
    text = document.text
    path = document.result.file.path
    for entry in chosen:
        target = read_document(text, path)
        part = next((one for one in reversed(target.parts) if one.begin is not None), None)
        if part is None:
            raise EditError("the text has no 'begin … end' to import into", remedy="write one first")
        new = NewStatement(content=entry.statement or _text_of(entry).lstrip())
        text = inserted(target, part.id, len(part.entries), new)
    return text


def _chosen(document: Document, ids: Collection[str]) -> list[Entry]:
    chosen = [entry for entry in document.entries if entry.id in set(ids)]
    if not chosen or len(chosen) < len(set(ids)):
        raise EditError("the text has no such statements", remedy="read the document again")
    return chosen


def _text_of(entry: Entry) -> str:
    """The lines of a statement with its comments."""
    words = entry.stretch
    return (words.indent or "    ") + words.text[words.own_start : words.own_end]
