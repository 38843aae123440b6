# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rule files on disk."""

from __future__ import annotations

import codecs
import contextlib
import os
import shutil
import tempfile
from collections.abc import Iterable
from pathlib import Path

from smarttestudo.adirf.parser import MAX_FILE_BYTES
from smarttestudo.domain.errors import RuleFileError

SUFFIX = ".adirf"
_SAVE_AS_UTF_8 = "save it as UTF-8"


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
    if not path.exists():
        raise RuleFileError("there is no such file", place=str(path), remedy="check the path")
    if not path.is_dir():
        return [path]
    files = rule_files_in(path)
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


def read_rule_text(path: Path) -> str:
    """The text of the rule file at ``path``, without a byte order mark.

    Raises ``RuleFileError`` for a file that cannot be read, is larger than 1 MB or is not UTF-8.
    """
    try:
        with path.open("rb") as file:
            data = file.read(MAX_FILE_BYTES + 1)
    except IsADirectoryError as error:
        raise RuleFileError("this is a folder", place=str(path), remedy="give a rule file") from error
    except FileNotFoundError as error:
        raise RuleFileError("there is no such file", place=str(path), remedy="check the path") from error
    except OSError as error:
        cause = f"the rule file cannot be read: {error.strerror}"
        raise RuleFileError(cause, place=str(path), remedy="check its permissions") from error
    if len(data) > MAX_FILE_BYTES:
        remedy = "split it into several; is it a rule file?"
        raise RuleFileError("the rule file is larger than 1 MB", place=str(path), remedy=remedy)
    return _decoded(data, path)


def _decoded(data: bytes, path: Path) -> str:
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
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

    Raises ``RuleFileError`` where that is not possible; the file is then as it was.
    """
    target = path.resolve()
    try:
        handle, name = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
    except OSError as error:
        raise _not_written(path, error) from error
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(text.encode("utf-8"))
        _set_mode(Path(name), target)
        Path(name).replace(target)
    except OSError as error:
        with contextlib.suppress(OSError):
            Path(name).unlink()
        raise _not_written(path, error) from error


def _set_mode(file: Path, target: Path) -> None:
    """Give ``file`` the permissions of ``target``, or those of any new file where there is none yet."""
    if target.exists():
        shutil.copymode(target, file)
        return
    mask = os.umask(0)
    os.umask(mask)
    file.chmod(0o666 & ~mask)


def _not_written(path: Path, error: OSError) -> RuleFileError:
    cause = f"the rule file cannot be written: {error.strerror}"
    return RuleFileError(cause, place=str(path), remedy="check the permissions of its folder")
