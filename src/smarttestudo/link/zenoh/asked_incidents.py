# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions about a robot's incidents, at the robot's end of a link."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import zenoh

from smarttestudo.domain.errors import LinkError, TestudoError, testudo_error
from smarttestudo.incidents.offered_incidents import OfferedIncidents
from smarttestudo.incidents.transfer_messages import (
    AskBytes,
    AskList,
    AskPlan,
    TransferPiece,
    TransferQuestion,
    list_to_bytes,
    piece_to_bytes,
    plan_to_bytes,
    question_from_bytes,
)
from smarttestudo.link.protocol.question_messages import answer_to_bytes
from smarttestudo.link.zenoh.asked_questions import MAX_SENT_BYTES
from smarttestudo.link.zenoh.compression import Compressor, packed
from smarttestudo.link.zenoh.keys import Boot

MAX_WAITING = 32
"""How many questions wait for a look at the disk."""
_MOST_QUESTION_BYTES = 1_000
_END_WITHIN_S = 5.0


class WaitingAsk(NamedTuple):
    """A question for bytes and what answers it."""

    ask: AskBytes
    query: zenoh.Query


class AskedIncidents:
    """Takes the questions about what ``offered`` has.

    Lists and plans are made by a thread of their own. Questions for bytes are given to ``wait``, those that
    only say what has arrived to ``got``; ``answer`` answers one when the link has nothing better to do.
    """

    def __init__(
        self,
        session: zenoh.Session,
        boot: Boot,
        offered: OfferedIncidents,
        *,
        wait: Callable[[WaitingAsk], None],
        got: Callable[[AskBytes], None],
    ) -> None:
        self._key = boot.incidents_key
        self._offered = offered
        self._wait = wait
        self._got = got
        self._compressor = Compressor()
        self._tasks: queue.Queue[Callable[[], None] | None] = queue.Queue(MAX_WAITING)
        self._thread = threading.Thread(target=self._run, name="link-incidents", daemon=True)
        self._thread.start()
        # Undeclared where nobody holds it.
        self._kept = session.declare_queryable(self._key, self._take)

    def answer(self, waiting: WaitingAsk, most_bytes: int, others: int) -> int:
        """Answer with at most so many bytes of the order, while ``others`` wait; how many travel."""
        ask, query = waiting
        index = self._offered.known(ask.name, ask.token)
        with query:
            if index is None:
                return 0
            try:
                parts, body = index.read(ask.cursor, min(ask.size_bytes, most_bytes))
            except LinkError as error:
                _refuse(query, error)
                return 0
            if not parts:
                return 0
            piece = TransferPiece(parts=parts, body=body, advised_bytes=most_bytes, waiting=others)
            data = piece_to_bytes(piece, self._compressed)
            try:
                query.reply(self._key, data, express=True)
            except zenoh.ZError:
                # Who asked is gone, or the session is closed.
                return 0
        return len(data)

    def close(self) -> None:
        """Answer nothing more; the session is to be closed then."""
        self._tasks.put(None)
        self._thread.join(_END_WITHIN_S)

    def _compressed(self, body: bytes) -> bytes | None:
        encoded = self._compressor.encode(0, body)
        return encoded.data if encoded.is_compressed else None

    def _take(self, query: zenoh.Query) -> None:
        # What is asked of many keys at once may go round access control.
        if str(query.key_expr) != self._key or query.payload is None:
            query.drop()
            return
        data = query.payload.to_bytes()
        try:
            question = question_from_bytes(data[:_MOST_QUESTION_BYTES])
        except LinkError as error:
            with query:
                _refuse(query, error)
            return
        if not isinstance(question, AskBytes):
            self._later(query, question)
        elif not question.size_bytes:
            query.drop()
            self._got(question)
        elif self._offered.known(question.name, question.token) is not None:
            self._wait(WaitingAsk(question, query))
        else:
            self._later(query, question)

    def _later(self, query: zenoh.Query, question: TransferQuestion) -> None:
        try:
            self._tasks.put_nowait(partial(self._tell, query, question))
        except queue.Full:
            # Who asked asks again.
            query.drop()

    def _run(self) -> None:
        while (task := self._tasks.get()) is not None:
            task()

    def _tell(self, query: zenoh.Query, question: TransferQuestion) -> None:
        with query:
            try:
                answer = self._looked_up(question)
                if answer is not None:
                    query.reply(self._key, _sendable(packed(answer)))
            except zenoh.ZError:
                return
            except Exception as error:  # noqa: BLE001 - whatever a stranger asks, others are answered
                _refuse(query, testudo_error(error))

    def _looked_up(self, question: TransferQuestion) -> bytes | None:
        """What the disk answers; ``None`` where an incident was forgotten: its bytes are asked for again."""
        if isinstance(question, AskList):
            return list_to_bytes(self._offered.list())
        plan = self._offered.index(question.name).plan
        if isinstance(question, AskPlan):
            return plan_to_bytes(plan)
        if plan.token != question.token:
            raise LinkError("the incident changed on the robot", place=question.name, remedy="fetch it again")
        return None


def _sendable(answer: bytes) -> bytes:
    if len(answer) > MAX_SENT_BYTES:
        raise LinkError(f"{len(answer)} bytes, compressed, are too many for an answer")
    return answer


def _refuse(query: zenoh.Query, error: TestudoError) -> None:
    try:
        query.reply_err(packed(answer_to_bytes(error)))
    except zenoh.ZError:
        return
