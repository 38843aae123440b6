# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Keeps what an operator's end missed in an outage, for who comes back and asks for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from smarttestudo.domain.errors import said
from smarttestudo.domain.link import MessageOrigin, MissedMessage, OutgoingLink
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.incidents.heard_channels import HeardChannels
from smarttestudo.incidents.live_incidents import delete_for_room
from smarttestudo.incidents.missing import missing_text
from smarttestudo.incidents.outage_folder import OutageFolder
from smarttestudo.incidents.task_thread import TaskThread
from smarttestudo.loop.relay import Relayed
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.option import Settings
from smarttestudo.robot.part import Part
from smarttestudo.robot.source import LiveSource

FOLDER_NS = 600 * NS_PER_S
MAX_FOLDERS = 6
"""An outage of more than so many folders is kept no further."""


class LiveOutages(Part):
    """Has ``link`` keep what is missed, and a thread of its own write it below ``folder``."""

    poll_s = 0.25
    needs_every_message = True

    def __init__(self, robot: Robot, link: OutgoingLink, folder: Path, settings: Settings) -> None:
        self._robot = robot
        self._link = link
        self._folder = folder
        self._settings = settings
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

    def follow(self, rules: LiveRules, now_ns: int) -> None:  # noqa: ARG002 - a part's
        """Name these rules in what is kept from now on."""
        self._rules_hash = rules.rules_hash

    def on_source(self, topic: str, source: LiveSource, now_ns: int) -> None:
        """Know the topic's type."""
        self._channels.hear(topic, source, now_ns)

    def before_publish(self, relayed: Relayed) -> None:
        """Know the source, under whose name the message is kept if it is missed."""
        if not relayed.repeated:
            self._origin = MessageOrigin(topic=relayed.topic, stamp_ns=self._robot.now_ns())

    def after_publish(self) -> None:
        """Note that what is published from now on is none of the robot's messages."""
        self._origin = None

    def poll(self) -> None:
        """Keep what was missed."""
        # What is missed only after this look, in another outage, gets a folder of its own.
        is_over = self._link.state.is_connected and self._link.is_settled
        self._keep(self._link.take_missed())
        if is_over:
            self._end()
            self._folders = 0
        elif self._begun_ns is not None and self._robot.steady_ns() - self._begun_ns > FOLDER_NS:
            self._end()

    def _keep(self, missed: Sequence[MissedMessage]) -> None:
        if not missed or self._folders > MAX_FOLDERS:
            return
        if self._begun_ns is None:
            self._folders += 1
            if self._folders > MAX_FOLDERS:
                self._robot.log.warning("the outage lasts so long that what is missed is kept no more")
                return
            self._begun_ns = self._robot.steady_ns()
            from_ns = min(one.origin.stamp_ns for one in missed)
            self._thread.give(partial(self._open_folder, from_ns, self._rules_hash))
        for message in missed:
            self._thread.give(partial(self._write, message))

    def _open_folder(self, from_ns: int, rules_hash: str) -> None:
        self._open = OutageFolder(
            self._folder, self._channels.by_topic, from_ns, rules_hash, of_message=self._channels.of
        )

    def _write(self, message: MissedMessage) -> None:
        if self._open is not None:
            self._open.write(message)

    def _end(self) -> None:
        if self._begun_ns is not None:
            self._begun_ns = None
            self._thread.give(self._end_folder)

    def _end_folder(self) -> None:
        folder, self._open = self._open, None
        if folder is None:
            return
        path = folder.end()
        lacks = f"{text}; " if (text := missing_text(folder.missing)) else ""
        log = self._robot.log.warning if lacks else self._robot.log.info
        log(f"outage {path.name}: {lacks}kept for who asks with 'testudo receive --catch-up'")
        delete_for_room(self._robot, self._settings, newest=path.name)

    def _failed(self, error: Exception) -> None:
        self._robot.log.warning(f"an outage is not kept any further: {said(error)}")
