# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How the bytes of a name travel: they are asked for from an offset on, and come in parts."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Protocol

from smarttestudo.link.protocol.wire import FrameType, Kind

VERSION_BYTES = 8
NEWEST = b""
"""In place of a version: that which there is."""
MOST_BYTES = 2**62
MAX_PART_BYTES = 16_000
MAX_PART_FRAME_BYTES = MAX_PART_BYTES + 100
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_/-]{0,119}|")


@dataclass(frozen=True, slots=True, kw_only=True)
class Ask:
    """The bytes of ``name`` from ``offset`` on; the empty name is that of the key itself.

    ``asker`` is a random number that tells who asks, and has ``got_bytes`` of all frames that were sent to it
    so far. It asks for one name at a time: this replaces what it asked for before.
    """

    name: str
    version: bytes
    asker: int
    got_bytes: int
    offset: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Got:
    """Bytes that the asking end has got; nothing is to be answered."""

    asker: int
    got_bytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ContentPart:
    """Some of the ``total_bytes`` of a name in this version."""

    version: bytes
    total_bytes: int
    offset: int
    data: bytes


class Content(Protocol):
    """The bytes of a name. Those that are urgent go between live topics, others in what these leave."""

    @property
    def is_urgent(self) -> bool: ...
    @property
    def version(self) -> bytes: ...
    @property
    def size_bytes(self) -> int: ...

    def read(self, offset: int, size_bytes: int) -> bytes:
        """So many bytes, or fewer at the end. Raises ``LinkError`` where they are not there any more."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WholeContent:
    """Bytes in memory, whose version is their number or their digest."""

    version: bytes
    data: bytes
    is_urgent: bool = True

    @property
    def size_bytes(self) -> int:
        return len(self.data)

    def read(self, offset: int, size_bytes: int) -> bytes:
        return self.data[offset : offset + size_bytes]


def _check_ask(said: Ask | Got) -> None:
    numbers = [said.asker, said.got_bytes]
    if isinstance(said, Ask):
        numbers.append(said.offset)
        if not _NAME.fullmatch(said.name) or len(said.version) not in (0, VERSION_BYTES):
            raise ValueError("no name")
    if min(numbers) < 0:
        raise ValueError("no number of bytes")


def _check_part(part: ContentPart) -> None:
    end = part.offset + len(part.data)
    if len(part.version) != VERSION_BYTES or not part.data or len(part.data) > MAX_PART_BYTES:
        raise ValueError("no bytes")
    if not 0 <= part.offset < end <= part.total_bytes <= MOST_BYTES:
        raise ValueError("bytes that are not in it")


ASKS: FrameType[Ask | Got] = FrameType(Kind.ASK, Ask | Got, _check_ask, most_bytes=1_000)
PARTS: FrameType[ContentPart] = FrameType(
    Kind.PART, ContentPart, _check_part, most_bytes=MAX_PART_FRAME_BYTES
)
