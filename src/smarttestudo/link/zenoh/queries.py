# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions to robots' ends of links: who asks, and who answers."""

from __future__ import annotations

import queue
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import zenoh

from smarttestudo.domain.errors import LinkError, TestudoError, said, testudo_error
from smarttestudo.domain.parameter import Answer, Question
from smarttestudo.domain.remote_robots import ANSWER_WITHIN_S
from smarttestudo.domain.units import ns_from_s
from smarttestudo.link.protocol.keys import ALL_BOOTS, Boot, boot_of
from smarttestudo.link.protocol.messages import (
    ANSWERS,
    CHANGING_QUESTIONS,
    MAX_QUESTION_BYTES,
    READING_QUESTIONS,
    REFUSALS,
    NoAnswer,
)
from smarttestudo.link.protocol.wire import FrameType, other_version, version_sentence
from smarttestudo.link.worker import Worker
from smarttestudo.link.zenoh.compression import packed, sendable, unpacked
from smarttestudo.link.zenoh.session import OPERATOR, LinkSession, OtherVersions, robot_peer

MAX_WAITING = 32
"""How many questions of one kind wait for an answer."""
_WAITS_NS = ns_from_s(ANSWER_WITHIN_S)
_Asked = TypeVar("_Asked", bound=Question)


class Query:
    """A question as ``data``, which any thread may answer, once; who asked or the session may be gone."""

    def __init__(self, query: zenoh.Query, key: str, data: bytes) -> None:
        self.data = data
        self._query = query
        self._key = key

    def attempt(self, act: Callable[[], object]) -> None:
        """Do something for an answer, or say why there is none."""
        try:
            act()
        except Exception as error:  # noqa: BLE001 - whatever a stranger asks, others are answered
            self.refuse(testudo_error(error))

    def reply(self, data: bytes) -> None:
        """Answer with a frame. It waits where the link is thin."""
        with self._query, suppress(zenoh.ZError):
            self._query.reply(self._key, data)

    def reply_part(self, data: bytes) -> bool:
        """Answer with a frame that others may follow; whether that was possible. It waits as ``reply``."""
        with suppress(zenoh.ZError):
            self._query.reply(self._key, data, express=True)
            return True
        return False

    def refuse(self, error: TestudoError) -> None:
        with self._query, suppress(zenoh.ZError):
            self._query.reply_err(packed(REFUSALS.to_bytes(NoAnswer.of(error))))

    def drop(self) -> None:
        """Answer nothing; who asked asks again."""
        self._query.drop()


@dataclass(frozen=True, slots=True, kw_only=True)
class WaitingQuestion:
    """A question of ``asked_ns``; ``later`` has the answer given, for which nobody waits here."""

    question: Question
    asked_ns: int
    query: Query
    later: Callable[[Callable[[], None]], object]

    def answer(self, answer: Answer | TestudoError) -> None:
        """Answer it, or say why not; the session may be closed meanwhile."""
        self.later(partial(self.query.attempt, partial(self._send, answer)))

    def _send(self, answer: Answer | TestudoError) -> None:
        if isinstance(answer, TestudoError):
            raise answer
        self.query.reply(sendable(ANSWERS.to_bytes(answer)))


class QueryServer:
    """Has what is asked on keys of a robot's end handled, and answers from a thread of its own.

    Questions for the run wait until it takes them; what reads and what changes have a key each. A long answer
    waits where the link is thin. While nobody is connected, the thread watches for that.
    """

    def __init__(
        self,
        opened: LinkSession,
        boot: Boot,
        warn: Callable[[str], None],
        versions: OtherVersions,
        clock: Callable[[], int],
    ) -> None:
        self._session = opened.session
        self._versions = versions
        self._clock = clock
        self._waiting: queue.Queue[WaitingQuestion] = queue.Queue(MAX_WAITING)
        self._worker = Worker("link-answer", lambda error: warn(f"no answer: {said(error)}"), opened.watch)
        self._worker.start()
        self.close = self._worker.close
        # Kept alive: Zenoh undeclares on garbage collection.
        self._kept: list[zenoh.Queryable[None]] = []
        self.serve(boot.get_key, partial(self._keep, READING_QUESTIONS))
        self.serve(boot.set_key, partial(self._keep, CHANGING_QUESTIONS))

    def serve(self, key: str, handle: Callable[[Query], None]) -> None:
        """Give ``handle`` what is asked on ``key``, in a thread of Zenoh; a ``LinkError`` of it refuses."""

        def on_query(asked: zenoh.Query) -> None:
            # What is asked of many keys at once may go round access control.
            if str(asked.key_expr) != key:
                asked.drop()
                return
            query = Query(asked, key, b"" if asked.payload is None else asked.payload.to_bytes())
            self._versions.check(OPERATOR, query.data)
            try:
                handle(query)
            except LinkError as error:
                if not self._worker.give(partial(query.refuse, error), most=MAX_WAITING):
                    query.drop()

        self._kept.append(self._session.declare_queryable(key, on_query))

    def take_question(self) -> WaitingQuestion | None:
        """The next question; those that nobody waits for any more are left out."""
        while True:
            try:
                asked = self._waiting.get_nowait()
            except queue.Empty:
                return None
            if self._clock() - asked.asked_ns < _WAITS_NS:
                return asked

    def _keep(self, questions: FrameType[_Asked], query: Query) -> None:
        question = questions.from_bytes(unpacked(query.data, MAX_QUESTION_BYTES))
        try:
            self._waiting.put_nowait(
                WaitingQuestion(
                    question=question, asked_ns=self._clock(), query=query, later=self._worker.give
                )
            )
        except queue.Full:
            raise LinkError("too many questions wait for an answer", remedy="ask again later") from None


