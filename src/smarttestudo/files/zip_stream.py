# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Files as one .zip, piece by piece, so that none is in memory as a whole."""

from __future__ import annotations

import io
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING
from zipfile import ZIP_STORED, ZipFile, ZipInfo

if TYPE_CHECKING:
    from typing_extensions import Buffer

_PIECE_BYTES = 1 << 18


def zip_pieces(files: Iterable[Path], folder: str) -> Iterator[bytes]:
    """The bytes of a .zip that holds ``files``, which are no links, in ``folder``.

    Raises ``OSError`` where one cannot be read: the archive is not complete then.
    """
    sink = _Pieces()
    with ZipFile(sink, "w", ZIP_STORED) as archive:
        for path in files:
            info = ZipInfo.from_file(path, f"{folder}/{path.name}", strict_timestamps=False)
            with open(path, "rb", opener=_no_link) as source, archive.open(info, "w") as target:
                while piece := source.read(_PIECE_BYTES):
                    target.write(piece)
                    yield sink.taken()
    yield sink.taken()


def _no_link(name: str, flags: int) -> int:
    return os.open(name, flags | os.O_NOFOLLOW | os.O_NONBLOCK)


class _Pieces(io.RawIOBase):
    """Keeps what is written until somebody takes it."""

    def __init__(self) -> None:
        self._kept = bytearray()

    def writable(self) -> bool:
        return True

    def write(self, data: Buffer) -> int:
        before = len(self._kept)
        self._kept += memoryview(data)
        return len(self._kept) - before

    def taken(self) -> bytes:
        """Bytes written since the last call."""
        kept, self._kept = bytes(self._kept), bytearray()
        return kept
