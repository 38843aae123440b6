# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The one folder that the Ruler reads and writes."""

from __future__ import annotations

import hashlib
import os
import re
import stat
import threading
import unicodedata
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from itertools import islice
from pathlib import Path, PurePosixPath

from smarttestudo.bags.metadata_text import METADATA_NAME
from smarttestudo.domain.errors import RecordingError, TestudoError
from smarttestudo.files.input_file import read_input, require_file
from smarttestudo.files.removal import remove
from smarttestudo.files.whole_file import OutputFileError
from smarttestudo.rules.rule_files import write_rule_text

_DRIVE = re.compile(r"[A-Za-z]:")
_UNSHOWN = frozenset({"Cc", "Cs", "Zl", "Zp"})
_SKIPPED = frozenset({"node_modules", "__pycache__", "build", "install", "log"})


def is_nameable(name: str) -> bool:
    """Whether a page may name a file or folder so: one line of text that means the same path everywhere.

    It has no control characters, which neither a page nor a log can show, and names no drive.
    """
    is_one_line = not any(unicodedata.category(one) in _UNSHOWN for one in name)
    return is_one_line and "\\" not in name and not _DRIVE.match(name)


def is_shown(name: str) -> bool:
    """Whether files of a folder of this name are shown."""
    return not name.startswith(".") and name not in _SKIPPED


MAX_TEXT_BYTES = 1_000_000
MAX_FILES = 2000
MAX_FOLDERS = 10_000
_MAX_DEPTH = 5
_LAYOUT = re.compile(r"\.[^/]+\.layout\.json\Z")
_BAG_SUFFIXES = frozenset({".db3", ".mcap"})
_ROS1_SUFFIX = ".bag"
"""Listed, so that whoever opens one is told what it is."""
_IMAGE_SUFFIXES = frozenset({".png", ".jpg", ".jpeg"})
MAX_IMAGES = 200


class FileKind(Enum):
    """Kind of a file to the Ruler; the value is its name in JSON."""

    RULES = "rules"
    PROFILE = "profile"
    BAG = "bag"
    MAP = "map"
    LAYOUT = "layout"
    IMAGE = "image"


_MISSION_SUFFIX = ".mission.toml"
_KINDS = {".adirf": FileKind.RULES, ".toml": FileKind.PROFILE, ".yaml": FileKind.MAP, ".yml": FileKind.MAP}
_WRITABLE = frozenset({FileKind.RULES, FileKind.PROFILE, FileKind.LAYOUT})


class ForbiddenPathError(TestudoError):
    """A name that leads out of the project folder, or to a file that is none of the Ruler's."""

    status = 403


class MissingFileError(TestudoError):
    """A name that no file of the project has."""

    status = 404


class ChangedFileError(TestudoError):
    """A file that was changed on disk since it was read."""

    status = 409


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundFile:
    """A file by its name in the project, with ``/`` between folders. A bag may be a folder.

    ``changed_at_s`` is when it was changed last, in seconds since 1970.
    """

    name: str
    kind: FileKind
    size_bytes: int
    changed_at_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FileText:
    """The text of a file, every byte of it, the SHA-256 of those, and when it was written (since 1970)."""

    text: str
    sha256: str
    changed_at_ms: int


