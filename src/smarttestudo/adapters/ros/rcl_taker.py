# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Takes the messages of one source."""

from __future__ import annotations

from collections.abc import Callable

from smarttestudo.adapters.ros.message_info import InfoLayout, MessageInfo
from smarttestudo.adapters.ros.message_numbers import MessageNumbers
from smarttestudo.adapters.ros.rcl_buffers import RclBuffers, RclPayload
from smarttestudo.adapters.ros.rcl_library import RclLibrary
from smarttestudo.adapters.ros.rcl_subscription import RclSubscription
from smarttestudo.domain.errors import RosError


class RclTaker:
    """Takes each message once, whichever subscription it comes by.

    ``publisher`` is that of the last one. ``failed`` is told what goes wrong, and then there is no message.
    """

    __slots__ = ("_info", "_tells_publishers", "buffers", "failed", "numbers", "publisher")

    def __init__(self, library: RclLibrary, layout: InfoLayout, failed: Callable[[RosError], None]) -> None:
        self.failed = failed
        self.buffers = RclBuffers(library)
        self.numbers = MessageNumbers() if layout.is_numbered else None
        self.publisher: bytes | None = None
        self._info = MessageInfo(layout)
        self._tells_publishers = layout.gid_bytes > 0

    def take(self, subscription: RclSubscription) -> RclPayload | None:
        """The oldest message that waits; ``None`` if there is none."""
        try:
            while (payload := subscription.take(self.buffers, self._info)) is not None:
                if not self._tells_publishers:
                    return payload
                number, self.publisher = self._info.read()
                if self.numbers is None or self.numbers.is_new(self.publisher, number):
                    return payload
        except RosError as error:
            self.failed(error)
        return None

    def take_newest(self, subscription: RclSubscription) -> RclPayload | None:
        """The newest message that waits; ``None`` if there is none."""
        newest = None
        while (payload := self.take(subscription)) is not None:
            newest = payload
        return newest
