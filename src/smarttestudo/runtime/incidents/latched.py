# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages that still count, however old they are."""

from __future__ import annotations

from collections.abc import Hashable, Iterator

from smarttestudo.cdr import FrameReader
from smarttestudo.runtime.incidents.topic_ring import SourceMessage

STATIC_FRAMES = "tf_static"
_MAX_SAMPLES = 1000


def holds_static_frames(topic: str) -> bool:
    """Whether ``topic`` is a ``/tf_static``, in whatever namespace."""
    return topic.rpartition("/")[2] == STATIC_FRAMES


class LatchedSamples:
    """The last message of each publisher of a latched topic; of ``/tf_static``, the last of each frame.

    Recordings do not tell publishers apart, and a frame is broadcast by one of them. The oldest go where
    there are more than a thousand.
    """

    def __init__(self, topic: str) -> None:
        self._frames = FrameReader() if holds_static_frames(topic) else None
        self._samples: dict[Hashable, SourceMessage] = {}

    @property
    def held_bytes(self) -> int:
        """What the messages take in memory."""
        return sum(message.held_bytes for message in set(self._samples.values()))

    def add(self, message: SourceMessage, publisher: Hashable) -> None:
        """Keep a message in the place of those before it."""
        keys: tuple[Hashable, ...] = (publisher,)
        if self._frames is not None:
            keys = self._frames.child_frames(message.payload) or keys
        for key in keys:
            self._samples.pop(key, None)
            self._samples[key] = message
        while len(self._samples) > _MAX_SAMPLES:
            del self._samples[next(iter(self._samples))]

    def __iter__(self) -> Iterator[SourceMessage]:
        """The messages, each once, in the order that they came."""
        return iter(sorted(set(self._samples.values())))
