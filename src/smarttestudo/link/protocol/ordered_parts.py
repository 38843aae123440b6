# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of a session by datagrams put together, and delivered in order where they must be."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from smarttestudo.link.protocol.chunks import (
    MAX_PARTIAL_BYTES,
    NUMBERS,
    Chunk,
    LostSpan,
)
from smarttestudo.link.protocol.wire import malformed


@dataclass(slots=True)
class _PartialMessage:
    """A message of which parts are there, in any order, by their offsets."""

    is_in_order: bool
    data: bytearray
    offsets: set[int] = field(default_factory=set)
    got_bytes: int = 0


MAX_PARTIALS = 4_096
"""How many messages of a session may be unfinished at once."""


class PartReassembler:
    """Puts the messages of one session by datagrams together, whatever of them comes first, or twice."""

    def __init__(self) -> None:
        self._partials: dict[int, dict[int, _PartialMessage]] = {}
        self._count = self._bytes = 0

    def add(self, chunk: Chunk) -> bytes | None:
        """The message that is whole with ``chunk``. Raises ``LinkError`` where there is no room for it."""
        if len(chunk.body) == chunk.size_bytes:
            return chunk.body
        partials = self._partials.setdefault(chunk.stream, {})
        partial = partials.get(chunk.number)
        if partial is None:
            if self._count >= MAX_PARTIALS or self._bytes + chunk.size_bytes > MAX_PARTIAL_BYTES:
                raise malformed("more unfinished messages than there is room for")
            partial = _PartialMessage(chunk.is_in_order, bytearray(chunk.size_bytes))
            partials[chunk.number] = partial
            self._count += 1
            self._bytes += chunk.size_bytes
        elif len(partial.data) != chunk.size_bytes:
            raise malformed("a part of a message of another size")
        if chunk.offset not in partial.offsets:
            partial.offsets.add(chunk.offset)
            partial.data[chunk.offset : chunk.offset + len(chunk.body)] = chunk.body
            partial.got_bytes += len(chunk.body)
        if partial.got_bytes < chunk.size_bytes:
            return None
        self._forget(chunk.stream, chunk.number)
        return bytes(partial.data)

    def forget_before(self, stream: int, number: int) -> None:
        """Forget what is unfinished of a stream before a message, and need not arrive."""
        for one, partial in list(self._partials.get(stream, {}).items()):
            if not partial.is_in_order and 0 < (number - one) % NUMBERS < NUMBERS // 2:
                self._forget(stream, one)

    def forget(self, stream: int) -> None:
        """Forget what is unfinished of a stream."""
        for number in list(self._partials.get(stream, {})):
            self._forget(stream, number)

    def _forget(self, stream: int, number: int) -> None:
        partials = self._partials[stream]
        self._bytes -= len(partials.pop(number).data)
        self._count -= 1
        if not partials:
            del self._partials[stream]


class WholeMessage(NamedTuple):
    """A message that is whole with ``chunk``, which came at ``span`` of the session.

    ``sent_ns`` is when that would have been sent on a link without queues, by the clock of this end.
    """

    chunk: Chunk
    span: LostSpan
    sent_ns: int
    data: bytes


class OrderedParts:
    """The messages of one session by datagrams; those that arrive in order wait for the ones before them."""

    def __init__(self) -> None:
        self._parts = PartReassembler()
        self._delivered: dict[int, int] = {}
        self._waiting: dict[int, dict[int, WholeMessage]] = {}
        self._waiting_bytes = 0
        self._announced_bytes: dict[int, int] = {}

    def announced(self, stream: int) -> int:
        """From where on in the session chunks are of the stream that has the number now."""
        return self._announced_bytes.get(stream, 0)

    def announce(self, stream: int, span: LostSpan, *, is_open: bool) -> None:
        """Somebody said what a stream is, or that there is none of the number."""
        self._announced_bytes[stream] = span.after_bytes
        if not is_open:
            self._parts.forget(stream)
            self._delivered.pop(stream, None)
            for one in self._waiting.pop(stream, {}).values():
                self._waiting_bytes -= len(one.data)

    def delivered(self, stream: int) -> int:
        """How many messages of a stream that arrive in order were delivered."""
        return self._delivered.get(stream, 0)

    @property
    def undelivered(self) -> Iterator[LostSpan]:
        """Where those ended that are whole, and wait for others."""
        for waiting in self._waiting.values():
            for one in waiting.values():
                yield one.span

    def add(self, chunk: Chunk, span: LostSpan, sent_ns: int) -> Iterator[WholeMessage]:
        """The messages that are to be delivered now. Raises ``LinkError`` where there is no room."""
        stream, place = chunk.stream, chunk.before
        if chunk.is_in_order and (place < self.delivered(stream) or place in self._waiting.get(stream, ())):
            return iter(())
        if self._waiting_bytes + len(chunk.body) > MAX_PARTIAL_BYTES:
            raise malformed("more messages that wait for others than there is room for")
        data = self._parts.add(chunk)
        if data is None:
            return iter(())
        whole = WholeMessage(chunk, span, sent_ns, data)
        if not chunk.is_in_order:
            self._parts.forget_before(stream, chunk.number)
            return iter((whole,))
        waiting = self._waiting.setdefault(stream, {})
        if place not in waiting:
            waiting[place] = whole
            self._waiting_bytes += len(data)
        return self._next_in_order(stream)

    def _next_in_order(self, stream: int) -> Iterator[WholeMessage]:
        waiting = self._waiting[stream]
        while (place := self.delivered(stream)) in waiting:
            whole = waiting.pop(place)
            self._waiting_bytes -= len(whole.data)
            self._delivered[stream] = place + 1
            yield whole
        if not waiting:
            self._waiting.pop(stream, None)
