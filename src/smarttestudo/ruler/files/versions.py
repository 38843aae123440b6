# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Versions of rule files: kept in the project, and what changed in each."""

from __future__ import annotations

import os
import re
import threading
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from pathlib import Path

from msgspec import Struct

from smarttestudo.domain.errors import TestudoError
from smarttestudo.editing.difference import differences
from smarttestudo.files.input_file import read_input, require_file
from smarttestudo.files.removal import remove
from smarttestudo.files.whole_file import not_written, whole_file
from smarttestudo.language.parser import ParseResult, parse
from smarttestudo.ruler.files.project_folder import (
    MAX_TEXT_BYTES,
    FileKind,
    ForbiddenPathError,
    MissingFileError,
    ProjectFolder,
)
from smarttestudo.ruler.job import TextAnswer, job

VERSIONS_FOLDER = ".testudo/versions"
MAX_VERSIONS = 20
_ID = re.compile(r"(\d{8}T\d{9})Z(?:-auto)?\Z", re.ASCII)
"""Those that an older page saved without being asked end in ``-auto``."""
_STAMP = "%Y%m%dT%H%M%S"
_SUFFIX = ".adirf"
_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)


@dataclass(frozen=True, slots=True, kw_only=True)
class KeptVersion:
    """A version by its id."""

    id: str
    saved_at_ms: int
    size_bytes: int


class VersionStore:
    """The last 20 versions of each rule file of ``folder``, a file each.

    ``now_s`` is the time in seconds since 1970.
    """

    def __init__(self, folder: ProjectFolder, now_s: Callable[[], float] = time.time) -> None:
        self._folder = folder
        self._now_s = now_s
        self._writing = threading.Lock()

    def versions(self, name: str) -> list[KeptVersion]:
        """Versions of the rule file ``name``, the newest first; ``ForbiddenPathError`` for other files."""
        try:
            entries = list(os.scandir(self._place(name)))
        except (FileNotFoundError, NotADirectoryError):
            return []
        except OSError as error:
            cause = f"the versions cannot be read: {error.strerror}"
            raise TestudoError(
                cause, place=name, remedy=f"check the permissions of {VERSIONS_FOLDER}"
            ) from error
        return sorted(_kept(entries), key=lambda one: one.id, reverse=True)

    def text(self, name: str, version_id: str) -> str:
        """The text of one version; ``MissingFileError`` where it is not kept."""
        if not _ID.fullmatch(version_id):
            raise ForbiddenPathError("this is not the id of a version", place=version_id[:80])
        self._place(name)
        path = self._folder.path(f"{VERSIONS_FOLDER}/{name}/{version_id}{_SUFFIX}")
        try:
            require_file(path)
            return read_input(path, MAX_TEXT_BYTES).decode("utf-8")
        except (FileNotFoundError, NotADirectoryError) as error:
            raise MissingFileError("this version is no longer kept", place=name) from error
        except (OSError, UnicodeDecodeError) as error:
            raise TestudoError("this version cannot be read", place=f"{name} {version_id}") from error

    def keep(self, name: str, text: str, saved_at_ms: int | None = None) -> None:
        """Keep ``text``, which was saved now where nothing else is said, unless it is the newest already.

        The oldest beyond 20 are removed. Raises ``OutputFileError`` where it cannot be written.
        """
        place = self._place(name)
        saved_at_ms = int(self._now_s() * 1000) if saved_at_ms is None else saved_at_ms
        with self._writing:
            known = self.versions(name)
            newest = known[0] if known else None
            if newest is not None and self.text(name, newest.id) == text:
                return
            # A clock that was set back does not make it older than what it follows.
            stamp_ms = saved_at_ms if newest is None else max(saved_at_ms, newest.saved_at_ms + 1)
            self._prepare(place)
            with whole_file(place / f"{_stamp(stamp_ms)}{_SUFFIX}", "the version", must_be_new=True) as write:
                write(text)
            for one in known[MAX_VERSIONS - 1 :]:
                # What cannot be removed now is removed after the next save.
                with suppress(OSError, TestudoError):
                    remove(place, [f"{one.id}{_SUFFIX}"])

    def move(self, name: str, new_name: str) -> None:
        """Keep the versions of the rule file ``name`` as those of ``new_name``, beside what that has.

        Raises ``OutputFileError`` where they cannot be moved.
        """
        old, new = self._place(name), self._place(new_name)
        with self._writing:
            kept = self.versions(name)
            if not kept:
                return
            self._prepare(new)
            try:
                for one in kept:
                    (old / f"{one.id}{_SUFFIX}").rename(new / f"{one.id}{_SUFFIX}")
            except OSError as error:
                raise not_written(new, "the versions", error) from error
            # A folder of versions with something else in it stays.
            with suppress(OSError, TestudoError):
                remove(old, [], with_folder=True)

    def _place(self, name: str) -> Path:
        """The folder of the versions of ``name``; ``ForbiddenPathError`` outside the project."""
        if self._folder.kind(name) is not FileKind.RULES:
            remedy = "only rule files, which end in .adirf, have versions"
            raise ForbiddenPathError("no versions of this file are kept", place=name, remedy=remedy)
        self._folder.path(name)
        return self._folder.path(f"{VERSIONS_FOLDER}/{name}")

    def _prepare(self, place: Path) -> None:
        try:
            self._folder.make_unshared(VERSIONS_FOLDER)
            place.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise not_written(place, "the version", error) from error


