# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The files of the project that the page has open, and the project's settings."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from importlib.util import find_spec

from msgspec import Struct

from smarttestudo import __version__
from smarttestudo.domain.errors import TestudoError
from smarttestudo.files.input_file import read_input
from smarttestudo.files.whole_file import not_written, whole_file
from smarttestudo.ruler.files.drafts import DraftStore
from smarttestudo.ruler.files.project_folder import (
    ChangedFileError,
    FileKind,
    FileText,
    ForbiddenPathError,
    FoundFile,
    MissingFileError,
    ProjectFolder,
    layout_name,
)
from smarttestudo.ruler.files.versions import VersionStore
from smarttestudo.ruler.job import job

SETTINGS_FILE = ".testudo/settings.json"
_MAX_BYTES = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class ProjectSettings:
    """``profiles`` names the profile that somebody chose for a rule file, empty for none."""

    profiles: Mapping[str, str] = field(default_factory=dict)


class SettingsFile:
    """The settings of ``folder``; changes of one process are made one after the other."""

    def __init__(self, folder: ProjectFolder) -> None:
        self._folder = folder
        self._changing = threading.Lock()

    def read(self) -> ProjectSettings:
        """The settings; the usual ones where there are none, or none that can be read."""
        with suppress(OSError, ValueError, RecursionError):
            found = json.loads(read_input(self._folder.path(SETTINGS_FILE), _MAX_BYTES))
            if isinstance(found, dict):
                return ProjectSettings(profiles=_names(found.get("profiles")))
        return ProjectSettings()

    def set_profile(self, rules: str, profile: str) -> None:
        """Write that ``rules`` go with ``profile``, empty for none.

        Raises ``OutputFileError`` where it cannot. What was chosen for rule files that are gone is forgotten.
        """

        def chosen(settings: ProjectSettings) -> ProjectSettings:
            kept = {name: each for name, each in settings.profiles.items() if self._is_there(name)}
            return replace(settings, profiles={**kept, rules: profile})

        self._change(chosen)

    def follow(self, name: str, new_name: str) -> None:
        """Write that what was called ``name`` is called ``new_name``; ``OutputFileError`` as above."""

        def renamed(one: str) -> str:
            return new_name if one == name else one

        def followed(settings: ProjectSettings) -> ProjectSettings:
            chosen = {renamed(rules): renamed(profile) for rules, profile in settings.profiles.items()}
            return replace(settings, profiles=chosen)

        self._change(followed)

    def _change(self, changed: Callable[[ProjectSettings], ProjectSettings]) -> None:
        with self._changing:
            before = self.read()
            after = changed(before)
            if after != before:
                self._write(after)

    def _write(self, settings: ProjectSettings) -> None:
        path = self._folder.path(SETTINGS_FILE)
        try:
            path.parent.mkdir(exist_ok=True)
        except OSError as error:
            raise not_written(path, "the settings of the project", error) from error
        with whole_file(path, "the settings of the project") as write:
            write(f"{json.dumps(asdict(settings), indent=1)}\n")

    def _is_there(self, name: str) -> bool:
        with suppress(OSError, ValueError, TestudoError):
            return self._folder.path(name).is_file()
        return False


def _names(found: object) -> dict[str, str]:
    """The part of ``found`` that pairs names with names."""
    pairs = found.items() if isinstance(found, dict) else ()
    return {key: each for key, each in pairs if isinstance(key, str) and isinstance(each, str)}


class Project(Struct, frozen=True, kw_only=True):
    """The project; ``opened`` is the file that the command line named, if any.

    A bag is named by its folder, or by its file where it has no metadata. ``ros`` is whether the server can
    reach ROS 2; ``version`` is that of SmartTestudo. ``root_hash`` tells folders of one name apart.
    """

    root_name: str
    root_hash: str
    opened: str | None
    files: tuple[FoundFile, ...]
    version: str
    ros: bool
    has_more: bool


class FileAnswer(Struct, frozen=True, kw_only=True):
    """The text of a file with its SHA-256, which a later PUT names."""

    name: str
    text: str
    hash: str


class FileOnDisk(Struct, frozen=True, kw_only=True):
    """The SHA-256 of what is on disk, null where nothing is."""

    hash: str | None


class SaveRequest(Struct, frozen=True, kw_only=True):
    """A text to be saved; ``base_hash`` is what the editor read; null where the file must not exist yet.

    ``draft_ids`` are the drafts of the file that the editor knows: the text takes their place, too.
    """

    name: str
    text: str
    base_hash: str | None = None
    draft_ids: tuple[str, ...] = ()


class SaveAnswer(Struct, frozen=True, kw_only=True):
    """The SHA-256 of what is on disk now; ``note`` is why no version of it is kept, empty if one is."""

    hash: str
    note: str


class RenameRequest(Struct, frozen=True, kw_only=True):
    """A file with another name; ``base_hash`` is what the page knows to be in ``name``."""

    name: str
    new_name: str
    base_hash: str


class CopyRequest(Struct, frozen=True, kw_only=True):
    """A file to be copied; ``new_name`` must not exist yet."""

    name: str
    new_name: str


class DeleteRequest(Struct, frozen=True, kw_only=True):
    """A file to be removed; ``base_hash`` is what the page keeps for its *Undo*."""

    name: str
    base_hash: str


@dataclass(frozen=True, slots=True, kw_only=True)
class _Source:
    """A file that is renamed or copied, with its map where it has one."""

    kind: FileKind
    text: str
    layout: FileText | None


