# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The bytes of names over Zenoh: a question for them has the parts of one answer after the other."""

from __future__ import annotations

import queue
import secrets
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial

from smarttestudo.domain.errors import LinkError
from smarttestudo.link.protocol.requests import Grant, Requests
from smarttestudo.link.transfer.fetching import Fetching
from smarttestudo.link.transfer.messages import (
    ASKS,
    MAX_PART_FRAME_BYTES,
    NEWEST,
    PARTS,
    Ask,
    Content,
    ContentPart,
    Got,
    WholeContent,
)
from smarttestudo.link.zenoh.compression import Compressor, unpacked
from smarttestudo.link.zenoh.queries import Query, QueryClient, QueryServer

_ASKED_FOR_S = 3_600.0
"""How long the answer to one question may take; then it is asked for the rest."""


@dataclass(slots=True, eq=False)
class Answer:
    """Answer to a question: ``content`` from ``offset`` on."""

    query: Query
    content: Content
    offset: int


class ByteServer:
    """Answers questions for bytes, in the order that ``requests`` give.

    ``do`` has something done to them by the thread that owns them.
    """

    def __init__(
        self,
        server: QueryServer,
        requests: Requests[Answer],
        do: Callable[[Callable[[], None]], None],
        clock: Callable[[], int],
    ) -> None:
        self._server = server
        self._requests = requests
        self._do = do
        self._clock = clock
        self._compressor = Compressor()

    def offer(
        self,
        key: str,
        content_of: Callable[[str], Content],
        later: Callable[[Callable[[], None]], bool] | None = None,
    ) -> None:
        """Answer on ``key``; ``later`` has a task of another thread look contents up, if it takes one."""

        def handle(query: Query) -> None:
            said = ASKS.from_bytes(query.data)
            if isinstance(said, Got):
                self._do(partial(self._acknowledge, query, said))
                return
            act = partial(query.attempt, partial(self._begin, query, said, content_of))
            if later is None:
                act()
            elif not later(act):
                query.drop()

        self._server.serve(key, handle)

    def _begin(self, query: Query, ask: Ask, content_of: Callable[[str], Content]) -> None:
        content = content_of(ask.name)
        if ask.version not in (NEWEST, content.version):
            raise LinkError(
                "it changed on the robot meanwhile", place=ask.name.partition("/")[0], remedy="fetch it again"
            )
        self._do(partial(self._enqueue, query, ask, content))

    def answer(self, grant: Grant[Answer]) -> tuple[int, bool]:
        """Send the next part; how many bytes travel, and whether it is the last. It waits for the link."""
        answer, sent = grant.request, b""
        content, offset = answer.content, answer.offset
        try:
            data = content.read(offset, grant.size_bytes)
        except LinkError as error:
            answer.query.refuse(error)
            return 0, True
        if data:
            part = ContentPart(
                version=content.version, total_bytes=content.size_bytes, offset=offset, data=data
            )
            sent = self._compressor.packed(PARTS.to_bytes(part))
            answer.offset += len(data)
        is_sent = bool(data) and answer.query.reply_part(sent)
        is_last = not is_sent or answer.offset >= content.size_bytes
        if is_last:
            answer.query.drop()
        return len(sent) if is_sent else 0, is_last

    def _acknowledge(self, query: Query, got: Got) -> None:
        self._requests.acknowledge(got.asker, got.got_bytes, self._clock())
        query.drop()

    def _enqueue(self, query: Query, ask: Ask, content: Content) -> None:
        answer = Answer(query, content, ask.offset)
        if content.is_urgent:
            gone = None if self._requests.enqueue_urgent(answer) else answer
        else:
            gone = self._requests.enqueue(ask.asker, ask.got_bytes, answer, self._clock())
        if gone is not None:
            gone.query.drop()


def part_from(data: bytes) -> ContentPart:
    """The part that arrived. Raises ``LinkError`` for anything else."""
    return PARTS.from_bytes(unpacked(data, MAX_PART_FRAME_BYTES))


Whole = WholeContent | LinkError | None
"""All bytes of a name, why there are none, or nothing where a robot is silent."""


def read_whole(client: QueryClient, key: str, most_bytes: int, answered: Callable[[Whole], None]) -> None:
    """Have ``answered`` called once with all bytes of a key, by any thread; they are asked for once."""
    fetching = Fetching("", secrets.randbits(64), most_bytes=most_bytes)
    data = bytearray()
    failed: list[LinkError] = []

    def replied(reply: bytes | LinkError) -> None:
        try:
            if isinstance(reply, LinkError):
                raise reply
            data.extend(fetching.receive(part_from(reply), len(reply), 0))
        except LinkError as error:
            failed.append(error)

    def ended() -> None:
        whole = WholeContent(version=fetching.version, data=bytes(data))
        answered(failed[0] if failed else whole if fetching.is_complete else None)

    ask = fetching.next(0)
    assert ask is not None
    client.ask(key, ASKS.to_bytes(ask), replied, ended, waits=False)


class Fetch:
    """Bytes that are fetched over outages, on the thread that calls ``step``.

    ``key`` gives the key to ask on, ``None`` while nobody is there who could answer.
    """

    def __init__(self, client: QueryClient, key: Callable[[], str | None], fetching: Fetching) -> None:
        self.fetching = fetching
        self._client = client
        self._key = key
        self._events: queue.SimpleQueue[bytes | LinkError | Ask] = queue.SimpleQueue()

    def step(self, timeout_s: float) -> bytes:
        """Ask where that is due, and wait for more of the bytes: what came. Raises ``LinkError``."""
        key = self._key()
        said = None if key is None else self.fetching.next(time.monotonic_ns())
        if key is not None and said is not None:
            ended = partial(self._events.put, said) if isinstance(said, Ask) else lambda: None
            self._client.ask(key, ASKS.to_bytes(said), self._events.put, ended, _ASKED_FOR_S)
        data = bytearray()
        with suppress(queue.Empty):
            event = self._events.get(timeout=timeout_s)
            while True:
                data += self._take(event)
                event = self._events.get_nowait()
        return bytes(data)

    def _take(self, event: bytes | LinkError | Ask) -> bytes:
        if isinstance(event, LinkError):
            raise event
        if isinstance(event, Ask):
            self.fetching.ended(event, time.monotonic_ns())
            return b""
        return self.fetching.receive(part_from(event), len(event), time.monotonic_ns())
