# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One storage file of a bag, however it has to be read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol

from smarttestudo.domain.recording import Channel, RecordedMessage, readable_until

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

    @property
    def readable_share(self) -> float | None:
        """How much of what the file was to hold can be read, 0 … 1, once that was tried.

        ``None`` where nothing tells how much is missing.
        """

    def close(self) -> None:
        """Let go of the file."""


def read_so_far(file: StoredFile) -> str:
    """How far a damaged file could be read."""
    if not file.message_count:
        return "no message could be read"
    return f"{readable_until(file.readable_share, file.end_ns)} after {file.message_count:,} messages"
