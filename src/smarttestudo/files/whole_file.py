# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Files that are there whole or not at all."""

from __future__ import annotations

import errno
import os
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from smarttestudo.domain.errors import TestudoError
from smarttestudo.files.removal import remove

PARTIAL_SUFFIX = ".partial"
"""How the name of what is not whole ends; it begins with a point."""
_FULL = (errno.ENOSPC, errno.EDQUOT)
_FORBIDDEN = (errno.EACCES, errno.EPERM, errno.EROFS)
_IN_THE_WAY = (errno.EEXIST, errno.ENOTDIR)
# What is added to it must fit into the 255 bytes of a name, too.
_NAME_CHARACTERS = 40


class OutputFileError(TestudoError):
    """A file that cannot be written."""


@contextmanager
def whole_file(path: Path, content: str, *, must_be_new: bool = False) -> Iterator[Callable[[str], None]]:
    """Write a text file whole: the block is given a function that appends text; see ``whole_binary_file``.

    What UTF-8 cannot say, such as the bytes of a strange file name, becomes a ``?``.
    """
    with whole_binary_file(path, content, must_be_new=must_be_new) as write:
        yield lambda text: write(text.encode("utf-8", "replace"))


@contextmanager
def whole_binary_file(
    path: Path, content: str, *, must_be_new: bool = False
) -> Iterator[Callable[[bytes], None]]:
    """Write a file whole: the block is given a function that appends bytes.

    The file takes the place of ``path`` once the block ends well. Permissions of a file that is replaced
    stay, and a link stays a link. A device or pipe is written to at once. ``content`` names what the file
    holds. Raises ``OutputFileError`` where it cannot be written, before the block if that is known by then.
    """
    with _errors_at(path, content):
        file, workshop, target = _opened(path, must_be_new=must_be_new)

    def write(data: bytes) -> None:
        with _errors_at(path, content):
            file.write(data)
            # A full disk is reported before other outputs are in place.
            file.flush()

    try:
        try:
            yield write
        finally:
            # What could not be written was said when it failed.
            with suppress(OSError):
                file.close()
        if workshop is not None:
            with _errors_at(path, content):
                _require_new(path, must_be_new=must_be_new)
                _set_mode(workshop, target)
                workshop.replace(target)
    finally:
        if workshop is not None:
            with suppress(OSError, TestudoError):
                remove(workshop.parent, [workshop.name])


def not_written(path: Path, content: str, error: OSError) -> OutputFileError:
    """Why ``content`` is not at ``path``, and what helps."""
    cause, remedy = error.strerror or error, "name another place"
    if error.errno in _FULL:
        remedy = "free some space or write to another disk"
    elif error.errno in _FORBIDDEN:
        remedy = "check its permissions and those of its folder, or name another place"
    elif error.errno in _IN_THE_WAY:
        cause = "a file is there in place of a folder"
    return OutputFileError(f"{content} cannot be written: {cause}", place=str(path), remedy=remedy)


def _opened(path: Path, *, must_be_new: bool) -> tuple[BinaryIO, Path | None, Path]:
    """File to write into, its path until it is whole, and the path that it then replaces."""
    _require_new(path, must_be_new=must_be_new)
    mode = _mode(path)
    if mode is not None and stat.S_ISDIR(mode):
        raise IsADirectoryError(None, "it is a folder")
    if mode is not None and not stat.S_ISREG(mode):
        return path.open("wb"), None, path
    target = Path(os.path.realpath(path))
    handle, name = tempfile.mkstemp(
        prefix=f".{target.name[:_NAME_CHARACTERS]}-", suffix=PARTIAL_SUFFIX, dir=target.parent
    )
    return os.fdopen(handle, "wb"), Path(name), target


def _mode(path: Path) -> int | None:
    try:
        return path.stat().st_mode
    except FileNotFoundError:
        return None


def _require_new(path: Path, *, must_be_new: bool) -> None:
    if must_be_new and _mode(path) is not None:
        raise FileExistsError(None, "the file exists already")


def _set_mode(file: Path, target: Path) -> None:
    """Give ``file`` the permissions of ``target``, or those of any new file where there is none yet."""
    if target.exists():
        shutil.copymode(target, file)
        return
    # There is no way to ask for it without setting it.
    mask = os.umask(0)
    os.umask(mask)
    file.chmod(0o666 & ~mask)


@contextmanager
def _errors_at(path: Path, content: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise not_written(path, content, error) from error
