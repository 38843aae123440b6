# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of a robot: a payload begins with the time at which it was due and its number."""

from __future__ import annotations

import os
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

HEAD = struct.Struct("<qI")
_BLOCK_BYTES = 4_000

Publish = Callable[[bytes], object]
Note = Callable[[str, bytes], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Topic:
    """What the robot sends from ``from_s`` on; ``noise`` is the share of a payload that cannot be compressed.

    ``priority``, ``floor_hz`` and ``is_full`` are SmartTestudo's, ``zenoh_priority`` is plain Zenoh's,
    ``reliable`` Fast DDS's.
    """

    name: str
    size_bytes: int
    hz: float
    priority: float
    zenoh_priority: str
    reliable: bool = False
    is_full: bool = False
    floor_hz: float = 0.0
    from_s: float = 0.0
    noise: float = 1.0

    def payload(self) -> bytes:
        """Its payload without the head."""
        noise_bytes = int(_BLOCK_BYTES * self.noise)
        blocks = -(-self.size_bytes // _BLOCK_BYTES)
        data = b"".join(os.urandom(noise_bytes) + bytes(_BLOCK_BYTES - noise_bytes) for _ in range(blocks))
        return data[HEAD.size : self.size_bytes]


@dataclass(frozen=True, slots=True, kw_only=True)
class Publishing:
    """How to publish each topic, whether somebody listens, and what the end counts, by topic, if anything.

    The counts are how many messages it began to send, and how many it says it had no room for.
    """

    publishers: Sequence[Publish]
    is_connected: Callable[[], bool]
    counts: Callable[[], Mapping[str, tuple[int, int]]] = dict
