# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Versions of rule files, and what a robot does otherwise with one than with another."""

from __future__ import annotations

from msgspec import Struct

from smarttestudo.domain.errors import TestudoError
from smarttestudo.editing.difference import differences
from smarttestudo.language.parser import ParseResult, parse
from smarttestudo.ruler.files.version_store import (
    MAX_VERSIONS,
    VERSIONS_FOLDER,
    KeptVersion,
    VersionStore,
)
from smarttestudo.ruler.job import job
from smarttestudo.ruler.rules.edits import TextAnswer

_COMPARED_BYTES = 1_000_000
"""So much text is read for one list, so that large files do not keep it waiting."""


class RuleVersion(Struct, frozen=True, kw_only=True):
    """One version; ``saved_at_ms`` counts since 1970, ``by_itself`` is whether nobody asked the page to save.

    ``changes`` is what a robot does otherwise than with the version before: empty where only comments or
    layout differ, null where none is before it or it was not compared. ``parses`` is whether it is without
    errors of syntax, null where it was not read.
    """

    id: str
    saved_at_ms: int
    by_itself: bool
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
        by_itself=one.by_itself,
        size_bytes=one.size_bytes,
        changes=None if text is None or before is None else differences(before, text),
        parses=None if text is None else text.is_valid,
    )
