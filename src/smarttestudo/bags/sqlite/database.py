# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""SQLite files read only, together with their write-ahead logs, and the topics that they announce."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from os import SEEK_END, SEEK_SET
from pathlib import Path
from urllib.parse import quote

import apsw

from smarttestudo.bags.definition_text import stored_definition
from smarttestudo.bags.qos import QosReader, is_transient_local
from smarttestudo.bags.sqlite.log import WriteAheadLog
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.names import ros_type_name
from smarttestudo.domain.recording import Channel, ForeignSchema

_FLAGS = apsw.SQLITE_OPEN_READONLY | apsw.SQLITE_OPEN_URI
_STEPS_PER_BYTE = 50
"""The shortest row has some ten bytes, and no query takes more than a hundred steps for one."""
_LEAST_STEPS = 10_000_000
_STEPS_BETWEEN_CHECKS = 10_000
_READABLE_KINDS = ("table", "view")


class DatabaseFile:
    """The bytes of a SQLite file as they would be with its log taken in."""

    def __init__(self, path: Path, log: WriteAheadLog | None = None) -> None:
        self._file = path.open("rb", buffering=0)
        self._log = log if log is not None and log.page_numbers else None
        self._log_file = None if self._log is None else self._log.path.open("rb", buffering=0)
        own_bytes = self._file.seek(0, SEEK_END)
        self._position = 0
        self._own_bytes = own_bytes
        self.file_bytes = self.present_bytes = own_bytes
        """How long it is, and how much of that is there: pages between may be missing."""
        if self._log is not None:
            self.file_bytes = self._log.database_pages * self._log.page_bytes
            own_pages = min(own_bytes // self._log.page_bytes, self._log.database_pages)
            added = sum(own_pages < number <= self._log.database_pages for number in self._log.page_numbers)
            self.present_bytes = (own_pages + added) * self._log.page_bytes
            self._own_bytes = own_pages * self._log.page_bytes

    def seek(self, offset: int, whence: int = SEEK_SET) -> int:
        """Go to ``offset`` from the start, or from the end."""
        self._position = offset + (self.file_bytes if whence == SEEK_END else 0)
        return self._position

    def read(self, size_bytes: int) -> bytes:
        """The next ``size_bytes``, fewer where the file ends or a page is missing."""
        if self._log is None:
            self._file.seek(self._position)
            data = self._file.read(size_bytes) or b""
        else:
            data = b"".join(self._pieces(self._log, size_bytes))
        self._position += len(data)
        return data

    def close(self) -> None:
        """Let go of both files."""
        self._file.close()
        if self._log_file is not None:
            self._log_file.close()

    def _pieces(self, log: WriteAheadLog, size_bytes: int) -> Iterator[bytes]:
        at, end = self._position, min(self._position + size_bytes, self.file_bytes)
        while at < end:
            page, within = divmod(at, log.page_bytes)
            wanted = min(end - at, log.page_bytes - within)
            offset = log.offset_of(page + 1)
            if offset is None and at >= self._own_bytes:
                return
            file = self._file if offset is None else self._log_file
            assert file is not None
            file.seek(at if offset is None else offset + within)
            piece = file.read(wanted) or b""
            yield piece
            if len(piece) < wanted:
                return
            at += wanted


@contextmanager
def open_database(path: Path, log: WriteAheadLog | None = None) -> Iterator[apsw.Connection]:
    """A connection to the database at ``path`` with ``log`` taken in; neither is locked or changed.

    Raises ``apsw.Error`` for what is no database, and ``OSError`` where the file cannot be opened at all.
    """
    address = f"file:{quote(os.fsencode(path.absolute()))}?mode=ro&immutable=1"
    with ExitStack() as opened:
        system = None
        if log is not None and log.page_numbers:
            file = opened.enter_context(closing(DatabaseFile(path, log)))
            system = opened.enter_context(_files_from(file))
        try:
            database = apsw.Connection(address, flags=_FLAGS, vfs=system)
        except apsw.CantOpenError:
            # SQLite does not say why: too many open files are no damage.
            path.open("rb").close()
            raise
        opened.enter_context(closing(database))
        _limit_work(database, path.stat().st_size if system is None else file.file_bytes)
        yield database


def _limit_work(database: apsw.Connection, file_bytes: int) -> None:
    """Interrupt queries that take many times the steps of a file's rows: its pages may point in circles."""
    checks = iter(range((_LEAST_STEPS + _STEPS_PER_BYTE * file_bytes) // _STEPS_BETWEEN_CHECKS))
    database.set_progress_handler(lambda: next(checks, None) is None, _STEPS_BETWEEN_CHECKS)


def require_tables(database: apsw.Connection, *names: str) -> None:
    """Raise ``RecordingError`` where one of ``names`` is there and is more than a table of stored values.

    A view, or a column that is computed, may be a query without an end.
    """
    for name, kind, root_page in database.execute(
        "SELECT name, type, rootpage FROM sqlite_master"
    ).fetchall():
        if kind not in _READABLE_KINDS or str(name).lower() not in names:
            continue
        is_computed = database.execute("SELECT 1 FROM pragma_table_xinfo(?) WHERE hidden > 0", (name,))
        if kind == "view" or not root_page or is_computed.fetchall():
            what = "a view" if kind == "view" else "computed"
            raise RecordingError(
                f"its {name} is {what}: only tables of stored values are read",
                place=database.filename,
                remedy="copy its rows into a table",
            )


@contextmanager
def _files_from(file: DatabaseFile) -> Iterator[str]:
    """The name of a file system, as SQLite understands it, whose one file is ``file``."""
    system = _OneFileSystem(f"testudo-{id(file)}", file)
    try:
        yield system.name
    finally:
        system.unregister()


class _OneFileSystem(apsw.VFS):
    def __init__(self, name: str, file: DatabaseFile) -> None:
        super().__init__(name, "")
        self.name = name
        self._file = file

    def xOpen(self, name: str | apsw.URIFilename | None, flags: list[int]) -> apsw.VFSFile:  # noqa: N802
        """The file for its name, and a temporary one for SQLite's own needs without."""
        return super().xOpen(name, flags) if name is None else _OpenedFile(self._file)


class _OpenedFile(apsw.VFSFile):
    def __init__(self, file: DatabaseFile) -> None:
        self._file = file

    def xRead(self, amount: int, offset: int) -> bytes:  # noqa: N802
        self._file.seek(offset)
        return self._file.read(amount)

    def xFileSize(self) -> int:  # noqa: N802
        return self._file.present_bytes

    def xFileControl(self, op: int, pointer: int) -> bool:  # noqa: ARG002, N802
        return False

    def xSectorSize(self) -> int:  # noqa: N802
        return 0

    def xDeviceCharacteristics(self) -> int:  # noqa: N802
        return 0

    def xClose(self) -> None:  # noqa: N802
        """Leave the file open: it belongs to the database."""


BROKEN = (apsw.Error, LookupError, TypeError, ValueError)
"""What reading topics raises on a damaged file."""


def read_topics(database: apsw.Connection, qos: QosReader) -> dict[int, Channel]:
    """The channels that SQLite can read, by their numbers.

    Raises one of ``BROKEN`` where it finds no table of them, and as ``require_tables``.
    """
    require_tables(database, "topics", "messages", "message_definitions")
    definitions = _definitions(database)
    channels: dict[int, Channel] = {}
    rows = database.execute("SELECT * FROM topics ORDER BY id")
    with suppress(apsw.Error):
        for row in rows:
            columns = dict(zip((column[0] for column in rows.description), row, strict=True))
            channels[int(columns["id"])] = _channel(columns, definitions, qos)
    return channels


_Definition = tuple[str | None, ForeignSchema | None]


def _channel(
    columns: dict[str, apsw.SQLiteValue], definitions: dict[tuple[str, str], _Definition], qos: QosReader
) -> Channel:
    topic, type_name = str(columns["name"]), str(columns["type"])
    digest = str(columns.get("type_description_hash") or "")
    serialization_format = str(columns["serialization_format"])
    profiles = qos.read_or_note(topic, columns.get("offered_qos_profiles"))
    any_digest = definitions.get((type_name, ""), (None, None))
    definition, foreign = definitions.get((type_name, digest), any_digest)
    return Channel(
        topic=topic,
        type_name=ros_type_name(type_name, serialization_format),
        definition=definition,
        digest=digest,
        qos=profiles,
        serialization_format=serialization_format,
        transient_local=is_transient_local(profiles),
        foreign_schema=foreign,
    )


def _definitions(database: apsw.Connection) -> dict[tuple[str, str], _Definition]:
    """Definitions by type name and digest, and the first of each name without one.

    There are none in a bag of Humble or older, which has no such table.
    """
    definitions: dict[tuple[str, str], _Definition] = {}
    with suppress(apsw.Error):
        rows = database.execute("SELECT * FROM message_definitions ORDER BY id")
        for row in rows:
            columns = dict(zip((column[0] for column in rows.description), row, strict=True))
            name, stored = str(columns["topic_type"]), columns["encoded_message_definition"]
            if "/srv/" in name and not name.endswith("_Event"):
                # That of a service stands under its name; what is recorded are its events.
                name = f"{name}_Event"
            data = stored if isinstance(stored, bytes) else str(stored or "").encode("utf-8", "replace")
            definition = stored_definition(name, str(columns["encoding"] or ""), data)
            if definition != (None, None):
                definitions.setdefault((name, str(columns.get("type_description_hash") or "")), definition)
                definitions.setdefault((name, ""), definition)
    return definitions
