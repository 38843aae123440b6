# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whether files changed, without reading them."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from smarttestudo.adapters.files.rule_files import rule_files_in

FileStates = tuple[tuple[str, "FileState | None"], ...]


class FileState(NamedTuple):
    """What tells one content of a file from the next."""

    size_bytes: int
    device: int
    inode: int
    modified_ns: int
    changed_ns: int


def file_states(paths: Iterable[Path]) -> FileStates:
    """What changes when any of the files at ``paths`` does, or a rule file in a folder among them.

    The times of change count, too, which no program can set, so that an editor may keep times or write a new
    file under the old name.
    """
    return tuple((str(file), _state(file)) for path in paths for file in (path, *rule_files_in(path)))


def total_bytes(states: FileStates) -> int:
    """The size of all files that are there."""
    return sum(state.size_bytes for _, state in states if state is not None)


def _state(path: Path) -> FileState | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return FileState(found.st_size, found.st_dev, found.st_ino, found.st_mtime_ns, found.st_ctime_ns)
