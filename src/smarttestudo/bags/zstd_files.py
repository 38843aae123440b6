# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Zstandard, by file and by message."""

from __future__ import annotations

from pathlib import Path

import zstandard

from smarttestudo.bags.unpacking import (
    MAX_RATIO,
    MAX_UNPACKED_BYTES,
    Decompressor,
    TooLargeError,
    require_at_most,
    unpack_file,
    unpacked_content,
)

HEADER_BYTES = 18
"""The longest header of a frame (RFC 8878, 3.1.1)."""


def unpack(source: Path, target: Path) -> bool:
    """Decompress ``source`` into ``target`` as far as it goes; false if it is cut off or damaged.

    Raises ``TooLargeError`` where it would be implausibly long.
    """
    with source.open("rb") as packed, target.open("wb") as unpacked:
        most_bytes = max(MAX_UNPACKED_BYTES, MAX_RATIO * packed.seek(0, 2))
        packed.seek(0)
        require_at_most(most_bytes, unpacked_file_bytes(source))
        try:
            return unpack_file(packed, unpacked, begin_frame, most_bytes)
        except zstandard.ZstdError:
            return False


def unpacked_file_bytes(path: Path) -> int | None:
    """How long the file packed in ``path`` is, ``None`` where its beginning does not say it."""
    with path.open("rb") as packed:
        return unpacked_bytes(packed.read(HEADER_BYTES))


def unpack_message(packed: bytes) -> bytes | None:
    """The payload in ``packed``, ``None`` where it is cut off, damaged or too long."""
    try:
        require_at_most(MAX_UNPACKED_BYTES, unpacked_bytes(packed[:HEADER_BYTES]))
        payload, is_whole = unpacked_content(packed, begin_frame, MAX_UNPACKED_BYTES)
    except (zstandard.ZstdError, TooLargeError, MemoryError):
        return None
    return payload if is_whole else None


def begin_frame() -> Decompressor:
    """Decompressor of a frame."""
    return zstandard.ZstdDecompressor().decompressobj()


def unpacked_bytes(head: bytes) -> int | None:
    """The size of the payload whose packed form begins with ``head``, ``None`` where that does not say it."""
    try:
        size_bytes = zstandard.frame_content_size(head)
    except zstandard.ZstdError:
        return None
    return size_bytes if size_bytes >= 0 else None
