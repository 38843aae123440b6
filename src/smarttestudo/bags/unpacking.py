# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Compressed content, unpacked no further than is declared or ever done: KB may unpack to GB."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import BinaryIO, Protocol

import zstandard

from smarttestudo.domain.units import grouped

Buffer = bytes | memoryview
MAX_UNPACKED_BYTES = 1_000_000_000
"""A message or a chunk is not unpacked if it is longer; a file may be that long whatever its ratio is."""
MAX_RATIO = 1000
"""A file longer than that is at most so many times as long as its packed form."""
# Of Zstandard, so many bytes become 128 MB at most.
_PIECE_BYTES = 1 << 12


class TooLargeError(ValueError):
    """Content is longer than it declares, or than is ever unpacked."""


class Decompressor(Protocol):
    """Decompressor of one frame."""

    @property
    def eof(self) -> bool:
        """Whether the frame is whole."""

    @property
    def unused_data(self) -> bytes | None:
        """The bytes that arrived behind it."""

    def decompress(self, data: Buffer, /) -> bytes:
        """Content that more bytes of the frame unpack to."""


def unpack_file(
    packed: BinaryIO, unpacked: BinaryIO, begin: Callable[[], Decompressor], most_bytes: int
) -> bool:
    """Unpack all frames, one after the other, each by one that ``begin`` makes: whether the last is whole.

    Raises ``TooLargeError`` beyond ``most_bytes``, and what the decompressor raises on damage.
    """
    return _unpack(iter(lambda: packed.read(_PIECE_BYTES), b""), unpacked, begin, most_bytes)


def _unpack(
    pieces: Iterable[Buffer], unpacked: BinaryIO, begin: Callable[[], Decompressor], most_bytes: int
) -> bool:
    frame = begin()
    unpacked_bytes = 0
    for read in pieces:
        data = read
        while data:
            if frame.eof:
                frame = begin()
            piece = frame.decompress(data)
            unpacked_bytes += len(piece)
            require_at_most(most_bytes, unpacked_bytes)
            unpacked.write(piece)
            data = (frame.unused_data or b"") if frame.eof else b""
    return frame.eof


def unpacked_content(
    packed: Buffer, begin: Callable[[], Decompressor], declared_bytes: int
) -> tuple[bytes, bool]:
    """The content as far as it goes, and whether its last frame is whole.

    Raises as ``unpack_file``, and for a length that is never unpacked.
    """
    require_at_most(MAX_UNPACKED_BYTES, declared_bytes)
    content = io.BytesIO()
    view = memoryview(packed)
    pieces = (view[at : at + _PIECE_BYTES] for at in range(0, len(view), _PIECE_BYTES))
    is_whole = _unpack(pieces, content, begin, declared_bytes)
    return content.getvalue(), is_whole


def require_at_most(most_bytes: int, content_bytes: int | None) -> None:
    """Raise ``TooLargeError`` for content that is longer, or declares to be."""
    if content_bytes is not None and content_bytes > most_bytes:
        raise TooLargeError(f"its content is longer than {grouped(most_bytes)} bytes")


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
