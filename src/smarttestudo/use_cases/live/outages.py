# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Keeps what the rules let pass while no operator's end is there, for who comes back and asks for it."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from smarttestudo.adapters.incidents.outage_folder import OutageFolder
from smarttestudo.adapters.incidents.task_thread import TaskThread
from smarttestudo.domain.errors import said
from smarttestudo.domain.link_state import LinkState
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.runtime.incidents.topic_ring import SourceMessage
from smarttestudo.runtime.relay import Relayed
from smarttestudo.use_cases.live.heard_channels import HeardChannels
from smarttestudo.use_cases.live.incidents import IncidentOptions, delete_for_room
from smarttestudo.use_cases.live.topic import LiveSource

BEFORE_NS = 5 * NS_PER_S
"""An outage is noticed after three seconds; what was sent shortly before it may not have arrived."""
FOLDER_NS = 600 * NS_PER_S
MAX_FOLDERS = 6
"""An outage of more than so many folders is kept no further."""
_MAX_RECENT_BYTES = 16_000_000


class LiveOutages:
    """Given all that is relayed; while nobody receives it, a thread of its own writes it below ``options``.

    It begins once an operator's end was there. Nothing of it stops the relays.
    """

    def __init__(self, robot: Robot, options: IncidentOptions) -> None:
        assert options.folder is not None
        self._robot = robot
        self._folder: Path = options.folder
        self._options = options
        self._channels = HeardChannels(robot)
        self._recent: deque[SourceMessage] = deque()
        self._recent_bytes = 0
        self._number = 0
        self._was_connected = False
        self._sessions = 0
        self._begun_ns: int | None = None
        self._folders = 0
        self._thread = TaskThread("outages", self._failed)
        # The thread that writes has this.
        self._open: OutageFolder | None = None

    @contextmanager
    def running(self) -> Iterator[None]:
        """Write during the block; an outage that lasts ends with it."""
        with self._thread.running():
            try:
                yield
            finally:
                if self._begun_ns is not None:
                    self._thread.give(partial(self._end, self._robot.now_ns()))

    def hear(self, topic: str, source: LiveSource) -> None:
        """Messages of ``source`` are relayed from now on, if they were not before."""
        self._channels.hear(topic, source)

    def take(self, relayed: Relayed) -> None:
        """A message passed; it is kept under the name of its source."""
        if relayed.repeated:
            return
        self._number += 1
        now_ns = self._robot.now_ns()
        message = SourceMessage(self._number, relayed.topic, now_ns, relayed.payload[:])
        if self._begun_ns is not None:
            self._thread.give(partial(self._write, message))
            return
        self._recent.append(message)
        self._recent_bytes += message.held_bytes
        while self._recent and (
            self._recent[0].stamp_ns < now_ns - BEFORE_NS or self._recent_bytes > _MAX_RECENT_BYTES
        ):
            self._recent_bytes -= self._recent.popleft().held_bytes

    def look(self, rules_hash: str, link: LinkState) -> None:
        """Whether an operator's end is there; to be called a few times a second."""
        now_ns = self._robot.now_ns()
        # One may have come and left since the last call.
        if link.is_connected or link.sessions != self._sessions:
            self._sessions = link.sessions
            self._was_connected, self._folders = True, 0
        if link.is_connected:
            if self._begun_ns is not None:
                self._thread.give(partial(self._end, now_ns))
                self._begun_ns = None
            return
        if self._begun_ns is not None and now_ns - self._begun_ns > FOLDER_NS:
            self._thread.give(partial(self._end, now_ns))
            self._begun_ns = None
            if self._folders >= MAX_FOLDERS:
                self._was_connected = False
                self._robot.log.warning("the outage lasts so long that what passes is kept no more")
        if self._begun_ns is None and self._was_connected:
            self._begin(rules_hash, now_ns)

    def _begin(self, rules_hash: str, now_ns: int) -> None:
        recent = list(self._recent)
        self._recent.clear()
        self._recent_bytes = 0
        self._begun_ns = now_ns
        self._folders += 1
        from_ns = recent[0].stamp_ns if recent else now_ns
        self._thread.give(partial(self._open_folder, from_ns, rules_hash, recent))

    def _open_folder(self, from_ns: int, rules_hash: str, recent: list[SourceMessage]) -> None:
        self._open = OutageFolder(self._folder, self._channels.by_topic, from_ns, rules_hash)
        for message in recent:
            self._open.take(message)

    def _write(self, message: SourceMessage) -> None:
        if self._open is not None:
            self._open.take(message)

    def _end(self, to_ns: int) -> None:
        folder, self._open = self._open, None
        if folder is None:
            return
        path = folder.end(to_ns)
        self._robot.log.info(f"outage {path.name}: kept for who asks with 'testudo receive --catch-up'")
        delete_for_room(self._robot, self._options)

    def _failed(self, error: Exception) -> None:
        # The next outage is tried.
        self._open = None
        self._robot.log.warning(f"an outage is not kept any further: {said(error)}")
