# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The asking end of a transfer: what is there of a name's bytes, and when to ask for the rest."""

from __future__ import annotations

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.link.protocol.wire import malformed
from smarttestudo.link.transfer.messages import MOST_BYTES, NEWEST, Ask, ContentPart, Got

_AGAIN_AFTER_NS = NS_PER_S // 2
"""How soon to ask again at the earliest where bytes got lost, or an answer ended before them."""
_SILENCE_NS = 5 * NS_PER_S
"""After so long without an answer, it is asked again: that of before is replaced."""


class Fetching:
    """The bytes of ``name`` up to ``offset`` are there, in the time that is passed in.

    The driver sends what ``next`` gives, tells what arrives (``receive``) and that nothing more does
    (``ended``).
    """

    def __init__(
        self,
        name: str,
        asker: int,
        *,
        version: bytes = NEWEST,
        offset: int = 0,
        total_bytes: int | None = None,
        most_bytes: int = MOST_BYTES,
    ) -> None:
        self.offset = offset
        self.version = version
        self.got_bytes = 0
        """Bytes that travelled, of all answers."""
        self._name = name
        self._asker = asker
        self._most_bytes = most_bytes
        self._total_bytes = total_bytes
        self._asked: Ask | None = None
        self._asked_ns = 0
        self._again_ns = 0
        self._said_bytes = 0
        self._answered = True
        self.is_unanswered = False
        """Whether what was asked before got no answer, and nothing came since."""

    @property
    def is_complete(self) -> bool:
        """Whether all is there."""
        return self._total_bytes is not None and self.offset >= self._total_bytes

    def next(self, now_ns: int) -> Ask | Got | None:
        """The question or note to send now, if one is due."""
        if not self.is_complete and now_ns >= self._again_ns:
            self.is_unanswered |= not self._answered
            self._answered = False
            self._asked_ns, self._again_ns = now_ns, now_ns + _SILENCE_NS
            self._said_bytes = self.got_bytes
            self._asked = Ask(
                name=self._name,
                version=self.version,
                asker=self._asker,
                got_bytes=self.got_bytes,
                offset=self.offset,
            )
            return self._asked
        if self._said_bytes == self.got_bytes:
            return None
        self._said_bytes = self.got_bytes
        return Got(asker=self._asker, got_bytes=self.got_bytes)

    def receive(self, part: ContentPart, travelled_bytes: int, now_ns: int) -> bytes:
        """The bytes of a part that follow on those that are there. Raises ``LinkError`` for others' bytes."""
        if part.version != (self.version or part.version) or part.total_bytes > self._most_bytes:
            raise malformed("bytes of something else")
        if part.total_bytes != (self._total_bytes or part.total_bytes):
            raise LinkError("what is fetched has another size than before", remedy="fetch it again")
        self.version, self._total_bytes = part.version, part.total_bytes
        self.got_bytes += travelled_bytes
        skipped = self.offset - part.offset
        if skipped < 0:
            # What lies between got lost; of an answer before, more of the same may come.
            self._ask_soon(now_ns)
            return b""
        self._answered, self.is_unanswered = True, False
        data = part.data[skipped:]
        if data:
            self.offset += len(data)
            self._again_ns = now_ns + _SILENCE_NS
        return data

    def ended(self, ask: Ask, now_ns: int) -> None:
        """Nothing more comes of an ``ask``."""
        if ask is self._asked:
            self._ask_soon(now_ns)

    def _ask_soon(self, now_ns: int) -> None:
        self._again_ns = min(self._again_ns, max(now_ns, self._asked_ns + _AGAIN_AFTER_NS))
