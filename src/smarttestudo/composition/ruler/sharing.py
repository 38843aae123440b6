# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules that leave an editor; what has errors does not."""

from __future__ import annotations

from collections.abc import Collection

from smarttestudo.adirf.document import Document, EditError, Entry
from smarttestudo.adirf.formatter import first_line_end
from smarttestudo.composition.optimize_tiers import has_tiers
from smarttestudo.composition.ruler.checked_text import Draft, require_sound, require_usable
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
    """A rule file of the statements ``ids``, as they are written, in their order.

    Raises ``RefusedTextError`` where these have errors; errors of the others do not matter.
    """
    entries = chosen(document, ids)
    line_end = first_line_end(document.text)
    body = (line_end + line_end).join(text_of(entry) for entry in entries)
    text = line_end.join(["begin", body, "end", ""])
    require_sound(text, document.result.file.path)
    return text


def chosen(document: Document, ids: Collection[str]) -> list[Entry]:
    """The statements ``ids`` in their order; ``EditError`` where there are none or fewer."""
    wanted = set(ids)
    found = [entry for entry in document.entries if entry.id in wanted]
    if not found or len(found) < len(wanted):
        raise EditError("the text has no such statements", remedy="read the document again")
    return found


def text_of(entry: Entry) -> str:
    """The lines of a statement with its comments."""
    words = entry.stretch
    return (words.indent or "    ") + words.text[words.own_start : words.own_end]
