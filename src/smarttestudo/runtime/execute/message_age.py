# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the header stamps of relayed messages say."""

from __future__ import annotations

import struct

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.cdr import header_stamp
from smarttestudo.runtime.execute.flow_meter import RateWindow

_NS_PER_MS = 1_000_000


class MessageAge:
    """The rate of a topic by its messages' own stamps, and the age of the last one when it was relayed.

    Means something only for messages that begin with a std_msgs/Header. Both are ``None`` while unknown.
    """

    __slots__ = ("_beginning", "_relayed_ns", "_window", "delay_ms", "stamped_hz")

    def __init__(self) -> None:
        self.delay_ms: float | None = None
        self.stamped_hz: float | None = None
        self._beginning = b""
        self._relayed_ns = 0
        self._window = RateWindow()

    def note(self, beginning: bytes, relayed_ns: int) -> None:
        """A message was relayed; ``beginning`` are its bytes up to the end of a header's stamp."""
        self._beginning = beginning
        self._relayed_ns = relayed_ns

    def look(self, now_ns: int, messages: int) -> None:
        """Read the last stamp; ``messages`` were relayed so far."""
        stamp = header_stamp(self._beginning)
        if stamp is None:
            return
        sec, nanosec = struct.unpack("<iI", stamp)
        stamp_ns = sec * NS_PER_S + nanosec
        self._window.look(now_ns, messages, stamp_ns)
        self.stamped_hz = self._window.rate_hz
        # A driver that does not stamp leaves zeros.
        self.delay_ms = (self._relayed_ns - stamp_ns) / _NS_PER_MS if stamp_ns else None
