# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Drafts: what was changed in a file and not saved, kept in the project for whoever opens it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection
from contextlib import suppress
from itertools import islice

from msgspec import Struct

from smarttestudo.domain.errors import TestudoError
from smarttestudo.ruler.files.project_folder import (
    MAX_FILES,
    MAX_TEXT_BYTES,
    ChangedFileError,
    FileKind,
    ProjectFolder,
)
from smarttestudo.ruler.files.side_files import SideFiles
from smarttestudo.ruler.files.versions import VersionStore
from smarttestudo.ruler.job import job

DRAFTS_FOLDER = ".testudo/drafts"


class Unsaved(Struct, frozen=True, kw_only=True):
    """Content of an editor that is not saved.

    ``content`` is the text of a rule file, or the table of a profile as JSON; ``beside`` is what the editor
    keeps with it. ``base_hash`` is the SHA-256 of the file that was changed, null where there was none.
    """

    content: str
    beside: str
    base_hash: str | None


class FileDraft(Unsaved, frozen=True, kw_only=True):
    """A draft; its ``id``, which a page chose, is another after each change. Times count since 1970."""

    id: str
    changed_at_ms: int


class DraftAnswer(Struct, frozen=True, kw_only=True):
    """The draft of a file, null where all is saved."""

    draft: FileDraft | None


class DraftRequest(Struct, frozen=True, kw_only=True):
    """The draft of the file ``name``, called ``id``; null where it has none any more.

    ``root_hash`` is of the project that the page shows: behind one address may be another by now.
    ``known_ids`` are the drafts that the page knows, which this one takes the place of. ``discarded`` is a
    content that somebody gave up, null for none: of rules a version of it is kept.
    """

    name: str
    root_hash: str
    id: str
    known_ids: tuple[str, ...]
    draft: Unsaved | None
    discarded: str | None = None


class DraftedFile(Struct, frozen=True, kw_only=True):
    """A file with a draft; it need not be there. Times count since 1970."""

    name: str
    changed_at_ms: int


class DraftsAnswer(Struct, frozen=True, kw_only=True):
    """The files with drafts, by name."""

    drafts: tuple[DraftedFile, ...]


class DraftStore:
    """The draft of each rule file and profile of ``folder``; ``now_s`` is the time in seconds since 1970."""

    def __init__(self, folder: ProjectFolder, now_s: Callable[[], float] = time.time) -> None:
        self._files = SideFiles(folder, DRAFTS_FOLDER, FileDraft, "the draft")
        self._now_s = now_s
        self._writing = threading.Lock()

    def read(self, name: str) -> FileDraft | None:
        """The draft of the file ``name``; ``ForbiddenPathError`` for a file that has none."""
        return self._files.read(name)

    def keep(self, name: str, draft: Unsaved, draft_id: str, known_ids: Collection[str]) -> None:
        """Keep ``draft`` in the place of one of ``known_ids``; ``ChangedFileError`` where another is kept.

        Raises ``TestudoError`` for one that is too large, ``OutputFileError`` where it cannot be written.
        """
        if len(draft.content.encode()) + len(draft.beside.encode()) > MAX_TEXT_BYTES:
            raise TestudoError("the draft is larger than 1 MB", place=name, remedy="split the file")
        with self._writing:
            self.require_known(name, known_ids)
            now_ms = int(self._now_s() * 1000)
            kept = FileDraft(
                id=draft_id,
                content=draft.content,
                beside=draft.beside,
                base_hash=draft.base_hash,
                changed_at_ms=now_ms,
            )
            self._files.write(name, kept)

    def require_known(self, name: str, known_ids: Collection[str]) -> None:
        """Raise ``ChangedFileError`` where the file ``name`` has a draft that is none of ``known_ids``."""
        kept = self.read(name)
        if kept is not None and kept.id not in known_ids:
            remedy = "look at what differs, then keep one of the two"
            raise ChangedFileError("somebody else has changed the file", place=name, remedy=remedy)

    def drop(self, name: str, known_ids: Collection[str]) -> None:
        """Remove the draft of ``name`` where it is one of ``known_ids``; another one stays."""
        with self._writing:
            kept = self.read(name)
            if kept is not None and kept.id in known_ids:
                self._files.remove(name)

    def drafted(self) -> list[DraftedFile]:
        """The files with drafts, at most as many as a project lists."""
        records = islice(self._files.records(), MAX_FILES)
        return [DraftedFile(name=name, changed_at_ms=one.changed_at_ms) for name, one in records]


@job("GET /api/draft")
def draft(name: str, drafts: DraftStore) -> DraftAnswer:
    """The draft of a file."""
    return DraftAnswer(draft=drafts.read(name))


@job("PUT /api/draft")
def keep_draft(
    request: DraftRequest, folder: ProjectFolder, drafts: DraftStore, versions: VersionStore
) -> DraftAnswer:
    """Keep what is not saved of a file, which itself stays as it is; or drop that."""
    name = request.name
    if request.root_hash != folder.path_hash:
        raise ChangedFileError("this is another project now", place=name, remedy="load the page again")
    if request.discarded is not None and folder.kind(name) is FileKind.RULES:
        versions.keep(name, request.discarded)
    if request.draft is None:
        drafts.drop(name, request.known_ids)
    else:
        drafts.keep(name, request.draft, request.id, request.known_ids)
    return DraftAnswer(draft=drafts.read(name))


@job("GET /api/drafts")
def all_drafts(drafts: DraftStore) -> DraftsAnswer:
    """All files with drafts."""
    with suppress(OSError):
        return DraftsAnswer(drafts=tuple(drafts.drafted()))
    return DraftsAnswer(drafts=())