class ProjectFolder:
    """Rule files, profiles, bags and maps below ``root``; ``opened`` is what the user named, if any."""

    def __init__(self, root: Path, opened: str | None = None) -> None:
        self.root = root.resolve()
        self.opened = opened
        self._writing = threading.Lock()

    @property
    def name(self) -> str:
        """The folder's own name."""
        return self.root.name or str(self.root)

    @property
    def path_hash(self) -> str:
        """A SHA-256 of where the folder is: it tells projects apart without saying where they are."""
        return _sha256(os.fsencode(self.root))

    def files(self) -> tuple[list[FoundFile], bool]:
        """Files that the Ruler can open, by name, and whether there are more than it lists."""
        known = (one for one in self._walk(self.root, _MAX_DEPTH) if one.kind is not FileKind.IMAGE)
        found = list(islice(known, MAX_FILES + 1))
        return found[:MAX_FILES], len(found) > MAX_FILES

    def folders_with(self, file_name: str) -> tuple[list[str], bool]:
        """The folders that hold something called ``file_name``, by name, and whether there are more."""
        found = list(islice(self._holders(self.root, file_name, _MAX_DEPTH), MAX_FOLDERS + 1))
        return found[:MAX_FOLDERS], len(found) > MAX_FOLDERS

    def images(self) -> list[FoundFile]:
        """The first 200 images, by name."""
        found = (one for one in self._walk(self.root, _MAX_DEPTH) if one.kind is FileKind.IMAGE)
        return list(islice(found, MAX_IMAGES))

    def path(self, name: str) -> Path:
        """The path of the file or folder ``name``, with links followed; ``ForbiddenPathError`` outside."""
        parts = PurePosixPath(name).parts
        is_plain = bool(parts) and all(map(is_nameable, parts))
        if not is_plain or name.startswith("/") or ".." in parts:
            raise ForbiddenPathError("this is not the name of a file in the project", place=name)
        path = _resolved(self.root.joinpath(*parts), name)
        if not path.is_relative_to(self.root):
            raise ForbiddenPathError("this leads out of the project folder", place=name)
        return path

    def make_unshared(self, name: str) -> None:
        """Make a folder whose content is of this machine, as what an editor keeps for undo, and not in git.

        Raises ``OSError``, and ``ForbiddenPathError`` outside.
        """
        self.path(name).mkdir(parents=True, exist_ok=True)
        unshared = self.path(f"{name}/.gitignore")
        if not unshared.exists():
            unshared.write_text("*\n", "utf-8")

    def bag(self, name: str) -> Path:
        """The path of the bag ``name``, of which no link leads out of the project."""
        from smarttestudo.bags.bag_files import find_bag_files  # noqa: PLC0415  --help works without packages

        path = self.path(name)
        mode = _mode(path)
        if mode is None:
            raise MissingFileError("there is no such recording in the project", place=name)
        is_folder = stat.S_ISDIR(mode)
        for one in _entries(path) if is_folder else ():
            self.require_inside(Path(one), name)
        with suppress(RecordingError):
            # Metadata may name files anywhere, and SQLite reads a log beside a file.
            for file in find_bag_files(path).paths if is_folder else (path,):
                self.require_inside(file, name)
                self.require_inside(file.with_name(f"{file.name}-wal"), name)
        return path

    def new_bag(self, name: str) -> Path:
        """The path of a bag that is to be written as the file ``name``; ``ForbiddenPathError`` for no bag."""
        path, last = self.path(name), PurePosixPath(name)
        if last.suffix not in _BAG_SUFFIXES or last.name.startswith("."):
            remedy = "drop its .mcap or .db3 file, or copy a folder into the project"
            raise ForbiddenPathError("this is not the file of a recording", place=name, remedy=remedy)
        if not path.parent.is_dir():
            raise MissingFileError(f"there is no folder {last.parent} in the project", place=name)
        return path

    def background(self, name: str, kind: FileKind) -> Path:
        """The path of the map or image ``name``."""
        path, suffix = self.path(name), PurePosixPath(name).suffix
        is_image = suffix.lower() in _IMAGE_SUFFIXES
        if not (is_image if kind is FileKind.IMAGE else _kind_of(name) is kind):
            remedy = "maps end in .yaml, images in .png or .jpg"
            raise ForbiddenPathError("this is not a map or an image", place=name, remedy=remedy)
        if not stat.S_ISREG(_mode(path) or 0):
            raise MissingFileError("there is no such file in the project", place=name)
        return path

    def require_inside(self, path: Path, place: str) -> None:
        """Refuse a file that ``place`` names outside the project, by ``ForbiddenPathError``."""
        if not _resolved(path, place).is_relative_to(self.root):
            raise ForbiddenPathError(
                "this names a file outside the project folder", place=place, remedy="copy it into the project"
            )

    def shown(self, path: str) -> str:
        """A path as the project calls it."""
        return path.removeprefix(f"{self.root}{os.sep}")

    def read(self, name: str) -> FileText:
        """The text of the rule file, profile, map description or layout ``name``."""
        self.kind(name)
        path = self.path(name)
        data = self._bytes(path, name)
        if len(data) > MAX_TEXT_BYTES:
            raise TestudoError("the file is larger than 1 MB", place=name, remedy="is it the right one?")
        try:
            text = data.decode("utf-8")
        except UnicodeDecodeError as error:
            raise TestudoError("the file is not UTF-8", place=name, remedy="save it as UTF-8") from error
        return FileText(text=text, sha256=_sha256(data), changed_at_ms=_changed_at_ms(path))

    def write(self, name: str, text: str, base_sha256: str | None) -> str:
        """Write ``text`` in one step; the SHA-256 of it.

        Raises ``ChangedFileError`` where the file is not the one that ``base_sha256`` was read of; ``None``
        means that there is none, and then the folder of its name is made, too.
        """
        path, data = self._writable(name), text.encode("utf-8")
        if len(data) > MAX_TEXT_BYTES:
            raise TestudoError(
                "the text is larger than 1 MB", place=name, remedy="split it into several files"
            )
        with self._writing:
            self._require_unchanged(path, name, base_sha256)
            if base_sha256 is None:
                _make_parent(path, name)
            try:
                write_rule_text(path, text)
            except OutputFileError as error:
                raise OutputFileError(error.cause, place=name, remedy=error.remedy) from error
        return _sha256(data)

    def remove(self, name: str, base_sha256: str) -> None:
        """Remove the text file ``name``, if it is still the one that ``base_sha256`` was read of.

        Raises ``ChangedFileError`` if it is not, and ``ForbiddenPathError`` for a link.
        """
        path = self._writable(name)
        if self.root.joinpath(*PurePosixPath(name).parts).is_symlink():
            raise ForbiddenPathError("this is a link", place=name, remedy="remove it where you made it")
        with self._writing:
            self._require_unchanged(path, name, base_sha256)
            try:
                remove(path.parent, [path.name])
            except OSError as error:
                cause = f"the file cannot be removed: {error.strerror}"
                raise TestudoError(cause, place=name, remedy="check its permissions") from error

    def _writable(self, name: str) -> Path:
        if self.kind(name) not in _WRITABLE:
            raise ForbiddenPathError("the Ruler does not write such files", place=name)
        return self.path(name)

    def _require_unchanged(self, path: Path, name: str, base_sha256: str | None) -> None:
        if self._current_sha256(path, name) == base_sha256:
            return
        if base_sha256 is None:
            cause = "the project has a file of this name"
            raise ChangedFileError(cause, place=name, remedy="choose another name")
        remedy = "read it again, or save under another name"
        raise ChangedFileError("the file has changed on disk", place=name, remedy=remedy)

    def _current_sha256(self, path: Path, name: str) -> str | None:
        try:
            return _sha256(self._bytes(path, name))
        except MissingFileError:
            return None

    def _bytes(self, path: Path, name: str) -> bytes:
        try:
            require_file(path)
            return read_input(path, MAX_TEXT_BYTES + 1)
        except (FileNotFoundError, NotADirectoryError) as error:
            raise MissingFileError("there is no such file in the project", place=name) from error
        except OSError as error:
            cause = f"the file cannot be read: {error.strerror}"
            raise TestudoError(cause, place=name, remedy="check its permissions") from error

    def kind(self, name: str) -> FileKind:
        """Kind of the file ``name``, by its name; ``ForbiddenPathError`` for what the Ruler does not edit."""
        last = PurePosixPath(name).name
        if _LAYOUT.fullmatch(last):
            return FileKind.LAYOUT
        kind = _kind_of(last)
        if kind is None or last.startswith("."):
            remedy = "rule files end in .adirf, profiles in .toml"
            raise ForbiddenPathError("the Ruler does not edit this kind of file", place=name, remedy=remedy)
        return kind

    def _holders(self, folder: Path, file_name: str, depth: int) -> Iterator[str]:
        for entry in _entries(folder):
            is_folder = is_nameable(entry.name) and is_shown(entry.name)
            with suppress(OSError):
                is_folder = is_folder and entry.is_dir(follow_symlinks=False)
            path = Path(entry.path)
            if is_folder and os.path.lexists(path / file_name):
                yield path.relative_to(self.root).as_posix()
            elif is_folder and depth > 0:
                yield from self._holders(path, file_name, depth - 1)

    def _walk(self, folder: Path, depth: int) -> Iterator[FoundFile]:
        for entry in _entries(folder):
            # Links in a circle, and what went away or was closed meanwhile, have nothing to offer either.
            with suppress(OSError, RuntimeError):
                yield from self._entry(entry, depth)

    def _entry(self, entry: os.DirEntry[str], depth: int) -> Iterator[FoundFile]:
        if not is_nameable(entry.name):
            return
        if entry.is_symlink() and not Path(entry.path).resolve().is_relative_to(self.root):
            return
        if entry.is_file():
            yield from self._file(entry)
        elif entry.is_dir(follow_symlinks=False) and is_shown(entry.name) and depth > 0:
            path = Path(entry.path)
            if (path / METADATA_NAME).is_file():
                yield self._found(path, FileKind.BAG, entry.stat(), _folder_bytes(path))
            else:
                yield from self._walk(path, depth - 1)

    def _file(self, entry: os.DirEntry[str]) -> Iterator[FoundFile]:
        path = Path(entry.path)
        kind = FileKind.LAYOUT if _LAYOUT.fullmatch(entry.name) else _kind_of(path.name)
        if path.suffix in {*_BAG_SUFFIXES, _ROS1_SUFFIX}:
            kind = FileKind.BAG
        if path.suffix.lower() in _IMAGE_SUFFIXES:
            kind = FileKind.IMAGE
        if kind is None or (entry.name.startswith(".") and kind is not FileKind.LAYOUT):
            return
        if kind is FileKind.MAP and not _describes_map(path):
            return
        found = entry.stat()
        yield self._found(path, kind, found, found.st_size)

    def _found(self, path: Path, kind: FileKind, found: os.stat_result, size_bytes: int) -> FoundFile:
        name = path.relative_to(self.root).as_posix()
        return FoundFile(name=name, kind=kind, size_bytes=size_bytes, changed_at_s=found.st_mtime)


