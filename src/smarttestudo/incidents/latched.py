# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages that still count, however old they are."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable, Iterable, Sequence
from dataclasses import dataclass
from operator import attrgetter

from smarttestudo.incidents.topic_ring import GivenUp, SourceMessage
from smarttestudo.pacing.cdr import FrameReader

STATIC_FRAMES = "tf_static"
_MAX_SAMPLES = 1000
_GIVEN_UP_BYTES = 200
"""About what is kept of a message that was given up."""


Gone = Callable[[Sequence[Hashable]], Iterable[Hashable]]
"""Which of the publishers that have something latched are gone."""


def nobody(_publishers: Sequence[Hashable]) -> Iterable[Hashable]:
    """Say that all are there, as far as is known."""
    return ()


def holds_static_frames(topic: str) -> bool:
    """Whether ``topic`` is a ``/tf_static``, in whatever namespace."""
    return topic.rpartition("/")[2] == STATIC_FRAMES


@dataclass(slots=True, kw_only=True, eq=False)
class _Sample:
    """A message that arrived at ``at_ns`` and counts for ``keys`` publishers or frames.

    Where that is none, others took its place, the last of them at ``replaced_ns``.
    """

    message: SourceMessage
    at_ns: int
    keys: int = 0
    replaced_ns: int = 0


class LatchedSamples:
    """The last message of each publisher of a latched topic; of ``/tf_static``, the last of each frame.

    Recordings do not tell publishers apart, and a frame is broadcast by one of them. The oldest go where more
    than a thousand count. Those whose place others took are kept for windows that begin before that, until
    they are forgotten or given up. All times are steady.
    """

    def __init__(self, topic: str) -> None:
        self._frames = FrameReader() if holds_static_frames(topic) else None
        self._counting: dict[Hashable, _Sample] = {}
        self._counting_bytes = 0
        self._replaced: deque[_Sample] = deque()
        self._replaced_bytes = 0
        # Each with when it was replaced.
        self._given_up: deque[tuple[int, GivenUp]] = deque()
        self.complete_since_ns: int | None = None
        """From when on all is known that counted; all is, if that is ``None``."""

    @property
    def held_bytes(self) -> int:
        """Bytes in memory for the messages, with what is kept of those that were given up."""
        return self._counting_bytes + self._replaced_bytes + len(self._given_up) * _GIVEN_UP_BYTES

    @property
    def replaced_bytes(self) -> int:
        """Bytes of those that may be given up."""
        return self._replaced_bytes

    def add(self, message: SourceMessage, publisher: Hashable, now_ns: int) -> None:
        """Keep a message that arrived now, in the place of those before it."""
        keys: tuple[Hashable, ...] = (publisher,)
        if self._frames is not None:
            keys = self._frames.streams(message.payload) or keys
        sample = _Sample(message=message, at_ns=now_ns)
        self._counting_bytes += message.held_bytes
        for key in dict.fromkeys(keys):
            self._replace(key, now_ns)
            self._counting[key] = sample
            sample.keys += 1
        while len(self._counting) > _MAX_SAMPLES:
            self._replace(next(iter(self._counting)), now_ns)

    @property
    def publishers(self) -> Sequence[Hashable]:
        """Publishers with a message that counts, in the order of these; none where frames have them."""
        return () if self._frames is not None else tuple(self._counting)

    def end(self, publishers: Iterable[Hashable], now_ns: int) -> None:
        """Count messages of ``publishers`` no more."""
        for publisher in publishers:
            self._replace(publisher, now_ns)

    def forget_before(self, from_ns: int) -> None:
        """Drop what was replaced before ``from_ns``; no window begins earlier."""
        while self._replaced and self._replaced[0].replaced_ns < from_ns:
            sample = self._replaced.popleft()
            self._replaced_bytes -= sample.message.held_bytes
            self.complete_since_ns = sample.replaced_ns
        while self._given_up and self._given_up[0][0] < from_ns:
            self.complete_since_ns, _ = self._given_up.popleft()

    def give_up_oldest(self) -> tuple[int, SourceMessage]:
        """Drop the oldest that others replaced, though a window may begin before; when that was, and it."""
        sample = self._replaced.popleft()
        message = sample.message
        self._replaced_bytes -= message.held_bytes
        self._given_up.append((sample.replaced_ns, GivenUp(sample.at_ns, message.stamp_ns, message.number)))
        return sample.replaced_ns, message

    def counting_at(self, from_ns: int) -> list[SourceMessage]:
        """The messages that arrived before ``from_ns`` and counted until then, in their order."""
        return sorted(
            sample.message
            for sample in self._all()
            if sample.at_ns < from_ns and (sample.keys or sample.replaced_ns >= from_ns)
        )

    def since(self, from_ns: int) -> list[SourceMessage]:
        """The messages that arrived at ``from_ns`` or later, in their order."""
        return sorted(sample.message for sample in self._all() if sample.at_ns >= from_ns)

    def given_up_of(self, from_ns: int) -> list[GivenUp]:
        """Samples that a window from ``from_ns`` on lacks: what counted as it began, or arrived in it."""
        found = (sample for replaced_ns, sample in self._given_up if replaced_ns >= from_ns)
        return sorted(found, key=attrgetter("number"))

    def _all(self) -> set[_Sample]:
        return {*self._counting.values(), *self._replaced}

    def _replace(self, key: Hashable, now_ns: int) -> None:
        sample = self._counting.pop(key, None)
        if sample is None:
            return
        sample.keys -= 1
        if not sample.keys:
            sample.replaced_ns = now_ns
            self._counting_bytes -= sample.message.held_bytes
            self._replaced_bytes += sample.message.held_bytes
            self._replaced.append(sample)
