# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions at the robot's end of a link, which wait until the run takes them."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from functools import partial

import zenoh

from smarttestudo.domain.errors import LinkError, TestudoError
from smarttestudo.domain.questions import Answer, Question
from smarttestudo.domain.remote_robots import ANSWER_WITHIN_S
from smarttestudo.domain.units import ns_from_s
from smarttestudo.link.protocol.question_messages import (
    MAX_QUESTION_BYTES,
    answer_to_bytes,
    question_from_bytes,
)
from smarttestudo.link.zenoh.compression import packed, unpacked
from smarttestudo.link.zenoh.keys import Boot

MAX_WAITING = 32
MAX_SENT_BYTES = 900_000
"""How large what travels may be: no end takes a message of more than a megabyte at once."""
_WAITS_NS = ns_from_s(ANSWER_WITHIN_S)
_END_WITHIN_S = 1.0
_Reply = Callable[[Answer | TestudoError], None]


class WaitingQuestion:
    """A question that came at ``asked_ns``; ``reply`` never waits."""

    def __init__(self, question: Question, asked_ns: int, reply: _Reply) -> None:
        self.question = question
        self.asked_ns = asked_ns
        self._reply = reply

    def answer(self, answer: Answer | TestudoError) -> None:
        """Answer it, or say why not; the session may be closed meanwhile."""
        self._reply(answer)


class AskedQuestions:
    """Takes questions that read and questions that change something on a key each, and keeps a few.

    A thread of its own replies: a long answer waits where the link is thin.
    """

    def __init__(self, session: zenoh.Session, boot: Boot, clock: Callable[[], int]) -> None:
        self._clock = clock
        self._waiting: queue.Queue[WaitingQuestion] = queue.Queue(MAX_WAITING)
        self._replies: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="link-answer", daemon=True)
        self._thread.start()
        keys = {boot.get_key: False, boot.set_key: True}
        # Undeclared where nobody holds them.
        self._kept = [
            session.declare_queryable(key, self._taker(key, may_change=may_change))
            for key, may_change in keys.items()
        ]

    def take(self) -> WaitingQuestion | None:
        """The next question; those that nobody waits for any more are left out."""
        while True:
            try:
                asked = self._waiting.get_nowait()
            except queue.Empty:
                return None
            if self._clock() - asked.asked_ns < _WAITS_NS:
                return asked

    def close(self) -> None:
        """Answer nothing more; the session is to be closed then."""
        self._replies.put(None)
        self._thread.join(_END_WITHIN_S)

    def _run(self) -> None:
        while (reply := self._replies.get()) is not None:
            reply()

    def _taker(self, key: str, *, may_change: bool) -> Callable[[zenoh.Query], None]:
        def take(query: zenoh.Query) -> None:
            # What is asked of many keys at once may go round access control.
            if str(query.key_expr) != key:
                query.drop()
                return
            try:
                self._keep(query, key, may_change=may_change)
            except LinkError as error:
                self._refuse(query, key, error)

        return take

    def _refuse(self, query: zenoh.Query, key: str, error: LinkError) -> None:
        """Say why, unless so many are refused that it cannot be said any more."""
        if self._replies.qsize() < MAX_WAITING:
            self._replies.put(partial(_reply, query, key, error))
        else:
            query.drop()

    def _keep(self, query: zenoh.Query, key: str, *, may_change: bool) -> None:
        data = b"" if query.payload is None else query.payload.to_bytes()
        question = question_from_bytes(unpacked(data, MAX_QUESTION_BYTES), may_change=may_change)

        def reply(answer: Answer | TestudoError) -> None:
            self._replies.put(partial(_reply, query, key, answer))

        try:
            self._waiting.put_nowait(WaitingQuestion(question, self._clock(), reply))
        except queue.Full:
            raise LinkError("too many questions wait for an answer", remedy="ask again later") from None


def _reply(query: zenoh.Query, key: str, answer: Answer | TestudoError) -> None:
    with query:
        try:
            if not isinstance(answer, TestudoError):
                query.reply(key, sendable(answer_to_bytes(answer)))
                return
        except LinkError as error:
            answer = error
        except zenoh.ZError:
            # Who asked is gone, or the session is closed.
            return
        try:
            query.reply_err(packed(answer_to_bytes(answer)))
        except zenoh.ZError:
            return


def sendable(data: bytes) -> bytes:
    """``data`` compressed. Raises ``LinkError`` where it is too large for one message all the same."""
    sent = packed(data)
    if len(sent) > MAX_SENT_BYTES:
        raise LinkError(f"{len(sent)} bytes, compressed, are too many for a question or an answer")
    return sent