Reply = bytes | LinkError | None
"""The frame that a robot answered, why it did not, or nothing where it is silent."""
OnPresence = Callable[[Boot, bool], None]
"""Takes whether a run of a robot's end is there; called by threads of Zenoh."""


class QueryClient:
    """Asks robots over ``session``, once there is one."""

    def __init__(self, session: zenoh.Session | None) -> None:
        self._session = session
        self._kept: object = None

    @property
    def problem(self) -> str | None:
        return None

    def begin(self, on_presence: OnPresence, all_known: Callable[[], None]) -> None:
        """Say who is there, and once that these are all who were there before."""
        assert self._session is not None
        liveliness = self._session.liveliness()

        def on_sample(sample: zenoh.Sample) -> None:
            boot = boot_of(str(sample.key_expr))
            if boot is not None:
                on_presence(boot, sample.kind == zenoh.SampleKind.PUT)

        def on_reply(reply: zenoh.Reply) -> None:
            if reply.ok is not None:
                on_sample(reply.ok)

        # Kept alive: Zenoh undeclares on garbage collection.
        self._kept = liveliness.declare_subscriber(ALL_BOOTS, on_sample, history=True)
        handler = zenoh.handlers.Callback(on_reply, all_known)
        liveliness.get(ALL_BOOTS, handler, timeout=ANSWER_WITHIN_S)

    def session_for(self, _key: str) -> zenoh.Session | None:
        """The session over which to ask on a key, if there is one."""
        return self._session

    def ask(
        self,
        key: str,
        payload: bytes,
        replied: Callable[[bytes | LinkError], None],
        ended: Callable[[], None],
        timeout_s: float = ANSWER_WITHIN_S,
        *,
        waits: bool = True,
    ) -> None:
        """Have ``replied`` called with each frame that answers or refuses, and ``ended`` once, by any thread.

        Question and answer wait where the link is full, and messages of the robot's topics go before them;
        or they are dropped there.
        """

        def on_reply(reply: zenoh.Reply) -> None:
            if (found := _reply(key, reply)) is not None:
                replied(found)

        session = self.session_for(key)
        if session is None:
            ended()
            return
        try:
            session.get(
                key,
                zenoh.handlers.Callback(on_reply, ended),
                payload=payload,
                timeout=timeout_s,
                consolidation=zenoh.ConsolidationMode.NONE,
                priority=zenoh.Priority.DATA_LOW if waits else zenoh.Priority.DATA,
                congestion_control=zenoh.CongestionControl.BLOCK if waits else zenoh.CongestionControl.DROP,
            )
        except zenoh.ZError:
            ended()

    def get(self, key: str, payload: bytes, answered: Callable[[Reply], None]) -> None:
        """Have ``answered`` called once with what came of a question, by any thread."""
        replies: list[Reply] = []
        self.ask(key, payload, replies.append, lambda: answered(next(iter(replies), None)))

    def close(self) -> None:
        """Leave; the session is closed by who opened it."""
        self._kept = None


def _reply(key: str, reply: zenoh.Reply) -> Reply:
    said = reply.ok or reply.err
    if said is None:
        return None
    data = bytes(said.payload.to_bytes())
    version, boot = other_version(data), boot_of(key.rpartition("/")[0])
    if version is not None and boot is not None:
        return LinkError(version_sentence(robot_peer(boot), version))
    if reply.ok is not None:
        return data
    try:
        return REFUSALS.from_bytes(unpacked(data, MAX_QUESTION_BYTES)).error()
    except LinkError:
        # Zenoh itself says so where nobody answers in time.
        return None
