# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages made smaller for a link, where that pays."""

from __future__ import annotations

import zstandard

from smarttestudo.domain.errors import LinkError
from smarttestudo.link.protocol.outgoing_stream import Encoded
from smarttestudo.link.protocol.wire import COMPRESSED, HEAD_BYTES, other_version

MAX_SENT_BYTES = 900_000
"""How large what travels may be: no end takes a message of more than a megabyte at once."""

_LEVEL = 3
_LEVEL_ALONE = 10
"""For what travels seldom."""
_LEAST_BYTES = 200
_WORTHWHILE = 0.9
"""The share of its size that a message may keep at most."""
_PATIENCE = 3
"""Messages of a stream that may gain too little, one after the other."""
_SKIPPED = 300
"""Messages of such a stream that then go as they are."""


class Compressor:
    """Compresses the messages of each stream for as long as that saves a tenth."""

    def __init__(self) -> None:
        self._zstd = zstandard.ZstdCompressor(level=_LEVEL)
        self._misses: dict[int, int] = {}
        self._skipping: dict[int, int] = {}

    def encode(self, stream: int, payload: bytes) -> Encoded:
        if len(payload) < _LEAST_BYTES:
            return Encoded(payload)
        left = self._skipping.get(stream, 0)
        if left:
            self._skipping[stream] = left - 1
            return Encoded(payload)
        data = self._zstd.compress(payload)
        if len(data) <= _WORTHWHILE * len(payload):
            self._misses[stream] = 0
            return Encoded(data, is_compressed=True)
        self._misses[stream] = self._misses.get(stream, 0) + 1
        if self._misses[stream] >= _PATIENCE:
            self._skipping[stream] = _SKIPPED
        return Encoded(payload)

    def packed(self, frame: bytes) -> bytes:
        """``frame`` with its body compressed, where that saves a tenth."""
        encoded = self.encode(0, frame[HEAD_BYTES:])
        return _marked(frame) + encoded.data if encoded.is_compressed else frame


def compress(data: bytes, before: bytes = b"") -> bytes:
    """Compress what travels seldom as far as can be: by ``before``, which the other end has, too."""
    return zstandard.ZstdCompressor(level=_LEVEL_ALONE, dict_data=_dictionary(before)).compress(data)


def decompress(data: bytes, most_bytes: int, before: bytes = b"") -> bytes:
    """The bytes that were compressed. Raises ``LinkError``, also for more than ``most_bytes``."""
    try:
        size_bytes = zstandard.frame_content_size(data)
        if not 0 < size_bytes <= most_bytes:
            raise LinkError(f"a compressed message says that it has {size_bytes} bytes")
        payload = zstandard.ZstdDecompressor(dict_data=_dictionary(before)).decompress(
            data, allow_extra_data=False
        )
    except (zstandard.ZstdError, MemoryError) as error:
        raise LinkError("a compressed message is damaged") from error
    if len(payload) != size_bytes:
        raise LinkError(f"a compressed message has {len(payload)} bytes and says {size_bytes}")
    return payload


def packed(frame: bytes) -> bytes:
    """``frame`` with its body compressed, where that saves anything."""
    if len(frame) < _LEAST_BYTES:
        return frame
    body = compress(frame[HEAD_BYTES:])
    return _marked(frame) + body if len(body) + HEAD_BYTES < len(frame) else frame


def sendable(frame: bytes) -> bytes:
    """``frame`` compressed. Raises ``LinkError`` where it is too large for one message all the same."""
    sent = packed(frame)
    if len(sent) > MAX_SENT_BYTES:
        raise LinkError(f"{len(sent)} bytes, compressed, are too many for a question or an answer")
    return sent


def unpacked(data: bytes, most_bytes: int) -> bytes:
    """The frame that ``packed`` compressed. Raises ``LinkError``, also for more than ``most_bytes``."""
    if len(data) < HEAD_BYTES or other_version(data) is not None or not data[1] & COMPRESSED:
        return data
    return bytes((data[0], data[1] ^ COMPRESSED)) + decompress(data[HEAD_BYTES:], most_bytes)


def _marked(frame: bytes) -> bytes:
    return bytes((frame[0], frame[1] | COMPRESSED))


def _dictionary(before: bytes) -> zstandard.ZstdCompressionDict | None:
    if not before:
        return None
    return zstandard.ZstdCompressionDict(before, dict_type=zstandard.DICT_TYPE_RAWCONTENT)
