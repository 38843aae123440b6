# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Zenoh sessions that meet in memory: what one sends, the others have when the call returns.

Who connects to an endpoint meets who listens there, and whoever those meet. An answer that does not come is
waited for until ``pass_time``.
"""

from __future__ import annotations

import json
import threading
import weakref
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from enum import Enum
from functools import lru_cache
from typing import Any, NamedTuple

import pytest
import zenoh

from smarttestudo.cli import incidents as incidents_command
from smarttestudo.link.zenoh import incidents, statuses, transfer

__all__ = ["network", "virtual_time"]


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch) -> Network:
    """What ``zenoh.open`` opens sessions in."""
    made = Network()
    monkeypatch.setattr(zenoh, "open", made.open)
    return made


@pytest.fixture
def virtual_time(monkeypatch: pytest.MonkeyPatch) -> VirtualTime:
    """The time of who lists, fetches and watches."""
    time = VirtualTime()
    for module in (incidents, incidents_command, statuses, transfer):
        monkeypatch.setattr(module, "time", time)
    return time


_key = lru_cache(maxsize=10_000)(zenoh.KeyExpr)


class _Kind(Enum):
    SUBSCRIBER = "subscriber"
    QUERYABLE = "queryable"
    TOKEN = "token"
    TOKENS = "who hears of tokens"
    MATCHING = "who hears of subscribers"


class Sample(NamedTuple):
    """What arrives."""

    key_expr: zenoh.KeyExpr
    payload: zenoh.ZBytes
    kind: zenoh.SampleKind = zenoh.SampleKind.PUT


class Reply(NamedTuple):
    """An answer, or why there is none."""

    ok: Sample | None = None
    err: Sample | None = None


class Matching(NamedTuple):
    """Whether somebody subscribes."""

    matching: bool


class VirtualTime:
    """What a module has as ``time``: sleeping takes none, and ``acts`` are done when they are due.

    Of this time, each look at it takes ``look_s``.
    """

    def __init__(self, look_s: float = 0.0) -> None:
        self.look_s = look_s
        self.now_s = 1_000.0
        self.acts: list[tuple[float, Callable[[], object]]] = []

    def monotonic(self) -> float:
        self.now_s += self.look_s
        return self.now_s

    def monotonic_ns(self) -> int:
        return int(self.now_s * 1e9)

    def later(self, seconds: float, act: Callable[[], object]) -> None:
        self.acts.append((self.now_s + seconds, act))

    def sleep(self, seconds: float) -> None:
        self.now_s += seconds
        due = [one for one in self.acts if one[0] <= self.now_s]
        self.acts = [one for one in self.acts if one not in due]
        for _, act in due:
            act()


class Network:
    """The sessions that are open."""

    def __init__(self) -> None:
        self.sessions: list[Session] = []
        self._lock = threading.RLock()

    def open(self, config: zenoh.Config) -> Session:
        """As ``zenoh.open``."""
        session = Session(self, config)
        if json.loads(config.get_json("mode")) == "client" and not any(map(session.meets, self.sessions)):
            raise zenoh.ZError("nobody is there")
        self.sessions.append(session)
        self.settle()
        return session

    def reached(self, session: Session) -> list[Session]:
        """The sessions that hear of ``session``, itself included."""
        found = [session] if session in self.sessions else []
        for one in found:
            found += [other for other in [*self.sessions] if other not in found and one.meets(other)]
        return found

    def found(self, session: Session, kind: _Kind, key: zenoh.KeyExpr) -> list[Declared]:
        """What was declared of a kind on ``key`` where it reaches ``session``."""
        return [
            one
            for other in self.reached(session)
            for one in [*other.declared]
            if one.kind is kind and one.key.intersects(key)
        ]

    def settle(self) -> None:
        """Have everybody hear who came and who left."""
        with self._lock:
            for session in [*self.sessions]:
                for one in [*session.declared]:
                    one.settle()

    def pass_time(self, seconds: float) -> None:
        """Have questions time out that wait for so long."""
        for session in self.sessions:
            for asked in [*session.asked]:
                asked.pass_time(seconds)


@dataclass(eq=False)
class Declared:
    """Something that a session declared."""

    session: Session
    kind: _Kind
    key: zenoh.KeyExpr
    call: Callable[[Any], None]
    seen: set[str] = field(default_factory=set)

    def __enter__(self) -> Declared:
        return self

    def __exit__(self, *_: object) -> None:
        self.undeclare()

    def settle(self) -> None:
        """Hear what changed."""
        if self.kind not in (_Kind.TOKENS, _Kind.MATCHING):
            return
        wanted = _Kind.TOKEN if self.kind is _Kind.TOKENS else _Kind.SUBSCRIBER
        there = {str(one.key) for one in self.session.network.found(self.session, wanted, self.key)}
        seen, self.seen = self.seen, there
        if self.kind is _Kind.MATCHING:
            if bool(there) != bool(seen):
                self.call(Matching(bool(there)))
            return
        for keys, kind in ((seen - there, zenoh.SampleKind.DELETE), (there - seen, zenoh.SampleKind.PUT)):
            for key in sorted(keys):
                self.call(Sample(_key(key), zenoh.ZBytes(b""), kind))

    def undeclare(self) -> None:
        """Take it back."""
        self.session.declared.remove(self)
        self.session.network.settle()


class Session:
    """As ``zenoh.Session``, of which it has what a link uses."""

    def __init__(self, network: Network, config: zenoh.Config) -> None:
        ends = [json.loads(config.get_json(f"{side}/endpoints")) for side in ("listen", "connect")]
        self.listens, self.connects = (set(one) if isinstance(one, list) else set() for one in ends)
        self.network = network
        self.declared: list[Declared] = []
        self.queries: weakref.WeakSet[Query] = weakref.WeakSet()
        self.asked: list[Asked] = []
        self.info = self

    def meets(self, other: Session) -> bool:
        """Whether one of both connects to the other."""
        return bool(self.listens & other.connects or self.connects & other.listens)

    def peers_zid(self) -> list[Session]:
        """Who is connected."""
        return self.network.reached(self)[1:]

    routers_zid = peers_zid

    def liveliness(self) -> Liveliness:
        return Liveliness(self)

    def declare(self, kind: _Kind, key: str, call: Callable[[Any], None] = lambda _: None) -> Declared:
        """Have all hear of it."""
        one = Declared(self, kind, _key(key), call)
        self.declared.append(one)
        self.network.settle()
        return one

    def declare_subscriber(self, key: str, call: Callable[[Any], None]) -> Declared:
        return self.declare(_Kind.SUBSCRIBER, key, call)

    def declare_queryable(self, key: str, call: Callable[[Any], None]) -> Declared:
        return self.declare(_Kind.QUERYABLE, key, call)

    def declare_publisher(self, key: str, **_: object) -> Publisher:
        return Publisher(self, key)

    def put(self, key: str, payload: bytes, **_: object) -> None:
        sample = Sample(_key(key), zenoh.ZBytes(payload))
        for one in self.network.found(self, _Kind.SUBSCRIBER, sample.key_expr):
            one.call(sample)

    def get(
        self,
        key: str,
        handler: Any = None,
        *,
        payload: bytes | None = None,
        timeout: float = 10.0,
        **_: object,
    ) -> Iterator[Reply]:
        asked = Asked(self, handler, timeout)
        for one in self.network.found(self, _Kind.QUERYABLE, _key(key)):
            one.call(Query(asked, one.session, key, payload))
        asked.forget()
        return asked.answers()

    def close(self) -> None:
        """Leave; what was asked here has no answer."""
        if self in self.network.sessions:
            self.network.sessions.remove(self)
            for query in [*self.queries]:
                query.drop()
            self.network.settle()


class Liveliness:
    def __init__(self, session: Session) -> None:
        self._session = session

    def declare_token(self, key: str) -> Declared:
        return self._session.declare(_Kind.TOKEN, key)

    def declare_subscriber(self, key: str, call: Callable[[Any], None], *, history: bool) -> Declared:
        assert history
        return self._session.declare(_Kind.TOKENS, key, call)

    def get(self, key: str, handler: Any, **_: object) -> None:
        for one in self._session.network.found(self._session, _Kind.TOKEN, _key(key)):
            handler(Reply(ok=Sample(one.key, zenoh.ZBytes(b""))))
        handler.drop()


class Publisher:
    """As ``zenoh.Publisher``."""

    def __init__(self, session: Session, key: str) -> None:
        self._session = session
        self._key = key

    def put(self, payload: bytes) -> None:
        self._session.put(self._key, payload)

    @property
    def matching_status(self) -> Matching:
        return Matching(bool(self._session.network.found(self._session, _Kind.SUBSCRIBER, _key(self._key))))

    def declare_matching_listener(self, call: Callable[[Any], None]) -> Declared:
        return self._session.declare(_Kind.MATCHING, self._key, call)


class Asked:
    """The questions of one ``get``, which is over once each was answered or dropped."""

    def __init__(self, session: Session, handler: Any, left_s: float) -> None:
        self.replies: list[Reply] = []
        self.ended = threading.Event()
        self._session = session
        self._handler = handler
        self._left_s = left_s
        # Whoever puts the questions holds one.
        self._open = 1
        session.asked.append(self)

    def answers(self) -> Iterator[Reply]:
        """The answers, once they are all there."""
        self.ended.wait(self._left_s)
        yield from self.replies

    def begin(self) -> None:
        """Wait for another question."""
        self._open += 1

    def reply(self, reply: Reply) -> None:
        """Have an answer, unless it is over."""
        if not self.ended.is_set():
            self.replies.append(reply)
            if self._handler is not None:
                self._handler(reply)

    def forget(self) -> None:
        """Wait for a question no more."""
        self._open -= 1
        if self._open <= 0 and not self.ended.is_set():
            self.ended.set()
            self._session.asked.remove(self)
            if self._handler is not None:
                self._handler.drop()

    def pass_time(self, seconds: float) -> None:
        """Be over where that is longer than answers are waited for."""
        self._left_s -= seconds
        if self._left_s <= 0:
            self._open = 1
            self.forget()


class Query:
    """As ``zenoh.Query``."""

    def __init__(self, asked: Asked, owner: Session, key: str, payload: bytes | None) -> None:
        self.key_expr = _key(key)
        self.payload = None if payload is None else zenoh.ZBytes(payload)
        self._asked: Asked | None = asked
        asked.begin()
        owner.queries.add(self)

    def __enter__(self) -> Query:
        return self

    def __exit__(self, *_: object) -> None:
        self.drop()

    def reply(self, key: str, payload: bytes, **_: object) -> None:
        if self._asked is None:
            raise zenoh.ZError("who asked is gone")
        self._asked.reply(Reply(ok=Sample(_key(key), zenoh.ZBytes(payload))))

    def reply_err(self, payload: bytes) -> None:
        if self._asked is not None:
            self._asked.reply(Reply(err=Sample(self.key_expr, zenoh.ZBytes(payload))))

    def drop(self) -> None:
        """Answer no more."""
        asked, self._asked = self._asked, None
        if asked is not None:
            asked.forget()

    __del__ = drop