@job("GET /api/project")
def project(folder: ProjectFolder) -> Project:
    """The project with its files."""
    files, has_more = folder.files()
    return Project(
        root_name=folder.name,
        root_hash=folder.path_hash,
        opened=folder.opened,
        files=tuple(files),
        version=__version__,
        ros=find_spec("rclpy") is not None,
        has_more=has_more,
    )


@job("GET /api/file")
def read_file(name: str, folder: ProjectFolder) -> FileAnswer:
    found = folder.read(name)
    return FileAnswer(name=name, text=found.text, hash=found.sha256)


@job("GET /api/file/state")
def file_state(name: str, folder: ProjectFolder) -> FileOnDisk:
    """Hash that tells whether a file that is open was changed by somebody else."""
    try:
        return FileOnDisk(hash=folder.read(name).sha256)
    except MissingFileError:
        return FileOnDisk(hash=None)


@job("PUT /api/file")
def save(
    request: SaveRequest, folder: ProjectFolder, drafts: DraftStore, versions: VersionStore
) -> SaveAnswer:
    """Write one text file, which has no draft then; of rules, what was and what is there become versions."""
    name = request.name
    kind = folder.kind(name)
    is_rules, has_draft = kind is FileKind.RULES, kind in (FileKind.RULES, FileKind.PROFILE)
    if has_draft:
        drafts.require_known(name, request.draft_ids)
    before = _before(request, folder) if is_rules else None
    sha256 = folder.write(name, request.text, request.base_hash)
    if has_draft:
        # A page drops once more what stays.
        with suppress(TestudoError):
            drafts.drop(name, request.draft_ids)
    try:
        if before is not None:
            versions.keep(name, before.text, before.changed_at_ms)
        if is_rules:
            versions.keep(name, request.text)
    except TestudoError as error:
        # The file itself is saved, and that must be said.
        return SaveAnswer(hash=sha256, note=error.cause)
    return SaveAnswer(hash=sha256, note="")


@job("POST /api/file/rename")
def rename(
    request: RenameRequest, folder: ProjectFolder, settings: SettingsFile, versions: VersionStore
) -> Project:
    """Call a rule file or a profile otherwise; its map, its versions and its profile go with it."""
    name, new_name = request.name, request.new_name
    source = _source(folder, name, new_name)
    _move(folder, source.text, name, new_name, request.base_hash)
    if source.layout is not None:
        with suppress(MissingFileError, ChangedFileError):
            layout = source.layout
            _move(folder, layout.text, layout_name(name), layout_name(new_name), layout.sha256)
    if source.kind is FileKind.RULES:
        versions.move(name, new_name)
    settings.follow(name, new_name)
    return project(folder)


@job("POST /api/file/copy")
def copy(
    request: CopyRequest, folder: ProjectFolder, settings: SettingsFile, versions: VersionStore
) -> Project:
    """Write a rule file or a profile under another name as well, with its map and its profile."""
    name, new_name = request.name, request.new_name
    source = _source(folder, name, new_name)
    folder.write(new_name, source.text, None)
    if source.layout is not None:
        with suppress(ChangedFileError):
            folder.write(layout_name(new_name), source.layout.text, None)
    if source.kind is FileKind.RULES:
        versions.keep(new_name, source.text)
        profile = settings.read().profiles.get(name)
        if profile is not None:
            settings.set_profile(new_name, profile)
    return project(folder)


@job("POST /api/file/delete")
def delete(request: DeleteRequest, folder: ProjectFolder, versions: VersionStore) -> Project:
    """Remove a rule file, of which a version is kept, or a profile."""
    name = request.name
    if folder.kind(name) is FileKind.RULES:
        found = folder.read(name)
        versions.keep(name, found.text, found.changed_at_ms)
    folder.remove(name, request.base_hash)
    return project(folder)


def _source(folder: ProjectFolder, name: str, new_name: str) -> _Source:
    """Content of the file ``name``; ``ForbiddenPathError`` where ``new_name`` could not have it."""
    kind = folder.kind(name)
    if folder.kind(new_name) is not kind:
        remedy = "rule files end in .adirf, profiles in .toml"
        raise ForbiddenPathError("a file keeps its kind", place=new_name, remedy=remedy)
    folder.path(new_name)
    layout = _layout(folder, name, new_name)
    return _Source(kind=kind, text=folder.read(name).text, layout=layout)


def _layout(folder: ProjectFolder, name: str, new_name: str) -> FileText | None:
    """The map of ``name``, if it has one; ``ForbiddenPathError`` where ``new_name`` could not have it."""
    try:
        found = folder.read(layout_name(name))
    except (MissingFileError, ForbiddenPathError):
        # The name of a map is longer, and may be too long.
        return None
    try:
        folder.path(layout_name(new_name))
    except ForbiddenPathError as error:
        cause = "the name is too long for the map of the rules"
        raise ForbiddenPathError(cause, place=new_name, remedy="choose a shorter name") from error
    return found


def _move(folder: ProjectFolder, text: str, name: str, new_name: str, base_sha256: str) -> None:
    written_sha256 = folder.write(new_name, text, None)
    try:
        folder.remove(name, base_sha256)
    except TestudoError:
        # Whoever is refused finds what was there before.
        folder.remove(new_name, written_sha256)
        raise


def _before(request: SaveRequest, folder: ProjectFolder) -> FileText | None:
    """Text that a save replaces, which another program may have written; ``None`` where nothing is."""
    if request.base_hash is None:
        return None
    try:
        return folder.read(request.name)
    except TestudoError:
        # The save itself says what is wrong with it.
        return None
