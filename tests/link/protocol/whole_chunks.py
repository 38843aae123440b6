# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages that travel in one chunk each, as no robot's end sent them."""

from __future__ import annotations

from smarttestudo.link.protocol.chunks import Chunk


class WholeChunks:
    """Chunks of one session, each of which follows on the one before."""

    def __init__(self, *, is_kept: bool) -> None:
        self._is_kept = is_kept
        self._sent_bytes = 0

    def of(self, stream: int, data: bytes, number: int = 0, *, is_compressed: bool = False) -> bytes:
        """A whole message in a chunk."""
        chunk = Chunk(
            session=1,
            session_offset=self._sent_bytes,
            stream=stream,
            number=number,
            offset=0,
            size_bytes=len(data),
            offered_ns=0,
            sent_ns=0,
            is_compressed=is_compressed,
            is_kept=self._is_kept,
            body=data,
        ).to_bytes()
        self._sent_bytes += len(chunk)
        return chunk
