# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A Zenoh client that watches robots and asks them, connected again and again without a hand."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from functools import partial

import zenoh

from smarttestudo.adapters.zenoh.asked_questions import sendable
from smarttestudo.adapters.zenoh.compression import unpacked
from smarttestudo.adapters.zenoh.keys import ALL_BOOTS, Boot, boot_of
from smarttestudo.adapters.zenoh.reach import why_unreachable
from smarttestudo.adapters.zenoh.status_listener import Heard, StatusListener
from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.questions import Question
from smarttestudo.domain.remote_robots import ANSWER_WITHIN_S
from smarttestudo.link.question_messages import MAX_QUESTION_BYTES, error_from_bytes, question_to_bytes

Reply = bytes | LinkError | None
"""What a robot answered, why it did not, or nothing where it is silent."""
Present = Callable[[Boot, bool], None]
"""Takes whether a run of a robot's end is there; called by threads of Zenoh."""

_TRY_AGAIN_S = 1.0
_LOOK_PERIOD_S = 2.0
_END_WITHIN_S = 5.0


class LinkClient:
    """Connects to ``endpoints`` by a Zenoh ``config`` on a thread of its own, from ``begin`` on."""

    def __init__(self, config: zenoh.Config, known: Mapping[str, object], endpoints: tuple[str, ...]) -> None:
        self.problem: str | None = f"{', '.join(endpoints)}: nobody answers yet"
        self._config = config
        self._known = known
        self._endpoints = endpoints
        self._session: zenoh.Session | None = None
        self._kept: object = None
        self._is_closed = threading.Event()
        self._thread: threading.Thread | None = None

    def begin(self, heard: Heard, present: Present, all_known: Callable[[], None]) -> None:
        """Connect; say what is heard, who is there, and once that these are all who were there before."""
        arguments = (heard, present, all_known)
        self._thread = threading.Thread(target=self._run, args=arguments, name="link-client", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Leave."""
        self._is_closed.set()
        if self._thread is not None:
            self._thread.join(_END_WITHIN_S)

    def ask(self, key: str, question: Question, answered: Callable[[Reply], None]) -> None:
        """Have ``answered`` called once with the reply, by any thread."""
        replies: list[Reply] = []

        def take(reply: zenoh.Reply) -> None:
            replies.append(_reply(reply))

        def ended() -> None:
            answered(next((one for one in replies if one is not None), None))

        session = self._session
        try:
            payload = sendable(question_to_bytes(question))
            if session is None:
                answered(None)
                return
            handler = zenoh.handlers.Callback(take, ended)
            # The answer has this priority, too: messages of the robot's topics go before a long one.
            session.get(
                key,
                handler,
                payload=payload,
                timeout=ANSWER_WITHIN_S,
                priority=zenoh.Priority.DATA_LOW,
            )
        except LinkError as error:
            answered(error)
        except zenoh.ZError:
            answered(None)

    def _run(self, heard: Heard, present: Present, all_known: Callable[[], None]) -> None:
        session = self._open()
        if session is None:
            return
        listener = None
        try:
            listener = StatusListener(session, heard)
            look = partial(self._look_at_token, listener, present)
            # Undeclared where nobody holds it.
            self._kept = session.liveliness().declare_subscriber(ALL_BOOTS, look, history=True)
            self._session = session
            handler = zenoh.handlers.Callback(partial(_look_at_reply, look), all_known)
            session.liveliness().get(ALL_BOOTS, handler, timeout=ANSWER_WITHIN_S)
            while not self._is_closed.wait(_LOOK_PERIOD_S):
                is_connected = bool(session.info.routers_zid() or session.info.peers_zid())
                self.problem = None if is_connected else self._why()
        except zenoh.ZError as error:
            self.problem = f"{', '.join(self._endpoints)}: {error}"
        finally:
            self._session = None
            if listener is not None:
                listener.close()
            session.close()

    def _open(self) -> zenoh.Session | None:
        while not self._is_closed.is_set():
            session = self._opened()
            if session is not None:
                return session
            self.problem = self._why()
            self._is_closed.wait(_TRY_AGAIN_S)
        return None

    def _opened(self) -> zenoh.Session | None:
        try:
            session = zenoh.open(self._config)
        except zenoh.ZError:
            return None
        self.problem = None
        return session

    def _why(self) -> str:
        return "; ".join(why_unreachable(endpoint, self._known) for endpoint in self._endpoints)

    def _look_at_token(self, listener: StatusListener, present: Present, sample: zenoh.Sample) -> None:
        boot = boot_of(str(sample.key_expr))
        if boot is None:
            return
        is_present = sample.kind == zenoh.SampleKind.PUT
        (listener.add if is_present else listener.remove)(boot)
        present(boot, is_present)


def _look_at_reply(look: Callable[[zenoh.Sample], None], reply: zenoh.Reply) -> None:
    if reply.ok is not None:
        look(reply.ok)


def _reply(reply: zenoh.Reply) -> Reply:
    try:
        if reply.ok is not None:
            return unpacked(reply.ok.payload.to_bytes(), MAX_QUESTION_BYTES)
        return (
            None
            if reply.err is None
            else error_from_bytes(unpacked(reply.err.payload.to_bytes(), MAX_QUESTION_BYTES))
        )
    except LinkError as error:
        # Zenoh itself says so where nobody answers in time.
        return None if reply.ok is None else error
