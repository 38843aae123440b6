# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Removal from the disk, of what SmartTestudo wrote; no other module removes anything."""

from __future__ import annotations

import os
import shutil
import stat
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.texts import in_utf_8

_MOST_NAMED = 3


class ForeignFilesError(TestudoError):
    """Something that SmartTestudo did not write is where something would be removed."""


def remove(folder: Path, names: Iterable[str], *, with_folder: bool = False) -> None:
    """Remove the files ``names`` of ``folder``, in their order, and ``with_folder`` the folder after them.

    What is gone already is no error. Links are not followed, and are no files.

    Raises:
        ForeignFilesError: one of ``names`` is not a file, or a folder that was to go is a link or holds
            something else, too. Nothing was removed.
        OSError: something cannot be removed.
    """
    ours = list(names)
    if with_folder and (folder.is_symlink() or folder.name in {"", ".."}):
        raise ForeignFilesError("is a link or has no name", place=str(folder), remedy="name the folder")
    flags = os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC
    opened = os.open(folder, flags | os.O_NOFOLLOW if with_folder else flags)
    try:
        foreign = [name for name in ours if not _is_file_or_gone(name, opened)]
        if with_folder:
            with os.scandir(opened) as entries:
                foreign += sorted({entry.name for entry in entries}.difference(ours))
        if foreign:
            raise _foreign_files(folder, foreign)
        for name in ours:
            with suppress(FileNotFoundError):
                os.unlink(name, dir_fd=opened)
    finally:
        os.close(opened)
    if with_folder:
        folder.rmdir()


@contextmanager
def temporary_folder(folder: Path | None = None, *, prefix: str = ".", suffix: str = "") -> Iterator[Path]:
    """A new folder in ``folder`` that goes when the block ends, with all that is in it then.

    Without ``folder`` it is where the system has temporary files. Links in it are not followed.
    """
    path = Path(tempfile.mkdtemp(prefix=prefix, suffix=suffix, dir=folder))
    try:
        yield path
    finally:
        shutil.rmtree(path, ignore_errors=True)


def _is_file_or_gone(name: str, folder: int) -> bool:
    if name in {"", ".", ".."} or "/" in name:
        return False
    try:
        return stat.S_ISREG(os.stat(name, dir_fd=folder, follow_symlinks=False).st_mode)
    except FileNotFoundError:
        return True


def _foreign_files(folder: Path, names: list[str]) -> ForeignFilesError:
    more = f" and {len(names) - _MOST_NAMED} more" if len(names) > _MOST_NAMED else ""
    named = ", ".join(map(in_utf_8, names[:_MOST_NAMED]))
    return ForeignFilesError(
        f"holds something else, too: {named}{more}", place=str(folder), remedy="move that elsewhere first"
    )
