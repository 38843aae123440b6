# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Keeps what an operator's end missed in an outage, for who comes back and asks for it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from smarttestudo.domain.errors import said
from smarttestudo.domain.link import MessageOrigin, MissedMessage, OutgoingLink
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.incidents.outage_folder import OutageFolder
from smarttestudo.incidents.task_thread import TaskThread
from smarttestudo.loop.relay import Relayed
from smarttestudo.robot.heard_channels import HeardChannels
from smarttestudo.robot.incidents import IncidentOptions, delete_for_room
from smarttestudo.robot.topic import LiveSource

FOLDER_NS = 600 * NS_PER_S
MAX_FOLDERS = 6
"""An outage of more than so many folders is kept no further."""


class LiveOutages:
    """Has ``link`` keep what is missed, and a thread of its own write it below ``options``.

    Nothing of it stops the relays.
    """

    def __init__(self, robot: Robot, link: OutgoingLink, options: IncidentOptions) -> None:
        assert options.folder is not None
        self._robot = robot
        self._link = link
        self._folder: Path = options.folder
        self._options = options
        self._channels = HeardChannels(robot)
        self._origin: MessageOrigin | None = None
        self._rules_hash = ""
        self._begun_ns: int | None = None
        self._folders = 0
        self._thread = TaskThread("outages", self._failed)
        # The thread that writes has this.
        self._open: OutageFolder | None = None
        link.keep_missed(lambda: self._origin)

    @contextmanager
    def running(self) -> Iterator[None]:
        """Write during the block; an outage that lasts ends with it."""
        with self._thread.running():
            try:
                yield
            finally:
                self._keep(self._link.take_missed(is_last=True))
                self._end()

    def hear(self, topic: str, source: LiveSource) -> None:
        """Messages of ``source`` are relayed from now on, if they were not before."""
        self._channels.hear(topic, source)

    def publish(self, relayed: Relayed, publish: Callable[[Relayed], None]) -> None:
        """Have a message sent, and kept under the name of its source where it is missed."""
        if not relayed.repeated:
            self._origin = MessageOrigin(topic=relayed.topic, stamp_ns=self._robot.now_ns())
        try:
            publish(relayed)
        finally:
            self._origin = None

    def look(self, rules_hash: str, *, is_connected: bool) -> None:
        """Keep what was missed; to be called a few times a second."""
        self._rules_hash = rules_hash
        self._keep(self._link.take_missed())
        if is_connected:
            self._end()
            self._folders = 0
        elif self._begun_ns is not None and self._robot.now_ns() - self._begun_ns > FOLDER_NS:
            self._end()

    def _keep(self, missed: Sequence[MissedMessage]) -> None:
        if not missed or self._folders > MAX_FOLDERS:
            return
        if self._begun_ns is None:
            self._folders += 1
            if self._folders > MAX_FOLDERS:
                self._robot.log.warning("the outage lasts so long that what is missed is kept no more")
                return
            self._begun_ns = self._robot.now_ns()
            from_ns = min(one.origin.stamp_ns for one in missed)
            self._thread.give(partial(self._open_folder, from_ns, self._rules_hash))
        self._thread.give(partial(self._write, missed))

    def _open_folder(self, from_ns: int, rules_hash: str) -> None:
        self._open = OutageFolder(self._folder, self._channels.by_topic, from_ns, rules_hash)

    def _write(self, missed: Sequence[MissedMessage]) -> None:
        if self._open is not None:
            for message in missed:
                self._open.take(message)

    def _end(self) -> None:
        if self._begun_ns is not None:
            self._begun_ns = None
            self._thread.give(self._end_folder)

    def _end_folder(self) -> None:
        folder, self._open = self._open, None
        if folder is None:
            return
        path = folder.end()
        self._robot.log.info(f"outage {path.name}: kept for who asks with 'testudo receive --catch-up'")
        delete_for_room(self._robot, self._options)

    def _failed(self, error: Exception) -> None:
        # The next outage is tried.
        self._open = None
        self._robot.log.warning(f"an outage is not kept any further: {said(error)}")
