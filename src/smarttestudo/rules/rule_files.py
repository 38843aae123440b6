# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rule files on disk, and whether they changed."""

from __future__ import annotations

import codecs
import errno
import hashlib
import os
import stat
import sys
from collections.abc import Iterable
from contextlib import suppress
from difflib import get_close_matches
from pathlib import Path
from typing import NamedTuple, TextIO, cast

from smarttestudo.domain.errors import RuleFileError, TestudoError
from smarttestudo.files.input_file import read_input
from smarttestudo.files.whole_file import whole_binary_file, whole_file
from smarttestudo.language.parser import MAX_FILE_BYTES


def sha256_of(path: Path) -> str:
    """The SHA-256 of the file at ``path`` in hexadecimal; ``TestudoError`` where it cannot be read."""
    try:
        return hashlib.sha256(read_input(path)).hexdigest()
    except OSError as error:
        cause = f"the file cannot be read: {error.strerror}"
        raise TestudoError(cause, place=str(path), remedy="check the path and its permissions") from error


SUFFIX = ".adirf"
STANDARD_INPUT = Path("<stdin>")
"""This very object stands for what comes on standard input, and any path that equals it for a file."""
_SAVE_AS_UTF_8 = "save it as UTF-8"
_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def find_rule_files(paths: Iterable[Path]) -> list[Path]:
    """The files among ``paths``, and the ``*.adirf`` files directly in the folders among them, each once.

    Raises ``RuleFileError`` for a path that does not exist and for a folder without rule files.
    """
    found: dict[Path, Path] = {}
    for path in paths:
        for file in _files_at(path):
            found.setdefault(file.resolve(), file)
    return list(found.values())


def _files_at(path: Path) -> list[Path]:
    if path is STANDARD_INPUT:
        return [path]
    try:
        is_folder = stat.S_ISDIR(path.stat().st_mode)
    except OSError as error:
        raise _not_read(path, error) from error
    if not is_folder:
        return [path]
    files = rule_files_in(path)
    if not files and not os.access(path, os.R_OK | os.X_OK):
        raise _not_read(path, PermissionError(errno.EACCES, os.strerror(errno.EACCES)))
    if not files:
        remedy = f"give a file, or a folder with *{SUFFIX} files"
        raise RuleFileError("the folder holds no rule files", place=str(path), remedy=remedy)
    return files


def rule_files_in(folder: Path) -> list[Path]:
    """The rule files directly in ``folder``, sorted; none where it is no folder or cannot be listed."""
    try:
        return sorted(file for file in folder.glob(f"*{SUFFIX}") if file.is_file())
    except OSError:
        return []


def rule_files_named(paths: Iterable[Path]) -> list[Path]:
    """The files that ``paths`` name, there or not, and the rule files in folders among them."""
    return [file for path in paths for file in (rule_files_in(path) if os.path.isdir(path) else (path,))]  # noqa: PTH112 - Path.is_dir raises where it may not look


def read_rule_text(path: Path) -> str:
    """The text of the rule file at ``path``, without a byte order mark.

    Raises ``RuleFileError`` for a file that cannot be read, is larger than 4 MB or is not UTF-8.
    """
    try:
        data = _standard_input() if path is STANDARD_INPUT else read_input(path, MAX_FILE_BYTES + 1)
    except IsADirectoryError as error:
        raise RuleFileError("this is a folder", place=str(path), remedy="give a rule file") from error
    except OSError as error:
        raise _not_read(path, error) from error
    if len(data) > MAX_FILE_BYTES:
        remedy = "split it into several; is it a rule file?"
        raise RuleFileError("the rule file is larger than 4 MB", place=str(path), remedy=remedy)
    return _decoded(data, path)


def readable_texts(paths: Iterable[Path]) -> dict[str, str]:
    """The texts of the rule files that ``paths`` name, by path, as far as they can be read."""
    texts: dict[str, str] = {}
    for path in rule_files_named(paths):
        with suppress(OSError):
            data = read_input(path, MAX_FILE_BYTES + 1)
            encoding = "utf-16" if data.startswith(_UTF_16) else "utf-8-sig"
            texts[str(path)] = data.decode(encoding, "replace")
    return texts


