# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A Zenoh client that watches robots and asks them, connected again and again without a hand."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from functools import partial

import zenoh

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.questions import Question
from smarttestudo.domain.remote_robots import ANSWER_WITHIN_S
from smarttestudo.link.protocol.question_messages import (
    MAX_QUESTION_BYTES,
    error_from_bytes,
    question_to_bytes,
)
from smarttestudo.link.zenoh.asked_questions import sendable
from smarttestudo.link.zenoh.compression import unpacked
from smarttestudo.link.zenoh.keys import ALL_BOOTS, Boot, boot_of
from smarttestudo.link.zenoh.reach import why_unreachable
from smarttestudo.link.zenoh.session import close_session
from smarttestudo.link.zenoh.status_listener import Heard, StatusListener

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

    def begin(self, heard: Heard | None, present: Present, all_known: Callable[[], None]) -> None:
        """Connect; say what is heard, who is there, and once that these are all who were there before.

        Without ``heard``, no statuses are asked for.
        """
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

        def unpack(reply: Reply) -> None:
            try:
                answered(unpacked(reply, MAX_QUESTION_BYTES) if isinstance(reply, bytes) else reply)
            except LinkError as error:
                answered(error)

        try:
            payload = sendable(question_to_bytes(question))
        except LinkError as error:
            answered(error)
            return
        self.get(key, payload, unpack, ANSWER_WITHIN_S)

    def get(self, key: str, payload: bytes, answered: Callable[[Reply], None], timeout_s: float) -> None:
        """Have ``answered`` called once with the bytes that came as the reply, by any thread.

        The answer has a low priority, too: messages of the robot's topics go before a long one.
        """
        session = self._session
        if session is None:
            answered(None)
        else:
            _get(session, key, payload, answered, timeout_s)

    def _run(self, heard: Heard | None, present: Present, all_known: Callable[[], None]) -> None:
        session = self._open()
        if session is None:
            return
        listener = None
        try:
            listener = None if heard is None else StatusListener(session, heard)
            self._session = session
            self._kept = _watched(session, partial(_followed, listener, present), all_known)
            while not self._is_closed.wait(_LOOK_PERIOD_S):
                is_connected = bool(session.info.routers_zid() or session.info.peers_zid())
                self.problem = None if is_connected else self._why()
        except zenoh.ZError as error:
            self.problem = f"{', '.join(self._endpoints)}: {error}"
        finally:
            self._session = None
            if listener is not None:
                listener.close()
            close_session(session)

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


class SessionClient:
    """The same over a ``session`` of somebody else, without statuses."""

    problem = None

    def __init__(self, session: zenoh.Session) -> None:
        self._session = session
        self._kept: object = None

    def begin(self, _heard: None, present: Present, all_known: Callable[[], None]) -> None:
        """Say who is there, and once that these are all who were there before."""
        self._kept = _watched(self._session, present, all_known)

    def get(self, key: str, payload: bytes, answered: Callable[[Reply], None], timeout_s: float) -> None:
        """As ``LinkClient.get``."""
        _get(self._session, key, payload, answered, timeout_s)

    def close(self) -> None:
        """The session is closed by who opened it."""
        self._kept = None


def _watched(session: zenoh.Session, present: Present, all_known: Callable[[], None]) -> object:
    """Say who is there; what is returned is undeclared where nobody holds it."""
    look, liveliness = partial(_look_at_boot, present), session.liveliness()
    kept = liveliness.declare_subscriber(ALL_BOOTS, look, history=True)
    handler = zenoh.handlers.Callback(partial(_look_at_reply, look), all_known)
    liveliness.get(ALL_BOOTS, handler, timeout=ANSWER_WITHIN_S)
    return kept


def _followed(listener: StatusListener | None, present: Present, boot: Boot, is_present: bool) -> None:  # noqa: FBT001 - as Present
    """Hear the statuses of who is there, before that is said."""
    if listener is not None:
        (listener.add if is_present else listener.remove)(boot)
    present(boot, is_present)


def _look_at_boot(present: Present, sample: zenoh.Sample) -> None:
    boot = boot_of(str(sample.key_expr))
    if boot is not None:
        present(boot, sample.kind == zenoh.SampleKind.PUT)


def _get(
    session: zenoh.Session, key: str, payload: bytes, answered: Callable[[Reply], None], timeout_s: float
) -> None:
    replies: list[Reply] = []

    def take(reply: zenoh.Reply) -> None:
        replies.append(_reply(reply))

    def ended() -> None:
        answered(next((one for one in replies if one is not None), None))

    try:
        handler = zenoh.handlers.Callback(take, ended)
        session.get(key, handler, payload=payload, timeout=timeout_s, priority=zenoh.Priority.DATA_LOW)
    except zenoh.ZError:
        answered(None)


def _look_at_reply(look: Callable[[zenoh.Sample], None], reply: zenoh.Reply) -> None:
    if reply.ok is not None:
        look(reply.ok)


def _reply(reply: zenoh.Reply) -> Reply:
    if reply.ok is not None:
        return bytes(reply.ok.payload.to_bytes())
    try:
        return (
            None
            if reply.err is None
            else error_from_bytes(unpacked(reply.err.payload.to_bytes(), MAX_QUESTION_BYTES))
        )
    except LinkError:
        # Zenoh itself says so where nobody answers in time.
        return None
