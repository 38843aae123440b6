# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""SQLite files read only, together with their write-ahead logs, and the topics that they announce."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from os import SEEK_END, SEEK_SET
from pathlib import Path
from typing import cast
from urllib.parse import quote

import apsw

from smarttestudo.bags.channel_reader import NO_DEFINITION, ChannelReader, Definition
from smarttestudo.bags.sqlite.log import WriteAheadLog
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel

_FLAGS = apsw.SQLITE_OPEN_READONLY | apsw.SQLITE_OPEN_URI
_STEPS_PER_BYTE = 50
"""The shortest row has some ten bytes, and no query takes more than a hundred steps for one."""
_LEAST_STEPS = 10_000_000
_STEPS_BETWEEN_CHECKS = 10_000


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
    # The name of another table may be of any bytes.
    wanted = f"lower(name) IN ({', '.join('?' * len(names))}) AND type IN ('table', 'view')"
    query = f"SELECT name, type, rootpage FROM sqlite_master WHERE {wanted}"  # noqa: S608  of these alone
    for name, kind, root_page in database.execute(query, names).fetchall():
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


def rows_of(
    database: apsw.Connection, table: str, columns: Sequence[str]
) -> Iterator[tuple[int, dict[str, str]]]:
    """The numbers and texts of the rows of a table, with those of ``columns`` that it has.

    Bytes that are no UTF-8 become surrogates: SQLite does not look at what it stores as a text.
    """
    ((encoding,),) = database.execute("PRAGMA encoding")
    errors = "surrogateescape" if encoding == "UTF-8" else "replace"
    named = database.execute("SELECT CAST(name AS BLOB) FROM pragma_table_xinfo(?)", (table,)).fetchall()
    present = {_text(name, str(encoding), "replace") for (name,) in named}
    if not present:
        raise LookupError(f"no table {table}")
    read = [column for column in columns if column in present]
    values = ", ".join(["id", *(f"CAST({one} AS BLOB)" for one in read)])
    for number, *stored in database.execute(f"SELECT {values} FROM {table} ORDER BY id"):  # noqa: S608  known
        texts = (_text(one, str(encoding), errors) for one in stored)
        yield int(cast("int", number)), dict(zip(read, texts, strict=True))


def _text(stored: apsw.SQLiteValue, encoding: str, errors: str) -> str:
    return stored.decode(encoding, errors) if isinstance(stored, bytes) else ""


def read_topics(database: apsw.Connection, reader: ChannelReader) -> dict[int, Channel]:
    """The channels that SQLite can read, by their numbers.

    Raises one of ``BROKEN`` where it finds no table of them, and as ``require_tables``.
    """
    require_tables(database, "topics", "messages", "message_definitions")
    definitions = _definitions(database, reader)
    channels: dict[int, Channel] = {}
    with suppress(apsw.Error):
        for number, columns in rows_of(database, "topics", _TOPIC_COLUMNS):
            type_name, digest = columns["type"], columns.get("type_description_hash", "")
            any_digest = definitions.get((type_name, ""), NO_DEFINITION)
            channels[number] = reader.channel(
                topic=columns["name"],
                type_name=type_name,
                serialization_format=columns["serialization_format"],
                qos=columns.get("offered_qos_profiles"),
                digest=digest,
                definition=definitions.get((type_name, digest), any_digest),
            )
    return channels


_TOPIC_COLUMNS = ("name", "type", "serialization_format", "offered_qos_profiles", "type_description_hash")
_DEFINITION_COLUMNS = ("topic_type", "encoding", "encoded_message_definition", "type_description_hash")


def _definitions(database: apsw.Connection, reader: ChannelReader) -> dict[tuple[str, str], Definition]:
    """Definitions by type name and digest, and the first of each name without one.

    There are none in a bag of Humble or older, which has no such table.
    """
    definitions: dict[tuple[str, str], Definition] = {}
    with suppress(apsw.Error, LookupError):
        for _, columns in rows_of(database, "message_definitions", _DEFINITION_COLUMNS):
            name, stored = columns["topic_type"], columns["encoded_message_definition"]
            if "/srv/" in name and not name.endswith("_Event"):
                # The topic of a service stands under its name; what is recorded are its events.
                name = f"{name}_Event"
            definition = reader.definition(
                name, columns["encoding"], stored.encode("utf-8", "surrogateescape")
            )
            if definition != NO_DEFINITION:
                definitions.setdefault((name, columns.get("type_description_hash", "")), definition)
                definitions.setdefault((name, ""), definition)
    return definitions