def refuse_missing(paths: Iterable[Path]) -> None:
    """Raise ``RuleFileError`` for the first of ``paths`` where nothing is."""
    for path in paths:
        if is_missing(path):
            raise _not_read(path, FileNotFoundError())


def _standard_input() -> bytes:
    stream = cast("TextIO | None", sys.stdin)
    if stream is None:
        raise OSError(None, "it is closed")
    return stream.buffer.read(MAX_FILE_BYTES + 1)


def _not_read(path: Path, error: OSError) -> RuleFileError:
    if isinstance(error, FileNotFoundError):
        cause = "there is no such file"
        if near := _near(path):
            return RuleFileError(cause, place=str(path), remedy=f"did you mean {' or '.join(near)}?")
        return RuleFileError(cause, place=str(path), remedy="check the path")
    remedy = "check its permissions" if isinstance(error, PermissionError) else "give a rule file"
    return RuleFileError(f"the rule file cannot be read: {error.strerror}", place=str(path), remedy=remedy)


def _near(path: Path) -> list[str]:
    """Names like that of the first part of ``path`` that is not there: rule files, and folders."""
    while is_missing(path.parent) and path.parent != path:
        path = path.parent
    try:
        names = [
            path.with_name(entry.name)
            for entry in os.scandir(path.parent)
            if entry.is_dir() or (entry.name.endswith(SUFFIX) and entry.is_file())
        ]
    except OSError:
        return []
    near = get_close_matches(path.stem.casefold(), {name.stem.casefold() for name in names})
    return [str(name) for stem in near for name in names if name.stem.casefold() == stem]


def _decoded(data: bytes, path: Path) -> str:
    if data.startswith(_UTF_16):
        raise RuleFileError("the rule file is in UTF-16", place=str(path), remedy=_SAVE_AS_UTF_8)
    if b"\0" in data:
        cause = "the rule file holds zero bytes, as UTF-16 and binary files do"
        raise RuleFileError(cause, place=str(path), remedy=_SAVE_AS_UTF_8)
    text = data.removeprefix(codecs.BOM_UTF8)
    try:
        return text.decode()
    except UnicodeDecodeError as error:
        before = text[: error.start].decode()
        line = before.count("\n") + 1
        column = len(before) - before.rfind("\n")
        cause = f"the byte 0x{text[error.start]:02X} is not UTF-8"
        raise RuleFileError(cause, place=f"{path}:{line}:{column}", remedy=_SAVE_AS_UTF_8) from error


def write_rule_text(path: Path, text: str) -> None:
    """Write or replace the rule file at ``path`` in one step, its permissions kept; a link stays a link.

    Raises ``OutputFileError`` where that is not possible; the file is then as it was.
    """
    with whole_file(path, "the rule file") as write:
        write(text)


PREVIOUS_SUFFIX = ".previous"


def is_missing(path: Path) -> bool:
    """Whether nothing is at ``path``, be it that its folder is not there."""
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return True
    except OSError:
        return False
    return False


def replace_rule_text(path: Path, text: str, loaded: str | None) -> None:
    """Replace the rule file at ``path`` in one step; what it held stays beside it, as ``PREVIOUS_SUFFIX``.

    Raises ``RuleFileError`` unless the file holds ``loaded``, or is not there where that is ``None``, and
    ``OutputFileError`` where it cannot be written; the file is then as it was.
    """
    if (None if is_missing(path) else read_rule_text(path)) != loaded:
        raise RuleFileError(
            "the rule file changed since it was loaded",
            place=str(path),
            remedy="nothing was written; look at what changed there",
        )
    if loaded is not None:
        before = path.with_name(f"{path.name}{PREVIOUS_SUFFIX}")
        with whole_binary_file(before, "the previous rules") as write:
            write(read_input(path, MAX_FILE_BYTES + 1))
    write_rule_text(path, text)


FileStates = tuple[tuple[str, "FileState | None"], ...]


class FileState(NamedTuple):
    """Metadata of a file that tells one content of it from the next."""

    size_bytes: int
    device: int
    inode: int
    modified_ns: int
    changed_ns: int


def file_states(paths: Iterable[Path]) -> FileStates:
    """State that changes when any of the files at ``paths`` does, or a rule file in a folder among them.

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