def layout_name(name: str) -> str:
    """The file with the map of the rule file ``name``: of ``a/b.adirf`` it is ``a/.b.adirf.layout.json``."""
    path = PurePosixPath(name)
    return str(path.with_name(f".{path.name}.layout.json"))


def _entries(folder: Path) -> list[os.DirEntry[str]]:
    """Entries of a folder, by name; one that may not be listed has none."""
    try:
        return sorted(os.scandir(folder), key=lambda one: one.name)
    except OSError:
        return []


def _resolved(path: Path, name: str) -> Path:
    """``path`` with links followed; ``ForbiddenPathError`` where there can be no such file."""
    try:
        resolved = path.resolve()
        resolved.stat()
    except (FileNotFoundError, NotADirectoryError, PermissionError):
        return resolved
    except (OSError, RuntimeError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "its symbolic links form a loop"
        cause = f"this is not the name of a file in the project: {reason}"
        raise ForbiddenPathError(cause, place=name) from error
    return resolved


def _make_parent(path: Path, name: str) -> None:
    """Make the folder of a new file; ``ForbiddenPathError`` for one whose files would not be shown."""
    folders = PurePosixPath(name).parts[:-1]
    if len(folders) > _MAX_DEPTH or not all(is_shown(folder) for folder in folders):
        remedy = f"at most {_MAX_DEPTH} folders deep, and none that begins with a dot"
        raise ForbiddenPathError("the Ruler shows no files of such a folder", place=name, remedy=remedy)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        cause = f"the folder cannot be made: {error.strerror}"
        raise TestudoError(cause, place=name, remedy="choose another name") from error


def _mode(path: Path) -> int | None:
    try:
        return path.stat().st_mode
    except OSError:
        return None


def _changed_at_ms(path: Path) -> int:
    """When a file was written last; 0 where it went away meanwhile."""
    try:
        return path.stat().st_mtime_ns // 1_000_000
    except OSError:
        return 0


def _describes_map(path: Path) -> bool:
    """Whether a YAML file looks like that of a nav2 map."""
    try:
        with path.open("rb") as file:
            head = file.read(4096)
    except OSError:
        return False
    return b"image:" in head and b"resolution:" in head


def _folder_bytes(folder: Path) -> int:
    return sum(one.stat().st_size for one in folder.iterdir() if one.is_file())


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _kind_of(name: str) -> FileKind | None:
    """By the name's ending; a mission of the demonstration is no profile."""
    return None if name.endswith(_MISSION_SUFFIX) else _KINDS.get(PurePosixPath(name).suffix)
