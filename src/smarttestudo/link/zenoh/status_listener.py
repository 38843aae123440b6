# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Hears the statuses of robots over their links; a full one is asked for where one was missed."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import zenoh

from smarttestudo.domain.errors import LinkError
from smarttestudo.link.protocol.status_stream import Record, StatusReceiver
from smarttestudo.link.zenoh.compression import unpacked
from smarttestudo.link.zenoh.keys import ALL_STATUSES, MAX_ROBOTS, Boot, boot_of

Heard = Callable[[Boot, Record, int], None]
"""Takes a robot's status and the size of what it travelled as; called by threads of Zenoh."""

_AGAIN_S, _LONGEST_AGAIN_S = 1.0, 8.0
"""When to ask again for a full status, twice as late each time."""
_ANSWER_WITHIN_S = 5.0
_LOOK_PERIOD_S = 60.0
_END_WITHIN_S = 5.0


@dataclass(slots=True, eq=False)
class _Listening:
    """One run of a robot's end."""

    boot: Boot
    receiver: StatusReceiver = field(default_factory=lambda: StatusReceiver(unpacked))
    lock: threading.Lock = field(default_factory=threading.Lock)
    ask_s: float = 0.0
    again_s: float = _AGAIN_S


class StatusListener:
    """Hears the robots that were added. ``garbage`` counts what came on their keys and is no status."""

    def __init__(self, session: zenoh.Session, heard: Heard) -> None:
        self.garbage = 0
        self._session = session
        self._heard = heard
        self._robots: dict[Boot, _Listening] = {}
        self._news = threading.Event()
        self._is_closed = False
        # Undeclared where nobody holds it.
        self._kept = session.declare_subscriber(ALL_STATUSES, self._receive)
        self._thread = threading.Thread(target=self._run, name="link-status", daemon=True)
        self._thread.start()

    def add(self, boot: Boot) -> None:
        """Hear a run of a robot's end from now on, unless there are too many already."""
        if len(self._robots) < MAX_ROBOTS:
            self._robots.setdefault(boot, _Listening(boot))
            self._news.set()

    def remove(self, boot: Boot) -> None:
        """Hear it no more."""
        self._robots.pop(boot, None)

    def close(self) -> None:
        """Ask nothing more; the session is to be closed then."""
        self._is_closed = True
        self._news.set()
        self._thread.join(_END_WITHIN_S)

    def _receive(self, sample: zenoh.Sample) -> None:
        boot = boot_of(str(sample.key_expr))
        robot = None if boot is None else self._robots.get(boot)
        if robot is not None and sample.kind == zenoh.SampleKind.PUT:
            self._take(robot, sample.payload.to_bytes())

    def _take(self, robot: _Listening, data: bytes) -> None:
        with robot.lock:
            try:
                record = robot.receiver.take(data)
            except LinkError:
                record = None
                self.garbage += 1
            if record is not None:
                robot.again_s = _AGAIN_S
                self._heard(robot.boot, record, len(data))
        if robot.receiver.needs_full:
            self._news.set()

    def _run(self) -> None:
        while not self._is_closed:
            self._news.clear()
            now_s = time.monotonic()
            wait_s = _LOOK_PERIOD_S
            for robot in [*self._robots.values()]:
                if robot.receiver.needs_full:
                    if now_s >= robot.ask_s:
                        robot.ask_s = now_s + robot.again_s
                        robot.again_s = min(2 * robot.again_s, _LONGEST_AGAIN_S)
                        self._ask(robot)
                    wait_s = min(wait_s, robot.ask_s - now_s)
            self._news.wait(max(wait_s, 0.0))

    def _ask(self, robot: _Listening) -> None:
        def answered(reply: zenoh.Reply) -> None:
            if reply.ok is not None:
                self._take(robot, reply.ok.payload.to_bytes())

        try:
            # The answer is dropped, too, rather than wait for a full link; then it is asked for again.
            self._session.get(
                robot.boot.status_key,
                answered,
                timeout=_ANSWER_WITHIN_S,
                congestion_control=zenoh.CongestionControl.DROP,
            )
        except zenoh.ZError:
            # It is asked again, unless the session is closed.
            return
