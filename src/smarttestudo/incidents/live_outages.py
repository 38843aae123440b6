# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Keeps what an operator's end missed in an outage, for who comes back and asks for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import partial
from pathlib import Path

from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.mcap.writer import McapWriter, complete_files
from smarttestudo.domain.errors import TestudoError, said
from smarttestudo.domain.incident import OUTAGE_NAME, OUTAGE_RULE, IncidentRecord, IncidentTopic, Missing
from smarttestudo.domain.link import MessageOrigin, MissedMessage, OutgoingLink
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, not_written
from smarttestudo.incidents.background import TaskThread
from smarttestudo.incidents.folder import (
    ChannelOf,
    channel_of,
    finish_folder,
    finished_record,
    free_reserve,
    make_reserve,
    spanning,
    unused_name,
    write_record,
)
from smarttestudo.incidents.live_incidents import SourceChannels, delete_for_room
from smarttestudo.incidents.missing import LostMessages, missing_text
from smarttestudo.incidents.store import remove_begun
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
        self._channels = SourceChannels(robot)
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
        self._channels.on_source(topic, source, now_ns)

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


class OutageFolder:
    """A rosbag2 of the messages from ``from_ns`` on that an operator's end missed, below ``folder``.

    They come in the order in which they were missed; in the one file, readers find that of their stamps. It
    has its name when the outage is over; until then it is hidden, and a killed run's is completed by the
    next. ``channels`` are the topics by name, which may grow; ``of_message`` is the channel of a topic's
    message of some stamp, where that may change. What cannot be written ends it: messages after that are
    counted. Raises ``OutputFileError``.
    """

    def __init__(
        self,
        folder: Path,
        channels: Mapping[str, StoredChannel],
        from_ns: int,
        rules_sha256: str,
        *,
        of_message: ChannelOf | None = None,
    ) -> None:
        name = unused_name(folder, OUTAGE_NAME, from_ns)
        self._channels = channels
        self._of_message = of_message or channel_of(channels)
        self._lost = LostMessages()
        self._has_failed = False
        self._target = folder / name
        self._path = folder / f".{name}{PARTIAL_SUFFIX}"
        self._file_name = f"{name}_0.mcap"
        self._record = IncidentRecord(
            name=OUTAGE_NAME,
            rule=OUTAGE_RULE,
            path="",
            line=0,
            triggered_ns=from_ns,
            from_ns=from_ns,
            to_ns=from_ns,
            values={},
            rules_sha256=rules_sha256,
            topics={},
        )
        try:
            self._path.mkdir(parents=True)
            make_reserve(self._path, channels)
            # What a killed run leaves says what it was.
            write_record(self._path, self._record)
            self._writer = McapWriter(self._path / self._file_name)
        except (OSError, TestudoError) as error:
            with suppress(OSError):
                remove_begun(self._path)
            if isinstance(error, TestudoError):
                raise
            raise not_written(self._target, "an outage", error) from error

    def write(self, message: MissedMessage) -> None:
        """Keep a message."""
        channel = self._of_message(message.origin.topic, message.origin.stamp_ns)
        if channel is None:
            return
        topic, stamp_ns = message.origin.topic, message.origin.stamp_ns
        if self._has_failed:
            self._lost.add(topic, stamp_ns)
            return
        try:
            self._writer.write(channel, stamp_ns, message.payload)
        except OSError as error:
            self._has_failed = True
            self._writer.abandon()
            self._lost.add(topic, stamp_ns)
            raise not_written(self._target, "an outage", error) from error

    @property
    def missing(self) -> tuple[Missing, ...]:
        """Messages that could not be written."""
        return self._lost.missing()

    def end(self) -> Path:
        """The outage is over; where its folder is."""
        try:
            if self._has_failed:
                free_reserve(self._path)
            contents = (
                complete_files(self._path) if self._has_failed else {self._file_name: self._writer.close()}
            )
            (content,) = contents.values()
            record = replace(
                spanning(self._record, [content] if content.message_count else []),
                topics={
                    topic: IncidentTopic(type_name="", messages=0, size_bytes=0)
                    for topic in (*content.messages, *(missing.topic for missing in self.missing))
                },
                missing=self.missing,
            )
            record = finished_record(record, contents, self._channels)
            finish_folder(self._path, record, contents, self._channels)
            free_reserve(self._path)
            return self._path.rename(self._target)
        except OSError as error:
            raise not_written(self._target, "an outage", error) from error
