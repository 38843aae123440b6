# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Zstandard, by file and by message."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import zstandard

HEADER_BYTES = 18
"""The longest header of a frame (RFC 8878, 3.1.1)."""
_READ_BYTES = 1 << 20


def unpack(source: Path, target: Path) -> bool:
    """Decompress ``source`` into ``target`` as far as it goes; false if it is cut off or damaged."""
    with source.open("rb") as packed, target.open("wb") as unpacked:
        return _copy(packed, unpacked)


def unpacked_file_bytes(path: Path) -> int | None:
    """How long the file packed in ``path`` is, ``None`` where its beginning does not say it."""
    with path.open("rb") as packed:
        return unpacked_bytes(packed.read(HEADER_BYTES))


def unpack_message(packed: bytes) -> bytes | None:
    """The payload in ``packed``, ``None`` where it is cut off or damaged."""
    frame = zstandard.ZstdDecompressor().decompressobj()
    try:
        payload = frame.decompress(packed)
    except (zstandard.ZstdError, MemoryError):
        return None
    return payload if frame.eof else None


def unpacked_bytes(head: bytes) -> int | None:
    """The size of the payload whose packed form begins with ``head``, ``None`` where that does not say it."""
    try:
        size_bytes = zstandard.frame_content_size(head)
    except zstandard.ZstdError:
        return None
    return size_bytes if size_bytes >= 0 else None


def _copy(packed: BinaryIO, unpacked: BinaryIO) -> bool:
    frame = zstandard.ZstdDecompressor().decompressobj()
    try:
        for data in _blocks(packed):
            remaining = data
            while remaining:
                if frame.eof:
                    frame = zstandard.ZstdDecompressor().decompressobj()
                unpacked.write(frame.decompress(remaining))
                remaining = frame.unused_data if frame.eof else b""
    except zstandard.ZstdError:
        return False
    return frame.eof


def _blocks(file: BinaryIO) -> Iterator[bytes]:
    while data := file.read(_READ_BYTES):
        yield data
