# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Files as input, of which none is waited for."""

from __future__ import annotations

import hashlib
import os
import stat
from pathlib import Path

_PIECE_BYTES = 1 << 20


def read_input(path: Path, most_bytes: int | None = None) -> bytes:
    """The bytes of the file at ``path``, at most the first ``most_bytes``.

    A pipe is read until its writer closes it. Raises ``OSError`` for what cannot be read, and
    for a pipe without a writer.
    """
    data = bytearray()
    # Path.open takes no opener.
    with open(path, "rb", buffering=0, opener=_without_waiting) as file:
        is_pipe = stat.S_ISFIFO(os.fstat(file.fileno()).st_mode)
        piece = file.read(_size(data, most_bytes))
        if piece == b"" and is_pipe:
            raise OSError(None, "it is a pipe without a writer")
        os.set_blocking(file.fileno(), True)
        # From a pipe that is open and still empty comes None.
        while piece is None or piece:
            data += piece or b""
            piece = file.read(_size(data, most_bytes))
    return bytes(data)


def sha256_of_files(*paths: Path) -> str:
    """The SHA-256 of files of any size, one after the other, in hexadecimal. Raises ``OSError``."""
    digest = hashlib.sha256()
    for path in paths:
        with path.open("rb") as file:
            while piece := file.read(_PIECE_BYTES):
                digest.update(piece)
    return digest.hexdigest()


def require_file(path: Path) -> None:
    """Raise ``OSError`` unless there is a file at ``path`` that can be read without waiting."""
    mode = path.stat().st_mode
    if not stat.S_ISREG(mode):
        cause = "it is a folder" if stat.S_ISDIR(mode) else "it is a device or a pipe, not a file"
        raise OSError(None, cause)


def _without_waiting(name: str, flags: int) -> int:
    return os.open(name, flags | os.O_NONBLOCK)


def _size(data: bytearray, most_bytes: int | None) -> int:
    return _PIECE_BYTES if most_bytes is None else min(_PIECE_BYTES, most_bytes - len(data))