def _kept(entries: Iterable[os.DirEntry[str]]) -> Iterable[KeptVersion]:
    for entry in entries:
        version_id = entry.name.removesuffix(_SUFFIX)
        match = _ID.fullmatch(version_id)
        # What went away meanwhile, or has the name of no moment, is no version.
        with suppress(OSError, ValueError):
            if match is not None and entry.is_file(follow_symlinks=False):
                yield KeptVersion(
                    id=version_id,
                    saved_at_ms=_milliseconds(match[1]),
                    size_bytes=entry.stat().st_size,
                )


def _stamp(milliseconds: int) -> str:
    moment = _EPOCH + timedelta(milliseconds=milliseconds)
    return f"{moment.strftime(_STAMP)}{milliseconds % 1000:03}Z"


def _milliseconds(stamp: str) -> int:
    moment = datetime.strptime(stamp[:-3], _STAMP).replace(tzinfo=timezone.utc)
    return (moment - _EPOCH) // timedelta(milliseconds=1) + int(stamp[-3:])


_COMPARED_BYTES = 1_000_000
"""So much text is read for one list, so that large files do not keep it waiting."""


class RuleVersion(Struct, frozen=True, kw_only=True):
    """One version; ``saved_at_ms`` counts since 1970.

    ``changes`` is what a robot does otherwise than with the version before: empty where only comments or
    layout differ, null where none is before it or it was not compared. ``parses`` is whether it is without
    errors of syntax, null where it was not read.
    """

    id: str
    saved_at_ms: int
    size_bytes: int
    changes: tuple[str, ...] | None
    parses: bool | None


class VersionsAnswer(Struct, frozen=True, kw_only=True):
    """Versions of a rule file, the newest first, at most ``most``, kept in ``folder`` of the project."""

    versions: tuple[RuleVersion, ...]
    most: int
    folder: str


class VersionRequest(Struct, frozen=True, kw_only=True):
    """One version of the rule file ``name``."""

    name: str
    id: str


class DifferenceRequest(Struct, frozen=True, kw_only=True):
    """Two texts of a rule file."""

    old_text: str
    new_text: str


class DifferenceAnswer(Struct, frozen=True, kw_only=True):
    """Differences for a robot with the new text, in sentences; which of the two has errors of syntax."""

    differences: tuple[str, ...]
    old_parses: bool
    new_parses: bool


@job("GET /api/versions")
def versions(name: str, store: VersionStore) -> VersionsAnswer:
    """The versions of one rule file, each with what changed in it."""
    kept = store.versions(name)
    parsed = [_parsed(store, name, one) for one in kept[: _readable(kept)]]
    parsed += [None] * (len(kept) + 1 - len(parsed))
    found = (_version(*each) for each in zip(kept, parsed, parsed[1:], strict=False))
    return VersionsAnswer(versions=tuple(found), most=MAX_VERSIONS, folder=VERSIONS_FOLDER)


def _parsed(store: VersionStore, name: str, one: KeptVersion) -> ParseResult | None:
    try:
        return parse(store.text(name, one.id), name)
    except TestudoError:
        # One that cannot be read, or went away meanwhile, is listed without words.
        return None


@job("POST /api/version", reads=True)
def version(request: VersionRequest, store: VersionStore) -> TextAnswer:
    """One version; ``MissingFileError`` where it is not kept."""
    return TextAnswer(text=store.text(request.name, request.id))


@job("POST /api/difference", reads=True)
def difference(request: DifferenceRequest) -> DifferenceAnswer:
    """Compare two texts as a robot follows them."""
    old, new = parse(request.old_text, "old"), parse(request.new_text, "new")
    return DifferenceAnswer(
        differences=differences(old, new), old_parses=old.is_valid, new_parses=new.is_valid
    )


def _readable(kept: list[KeptVersion]) -> int:
    """How many versions, the newest first, fit into what is read for one list."""
    total = 0
    for count, one in enumerate(kept):
        total += one.size_bytes
        if total > _COMPARED_BYTES:
            return count
    return len(kept)


def _version(one: KeptVersion, text: ParseResult | None, before: ParseResult | None) -> RuleVersion:
    return RuleVersion(
        id=one.id,
        saved_at_ms=one.saved_at_ms,
        size_bytes=one.size_bytes,
        changes=None if text is None or before is None else differences(before, text),
        parses=None if text is None else text.is_valid,
    )
