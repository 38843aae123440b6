# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reading a file as if it were whole, and otherwise from where that fails."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from itertools import islice

from smarttestudo.adapters.rosbag.stored_file import ChannelsByNumber, StoredFile
from smarttestudo.domain.recording import RecordedMessage


class Recovery:
    """Opens a file once more, in the way of a damaged one, when reading it fails half-way.

    ``message_count``, ``notices`` and ``readable_share`` are those of the file, and what that tells instead.
    """

    def __init__(self, recover: Callable[[], StoredFile], message_count: int) -> None:
        self._recover = recover
        self.message_count = message_count
        self.notices: Sequence[str] = ()
        self.readable_share: float | None = 1.0

    def continued(
        self, messages: Iterator[RecordedMessage], channels: ChannelsByNumber
    ) -> Iterator[RecordedMessage]:
        """``messages``, and where they fail, the rest of them from the file opened anew."""
        delivered = 0
        try:
            for message in messages:
                yield message
                delivered += 1
        except Exception as error:  # noqa: BLE001 - libraries leak all kinds; what is behind the damage is read
            with closing(self._recover()) as recovered:
                yield from islice(recovered.messages(channels), delivered, None)
                self.notices = recovered.notices() or [f"damaged: {error}"]
                self.message_count = recovered.message_count
                self.readable_share = recovered.readable_share
