# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A cut-off or damaged .db3 file, read as far as it goes."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing, suppress
from pathlib import Path
from urllib.parse import quote

from smarttestudo.adapters.rosbag.definitions import normal_definition
from smarttestudo.adapters.rosbag.qos import QosReader, is_transient_local
from smarttestudo.adapters.rosbag.sqlite_pages import DamagedRowError, Row, SqlitePages
from smarttestudo.adapters.rosbag.stored_file import ChannelsByNumber, Outline, outlines_of, read_so_far
from smarttestudo.adapters.rosbag.time_index import TimeIndex
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, RecordedMessage


class RecoveredSqliteFile:
    """Takes the topics from SQLite itself, and the messages from the leaf pages that are still there."""

    def __init__(self, path: Path) -> None:
        self._qos = QosReader()
        with ExitStack() as opened:
            file = opened.enter_context(path.open("rb"))
            try:
                self._pages = SqlitePages(file)
            except DamagedRowError as error:
                raise RecordingError("not a SQLite file", place=str(path)) from error
            self._index = opened.enter_context(closing(TimeIndex()))
            self.channels: ChannelsByNumber = _read_channels(path, self._qos)
            self.start_ns = self.end_ns = self.message_count = self._damaged = 0
            self._find_messages()
            self._resources = opened.pop_all()
        self._cut_off = self._pages.file_bytes < self._pages.promised_bytes

    def messages(self, channels: ChannelsByNumber) -> Iterator[RecordedMessage]:
        """Every message that is whole, in time order, each with its one of ``channels``."""
        for _, offset in self._index.places():
            message = _as_message(self._pages.row_at(offset))
            if message is not None:
                number, stamp_ns, payload = message
                yield channels[number], stamp_ns, payload

    def outlines(self, channels: ChannelsByNumber, head_bytes: int) -> Iterator[Outline]:
        """The outlines of ``messages``."""
        return outlines_of(self.messages(channels), head_bytes)

    def notices(self) -> Sequence[str]:
        """Whether the file is cut off or damaged, and how much of it was read."""
        notices = list(self._qos.notices)
        if self._cut_off:
            share = 100 * self._pages.file_bytes / self._pages.promised_bytes
            notices.append(f"cut off at {share:.0f} % of its length: {read_so_far(self)}")
        elif self._damaged:
            notices.append(f"damaged: {read_so_far(self)}, {self._damaged} rows could not")
        return notices

    def close(self) -> None:
        """Let go of the file."""
        self._resources.close()

    def _find_messages(self) -> None:
        for offset in self._pages.rows():
            try:
                row = self._pages.row_at(offset)
            except DamagedRowError:
                self._damaged += 1
                continue
            message = _as_message(row)
            if message is None or message[0] not in self.channels:
                continue
            stamp_ns = message[1]
            if self._index.add(key=row.rowid, stamp_ns=stamp_ns, offset=offset):
                self.start_ns = min(self.start_ns, stamp_ns) if self.message_count else stamp_ns
                self.end_ns = max(self.end_ns, stamp_ns) if self.message_count else stamp_ns
                self.message_count += 1


def _as_message(row: Row) -> tuple[int, int, bytes] | None:
    """Channel, stamp and payload in ``row`` if it has the columns of rosbag2's table ``messages``."""
    match row.values:
        case (_, int() as channel, int() as stamp_ns, bytes() as payload):
            return channel, stamp_ns, payload
        case _:
            return None


def _read_channels(path: Path, qos: QosReader) -> dict[int, Channel]:
    """The channels that SQLite can still read.

    ``writable_schema`` makes it open a file that is shorter than its header says.
    """
    address = f"file:{quote(str(path.absolute()))}?mode=ro&immutable=1"
    try:
        with closing(sqlite3.connect(address, uri=True)) as database:
            database.execute("PRAGMA writable_schema=ON")
            database.row_factory = sqlite3.Row
            return dict(_channels(database, qos))
    except (
        sqlite3.Error,
        UnicodeError,
        LookupError,
    ) as error:  # the latter two where column names are damaged
        raise RecordingError("no rosbag2 topics can be found in it", place=str(path)) from error


def _channels(database: sqlite3.Connection, qos: QosReader) -> Iterator[tuple[int, Channel]]:
    definitions = _definitions(database)
    rows = database.execute("SELECT * FROM topics ORDER BY id")
    with suppress(sqlite3.Error):
        for row in rows:
            columns = dict(row)
            profiles = qos.read_or_note(columns["name"], columns.get("offered_qos_profiles"))
            yield (
                columns["id"],
                Channel(
                    topic=columns["name"],
                    type_name=columns["type"],
                    definition=definitions.get(columns["type"]),
                    digest=columns.get("type_description_hash") or "",
                    qos=profiles,
                    serialization_format=columns["serialization_format"],
                    transient_local=is_transient_local(profiles),
                ),
            )


def _definitions(database: sqlite3.Connection) -> dict[str, str]:
    """Definitions by type name; none in a bag of Humble or older, which has no such table."""
    definitions: dict[str, str] = {}
    with suppress(sqlite3.Error):
        for name, encoding, text in database.execute(
            "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
        ):
            definition = normal_definition(text, type_name=name, is_idl=encoding == "ros2idl")
            if definition is not None:
                definitions[name] = definition
    return definitions
