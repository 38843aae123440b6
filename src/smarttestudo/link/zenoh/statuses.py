# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Robots' statuses over Zenoh: what changed for all who listen, all of it as bytes of a name for who asks."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial

import zenoh

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.status import compact_status, is_measured
from smarttestudo.link.protocol.keys import ALL_STATUSES, MAX_ROBOTS, Boot, boot_of
from smarttestudo.link.protocol.status_stream import (
    MAX_STATUS_BYTES,
    Record,
    StatusReceiver,
    StatusSender,
)
from smarttestudo.link.transfer.messages import VERSION_BYTES, Content, WholeContent
from smarttestudo.link.zenoh.compression import compress, decompress
from smarttestudo.link.zenoh.queries import QueryClient
from smarttestudo.link.zenoh.session import OtherVersions, robot_peer
from smarttestudo.link.zenoh.transfer import ByteServer, Whole, read_whole


class StatusServer:
    """Sends each status once, however many listen; routers share it among them."""

    def __init__(
        self, session: zenoh.Session, server: ByteServer, key: str, clock: Callable[[], int]
    ) -> None:
        self.is_watched = False
        self._clock = clock
        self._sender = StatusSender(is_measured, compress)
        self._lock = threading.Lock()
        self._full: WholeContent | None = None
        # What is dropped is missed by who listens, who then asks for a full status.
        self._publisher = session.declare_publisher(
            key, congestion_control=zenoh.CongestionControl.DROP, priority=zenoh.Priority.DATA_HIGH
        )
        # Kept alive: Zenoh undeclares on garbage collection.
        self._kept = self._publisher.declare_matching_listener(self._match)
        server.offer(key, self._content)

    def tell(self, status: Mapping[str, object]) -> None:
        """Send ``status``, an object of JSON; never waits for the link."""
        with self._lock:
            data, self._full = self._sender.next(compact_status(status), self._clock()), None
        try:
            self._publisher.put(data)
        except zenoh.ZError as error:
            raise LinkError(f"no status is sent over the link: {error}") from error

    def _match(self, status: zenoh.MatchingStatus) -> None:
        self.is_watched = status.matching

    def _content(self, _name: str) -> Content:
        """All of the last status, whose version is its number."""
        with self._lock:
            if self._full is None:
                version = self._sender.number.to_bytes(VERSION_BYTES, "big")
                self._full = WholeContent(version=version, data=self._sender.full())
            return self._full


OnStatus = Callable[[Boot, Record, int], None]
"""Takes a robot's status and the size of what it travelled as; called by threads of Zenoh."""

_AGAIN_S, _LONGEST_AGAIN_S = 1.0, 8.0
"""When to ask again for a full status, twice as late each time."""
_POLL_PERIOD_S = 60.0


@dataclass(slots=True, eq=False)
class _Listening:
    """One run of a robot's end."""

    boot: Boot
    receiver: StatusReceiver = field(default_factory=lambda: StatusReceiver(decompress))
    lock: threading.Lock = field(default_factory=threading.Lock)
    ask_s: float = 0.0
    again_s: float = _AGAIN_S


class StatusListener:
    """Hears the robots that were added. ``malformed`` counts what arrived on their keys and is no status.

    ``poll`` asks for full statuses where they are missed; ``wake`` has it called at once.
    """

    def __init__(
        self, session: zenoh.Session, on_status: OnStatus, versions: OtherVersions, wake: Callable[[], None]
    ) -> None:
        self.malformed = 0
        self._client = QueryClient(session)
        self._on_status = on_status
        self._versions = versions
        self._wake = wake
        self._robots: dict[Boot, _Listening] = {}
        # Kept alive: Zenoh undeclares on garbage collection.
        self._kept = session.declare_subscriber(ALL_STATUSES, self._on_sample)

    def add(self, boot: Boot) -> None:
        """Hear a run of a robot's end from now on, unless there are too many already."""
        if len(self._robots) < MAX_ROBOTS:
            self._robots.setdefault(boot, _Listening(boot))
            self._wake()

    def remove(self, boot: Boot) -> None:
        self._robots.pop(boot, None)
        self._versions.leave(robot_peer(boot))

    def poll(self) -> float:
        """Ask for what is missed; after how many seconds to poll again."""
        now_s = time.monotonic()
        wait_s = _POLL_PERIOD_S
        for robot in [*self._robots.values()]:
            if robot.receiver.needs_full:
                if now_s >= robot.ask_s:
                    robot.ask_s = now_s + robot.again_s
                    robot.again_s = min(2 * robot.again_s, _LONGEST_AGAIN_S)
                    self._ask(robot)
                wait_s = min(wait_s, robot.ask_s - now_s)
        return max(wait_s, 0.0)

    def _ask(self, robot: _Listening) -> None:
        # What is dropped on a full link is asked for again.
        answered = partial(self._answered, robot)
        read_whole(self._client, robot.boot.status_key, MAX_STATUS_BYTES, answered)

    def _answered(self, robot: _Listening, whole: Whole) -> None:
        if isinstance(whole, WholeContent):
            number = int.from_bytes(whole.version, "big")
            self._receive(robot, len(whole.data), lambda: robot.receiver.receive_full(number, whole.data))

    def _on_sample(self, sample: zenoh.Sample) -> None:
        boot = boot_of(str(sample.key_expr))
        robot = None if boot is None else self._robots.get(boot)
        if robot is not None and sample.kind == zenoh.SampleKind.PUT:
            data = sample.payload.to_bytes()
            self._versions.check(robot_peer(robot.boot), data)
            self._receive(robot, len(data), lambda: robot.receiver.receive(data))

    def _receive(self, robot: _Listening, size_bytes: int, read: Callable[[], Record | None]) -> None:
        with robot.lock:
            try:
                record = read()
            except LinkError:
                record = None
                self.malformed += 1
            if record is not None:
                robot.again_s = _AGAIN_S
                self._on_status(robot.boot, record, size_bytes)
        if robot.receiver.needs_full:
            self._wake()
