# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What page and server say to each other about rules that leave a file or come into it."""

from __future__ import annotations

from msgspec import Struct

from smarttestudo.web.statement_schemas import DocumentModel


class ExportRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/export`` → ``TextAnswer``: a rule file of the statements ``ids`` only.

    409 with findings where these statements have errors.
    """

    text: str
    ids: tuple[str, ...]
    name: str = "rules.adirf"


class ImportRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/import`` → ``EditAnswer``: ``text`` with statements of ``other_text``.

    ``ids`` are statements of ``other_text``; null means all of them. Those of ``replace_ids`` go into the
    place of the one of the same name, the others into the last collection.
    """

    text: str
    other_text: str
    ids: tuple[str, ...] | None = None
    replace_ids: tuple[str, ...] = ()
    name: str = "rules.adirf"
    profile_text: str | None = None
    profile_name: str = "profile.toml"


class ImportPreviewRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/import/preview`` → ``ImportPreview``: what ``other_text`` could bring."""

    text: str
    other_text: str
    name: str = "rules.adirf"
    other_name: str = "the imported file"


class EncounterModel(Struct, frozen=True, kw_only=True):
    """The statement ``id`` of the other file meets one that is here: the same, or one of the same name."""

    id: str
    is_same: bool
    message: str


class ImportPreview(Struct, frozen=True, kw_only=True):
    """The statements of the other file with what the checker says of it alone, and whom they meet here."""

    document: DocumentModel
    encounters: tuple[EncounterModel, ...]
