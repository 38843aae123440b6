# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Records that the Ruler keeps of files of the project, hidden in it: one in JSON for each."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Generic, TypeVar

import msgspec

from smarttestudo.domain.errors import TestudoError
from smarttestudo.files.input_file import read_input, require_file
from smarttestudo.files.removal import remove
from smarttestudo.files.whole_file import not_written, whole_binary_file
from smarttestudo.ruler.files.project_folder import FileKind, ForbiddenPathError, ProjectFolder

_SUFFIX = ".json"
_MAX_BYTES = 3_000_000
"""More than a request can bring."""
_EDITED = frozenset((FileKind.RULES, FileKind.PROFILE))
_Record = TypeVar("_Record", bound=msgspec.Struct)


class SideFiles(Generic[_Record]):
    """Records of ``kind`` of rule files and profiles, below the hidden folder ``place`` of the project.

    ``content`` names what a record is.
    """

    def __init__(self, folder: ProjectFolder, place: str, kind: type[_Record], content: str) -> None:
        self._folder = folder
        self._place = place
        self._kind = kind
        self._content = content

    def read(self, name: str) -> _Record | None:
        """The record of the file ``name``; ``None`` where there is none, or none that can be read."""
        path = self._path(name)
        with suppress(OSError, msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
            require_file(path)
            return msgspec.json.decode(read_input(path, _MAX_BYTES), type=self._kind)
        return None

    def write(self, name: str, record: _Record) -> None:
        """Keep ``record`` of the file ``name``; ``OutputFileError`` where it cannot be written."""
        path = self._path(name)
        try:
            self._folder.make_unshared(self._place)
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise not_written(path, self._content, error) from error
        with whole_binary_file(path, self._content) as write:
            write(msgspec.json.encode(record))

    def remove(self, name: str) -> None:
        """Remove the record of the file ``name``, if there is one; ``OutputFileError`` where it cannot."""
        path = self._path(name)
        try:
            remove(path.parent, [path.name])
        except (FileNotFoundError, NotADirectoryError):
            return
        except OSError as error:
            raise not_written(path, self._content, error) from error

    def records(self) -> Iterator[tuple[str, _Record]]:
        """The records with the names of their files, which need not be there; links are not followed."""
        root = self._folder.path(self._place)
        for path in sorted(root.rglob(f"*{_SUFFIX}")):
            name = path.relative_to(root).as_posix().removesuffix(_SUFFIX)
            with suppress(TestudoError):
                record = self.read(name)
                if record is not None:
                    yield name, record

    def _path(self, name: str) -> Path:
        """Where the record of ``name`` is; ``ForbiddenPathError`` where it can have none."""
        self._folder.path(name)
        if self._folder.kind(name) not in _EDITED:
            remedy = "rule files end in .adirf, profiles in .toml"
            raise ForbiddenPathError(f"{self._content} of such a file is not kept", place=name, remedy=remedy)
        return self._folder.path(f"{self._place}/{name}{_SUFFIX}")
