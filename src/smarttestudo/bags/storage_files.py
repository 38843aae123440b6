# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Opens a storage file in the way that suits its state."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from smarttestudo.bags.stored_file import StoredFile
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Storage


def open_storage_file(path: Path, storage: Storage, whole_bytes: int | None = None) -> StoredFile:
    """The file at ``path``: by its index if it is whole, else as far as it goes.

    ``whole_bytes`` is how long it was before it was cut off, where that is known.
    Raises ``RecordingError`` where nothing of it can be read.
    """
    return _open_mcap(path, whole_bytes) if storage is Storage.MCAP else _open_sqlite(path)


def _open_mcap(path: Path, whole_bytes: int | None) -> StoredFile:
    from smarttestudo.bags.mcap.whole_file import McapFile, full_index  # noqa: PLC0415  slow to import

    index = full_index(path)
    if index is not None:
        return McapFile(path, index)
    from smarttestudo.bags.mcap.recovered import RecoveredMcapFile  # noqa: PLC0415

    return RecoveredMcapFile(path, whole_bytes)


def _open_sqlite(path: Path) -> StoredFile:
    from smarttestudo.bags.sqlite.file import SqliteFile  # noqa: PLC0415  as above
    from smarttestudo.bags.sqlite.log import read_log  # noqa: PLC0415

    log = read_log(path)
    with suppress(RecordingError):
        return SqliteFile(path, log)
    from smarttestudo.bags.sqlite.recovered import RecoveredSqliteFile  # noqa: PLC0415

    return RecoveredSqliteFile(path, log)
