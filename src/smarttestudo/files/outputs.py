# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Outputs of commands: what they may not overwrite, and what is said where they cannot be written."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterable, Mapping
from pathlib import Path

from smarttestudo.domain.errors import RecordingError, UsageError
from smarttestudo.files.whole_file import not_written

_METADATA = "metadata.yaml"
_METADATA_ROOT = b"rosbag2_bagfile_information"
_HEAD_BYTES = 4096
_SQLITE_FULL = "database or disk is full"
_LOG_SUFFIXES = ("-wal", "-shm", "-journal")


def require_separate(
    outputs: Mapping[str, Path | Iterable[Path] | None], inputs: Iterable[Path | None] = ()
) -> None:
    """Refuse an output that would take the place of an input or of another output, or lie in a recording.

    ``outputs`` are files and folders by the option that names them; ``None`` stands for one that is not
    asked for. Links are followed. Nothing may lie in a folder among ``inputs``.

    Raises ``UsageError`` for the first that does.
    """
    # What is behind a URL is no file here.
    read = [path for path in inputs if isinstance(path, Path)]
    written: list[tuple[str, Path]] = []
    for option, paths in outputs.items():
        for path in () if paths is None else (paths,) if isinstance(paths, Path) else paths:
            _require_unread(option, path, read)
            for folder in Path(os.path.realpath(path)).parents:
                if _is_recording(folder):
                    raise _refused(option, path, f"lies in the recording {folder}")
            for other, before in written:
                if _is_same(path, before):
                    raise _refused(option, path, f"is also written by {other}")
            written.append((option, path))


def _require_unread(option: str, path: Path, inputs: Iterable[Path]) -> None:
    for one in inputs:
        if _is_same(path, one):
            raise _refused(option, path, "is read by this command")
        if any(_is_same(path, one.with_name(one.name + suffix)) for suffix in _LOG_SUFFIXES if one.name):
            raise _refused(option, path, f"belongs to {one}, which is read by this command")
        if one.is_dir() and Path(os.path.realpath(one)) in Path(os.path.realpath(path)).parents:
            raise _refused(option, path, f"lies in {one}, which is read by this command")


def _is_same(a: Path, b: Path) -> bool:
    """Whether both are one file or folder, by whatever name; a device or pipe loses nothing."""
    try:
        found = a.stat()
        if not (stat.S_ISREG(found.st_mode) or stat.S_ISDIR(found.st_mode)):
            return False
        return os.path.samestat(found, b.stat())
    except OSError:
        return os.path.realpath(a) == os.path.realpath(b)


def _is_recording(folder: Path) -> bool:
    path = folder / _METADATA
    try:
        if not path.is_file():
            return False
        with path.open("rb") as file:
            return _METADATA_ROOT in file.read(_HEAD_BYTES)
    except OSError:
        return False


def _refused(option: str, path: Path, cause: str) -> UsageError:
    return UsageError(f"{path} {cause}", place=option, remedy="name another output")


def make_folder(path: Path) -> None:
    """Make the folder ``path`` where there is none. Raises ``OutputFileError`` where it cannot be made."""
    try:
        path.mkdir(exist_ok=True)
    except OSError as error:
        raise not_written(path, "the folder", error) from error


def require_new(path: Path) -> None:
    """Raise ``RecordingError`` where there is something at ``path``."""
    if path.exists() or path.is_symlink():
        raise RecordingError("exists already", place=str(path), remedy="remove it or name another output")


def write_error(path: Path, error: Exception) -> RecordingError:
    """``error``, raised while writing a recording at ``path``, as one line."""
    if isinstance(error, OSError):
        is_full, cause = error.errno in (errno.ENOSPC, errno.EDQUOT), error.strerror or str(error)
    else:
        is_full, cause = _SQLITE_FULL in str(error), str(error)
    if is_full:
        remedy = "free some space or write to another disk"
        return RecordingError("the disk is full", place=str(path), remedy=remedy)
    return RecordingError(f"cannot be written: {cause}", place=str(path))
