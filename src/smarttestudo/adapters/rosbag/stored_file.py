# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One storage file of a bag, however it has to be read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Protocol

from smarttestudo.domain.recording import Channel, RecordedMessage
from smarttestudo.domain.units import NS_PER_S

ChannelsByNumber = Mapping[int, Channel]
"""Channels by the number that a file gives each."""

Outline = tuple[Channel, int, int, bytes]
"""A message without its payload: channel, stamp in ns, stored bytes, and the first of them if asked for."""


class OutlineError(Exception):
    """The rest of a file must be read in full."""


class StoredFile(Protocol):
    """An opened storage file."""

    @property
    def channels(self) -> ChannelsByNumber:
        """The channels that the file announces."""

    @property
    def start_ns(self) -> int:
        """Stamp of the first message; meaningless where there is none."""

    @property
    def end_ns(self) -> int:
        """Stamp of the last message; meaningless where there is none."""

    @property
    def message_count(self) -> int:
        """Messages that can be read."""

    def messages(self, channels: ChannelsByNumber) -> Iterator[RecordedMessage]:
        """All messages in time order, with their payloads as stored, each with its one of ``channels``."""

    def outlines(self, channels: ChannelsByNumber, head_bytes: int) -> Iterator[Outline]:
        """What ``messages`` gives, in the same order, each with the first ``head_bytes`` of its payload.

        Raises ``OutlineError`` where only ``messages`` can go on.
        """

    def notices(self) -> Sequence[str]:
        """What was lost, one line each."""

    def close(self) -> None:
        """Let go of the file."""


def read_so_far(file: StoredFile) -> str:
    """How far a damaged file could be read."""
    if not file.message_count:
        return "no message could be read"
    span_s = (file.end_ns - file.start_ns) / NS_PER_S
    return f"{file.message_count} messages over {span_s:.1f} s could be read"


def outlines_of(messages: Iterable[RecordedMessage], head_bytes: int) -> Iterator[Outline]:
    """The outlines of ``messages`` that were read in full."""
    for channel, stamp_ns, payload in messages:
        yield channel, stamp_ns, len(payload), payload[:head_bytes]
