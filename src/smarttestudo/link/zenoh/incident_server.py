# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions about a robot's incidents, at the robot's end of a link."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from smarttestudo.domain.errors import LinkError, testudo_error
from smarttestudo.incidents.catalog import IncidentCatalog
from smarttestudo.incidents.transfer_messages import (
    AskBytes,
    AskList,
    AskPlan,
    TransferPiece,
    TransferQuestion,
)
from smarttestudo.link.protocol.incident_messages import PIECES, PLANS, QUESTIONS, list_to_bytes
from smarttestudo.link.zenoh.compression import Compressor, sendable
from smarttestudo.link.zenoh.query_server import Query, QueryServer


class WaitingAsk(NamedTuple):
    """A question for bytes and what answers it."""

    ask: AskBytes
    query: Query


class IncidentServer:
    """Answers questions about what ``catalog`` has on ``key``.

    Lists and plans are made by tasks for ``later``, which says whether it does them. Questions for bytes are
    given to ``wait``, those that only say what has arrived to ``got``; ``answer`` answers one when the link
    has nothing better to do.
    """

    def __init__(
        self,
        server: QueryServer,
        key: str,
        catalog: IncidentCatalog,
        *,
        later: Callable[[Callable[[], None]], bool],
        wait: Callable[[WaitingAsk], None],
        got: Callable[[AskBytes], None],
    ) -> None:
        self._catalog = catalog
        self._later = later
        self._wait = wait
        self._got = got
        self._compressor = Compressor()
        server.serve(key, self._handle)

    def answer(self, waiting: WaitingAsk, most_bytes: int, others: int) -> int:
        """Answer with at most so many bytes of the order, while ``others`` wait; how many travel."""
        ask, query = waiting
        index = self._catalog.known(ask.name, ask.token)
        if index is None:
            query.drop()
            return 0
        try:
            parts, body = index.read(ask.cursor, min(ask.size_bytes, most_bytes))
        except LinkError as error:
            query.refuse(error)
            return 0
        if not parts:
            query.drop()
            return 0
        piece = TransferPiece(parts=parts, body=body, advised_bytes=most_bytes, waiting=others)
        data = self._compressor.packed(PIECES.to_bytes(piece))
        return len(data) if query.reply(data, express=True) else 0

    def _handle(self, query: Query) -> None:
        question = QUESTIONS.from_bytes(query.data)
        is_known = isinstance(question, AskBytes) and self._catalog.known(question.name, question.token)
        if isinstance(question, AskBytes) and not question.size_bytes:
            query.drop()
            self._got(question)
        elif isinstance(question, AskBytes) and is_known:
            self._wait(WaitingAsk(question, query))
        elif not self._later(partial(self._look_up, query, question)):
            query.drop()

    def _look_up(self, query: Query, question: TransferQuestion) -> None:
        try:
            answer = self._looked_up(question)
            if answer is None:
                query.drop()
            else:
                query.reply(sendable(answer))
        except Exception as error:  # noqa: BLE001 - whatever a stranger asks, others are answered
            query.refuse(testudo_error(error))

    def _looked_up(self, question: TransferQuestion) -> bytes | None:
        """The answer of the disk; ``None`` where an incident was forgotten: its bytes are asked for again."""
        if isinstance(question, AskList):
            return list_to_bytes(self._catalog.list())
        plan = self._catalog.index(question.name).plan
        if isinstance(question, AskPlan):
            return PLANS.to_bytes(plan)
        if plan.token != question.token:
            raise LinkError("the incident changed on the robot", place=question.name, remedy="fetch it again")
        return None
