# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Copies of storage files that cannot be read where they are."""

from __future__ import annotations

import shutil
from contextlib import ExitStack
from pathlib import Path
from tempfile import gettempdir

from smarttestudo.bags import zstd_files
from smarttestudo.bags.bag_files import is_packed, require_bag_file
from smarttestudo.bags.unpacking import MAX_RATIO, TooLargeError
from smarttestudo.domain.errors import RecordingError
from smarttestudo.files.removal import temporary_folder

_COPIED_BYTES = 1 << 20


def readable_copy(path: Path, opened: ExitStack, notices: list[str]) -> tuple[Path, int | None]:
    """A copy of a file that is packed or remote, which goes with ``opened``, and how long the whole file was.

    Raises ``RecordingError`` for one that cannot be decompressed, and ``OSError``.
    """
    if is_packed(path):
        return _unpacked(path, opened, notices), zstd_files.unpacked_file_bytes(path)
    return _fetched(path, opened), None


def _fetched(path: Path, opened: ExitStack) -> Path:
    """A copy of a file that cannot be read by ranges, with the log beside it; it goes with ``opened``."""
    folder = opened.enter_context(temporary_folder(prefix="testudo-"))
    for one in (path, path.with_name(f"{path.name}-wal")):
        if one.is_file():
            with one.open("rb") as file, (folder / one.name).open("wb") as copy:
                shutil.copyfileobj(file, copy, _COPIED_BYTES)
    return folder / path.name


def _unpacked(path: Path, opened: ExitStack, notices: list[str]) -> Path:
    try:
        folder = opened.enter_context(temporary_folder(prefix="testudo-"))
        target = folder / path.with_suffix("").name
        is_whole = zstd_files.unpack(path, target)
    except OSError as error:
        cause = f"it cannot be decompressed into {gettempdir()}: {error.strerror}"
        remedy = "free some space there, or set TMPDIR to a folder that has more"
        raise RecordingError(cause, place=str(path), remedy=remedy) from error
    except TooLargeError as error:
        raise RecordingError(
            f"it is not decompressed: {error} and than {MAX_RATIO} times the file",
            place=str(path),
            remedy="unpack it with zstd -d if it is right",
        ) from error
    try:
        is_recording = require_bag_file(target) is not None
    except RecordingError:
        is_recording = False
    if not is_recording:
        cause = "its compressed content is no recording" if is_whole else "no part of it can be decompressed"
        raise RecordingError(cause, place=str(path))
    if not is_whole:
        notices.append(f"{path}: its compressed data are truncated or damaged; read as far as possible")
    return target
