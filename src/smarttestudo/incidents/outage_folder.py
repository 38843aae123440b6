# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Folder of what could not be sent during an outage, like that of an incident."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.mcap.writer import FileContent, McapWriter
from smarttestudo.bags.mcap.written_file import complete_files
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.incident import OUTAGE_NAME, OUTAGE_RULE, IncidentRecord, IncidentTopic, Missing
from smarttestudo.domain.link import MissedMessage
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, not_written
from smarttestudo.incidents.folders import (
    ChannelOf,
    channel_of,
    finish_folder,
    finished_record,
    free_reserve,
    make_reserve,
    unused_name,
    write_record,
)
from smarttestudo.incidents.lost_messages import LostMessages
from smarttestudo.incidents.store import remove_begun


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
                    for topic in (*content.messages, *(one.topic for one in self.missing))
                },
                missing=self.missing,
            )
            record = finished_record(record, contents, self._channels)
            finish_folder(self._path, record, contents, self._channels)
            free_reserve(self._path)
            return self._path.rename(self._target)
        except OSError as error:
            raise not_written(self._target, "an outage", error) from error


def spanning(record: IncidentRecord, contents: Iterable[FileContent]) -> IncidentRecord:
    """``record`` of an outage, from the first to the last message of its files, which have some."""
    listed = list(contents)
    return replace(
        record,
        from_ns=min((record.from_ns, *(one.first_ns for one in listed))),
        to_ns=max((record.to_ns, *(one.last_ns for one in listed))),
    )
