# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reads rosbag2 recordings: folders and single files, whole or cut off, in time order and constant memory."""

from __future__ import annotations

import errno
import shutil
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from tempfile import gettempdir

from smarttestudo.bags import unpacking
from smarttestudo.bags.bag_files import BagFiles, find_bag_files, is_packed, require_bag_file
from smarttestudo.bags.metadata import BagMetadata, MessageCounts, embedded_metadata
from smarttestudo.bags.recording import RecordingPart, RosbagRecording
from smarttestudo.bags.remote_path import fetched_in_full, is_remote
from smarttestudo.bags.stored_file import StoredFile
from smarttestudo.bags.unpacking import MAX_RATIO, TooLargeError
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import RecordingReader, Storage
from smarttestudo.files.removal import temporary_folder

_NO_DESCRIPTOR = (errno.EMFILE, errno.ENFILE)
_COPIED_BYTES = 1 << 20


@contextmanager
def open_recording(path: Path) -> Iterator[RecordingReader]:
    """The recording at ``path``: a rosbag2 folder, a .db3 or an .mcap file, also packed as ``.zstd``.

    A file of several that cannot be read costs what is in it, and a notice, and so do messages whose stamps
    are of another time than the others.

    Raises:
        RecordingError: there is no bag at ``path``, or nothing of it can be read.
    """
    with fetched_in_full(path), ExitStack() as opened:
        bag = find_bag_files(path)
        notices = list(bag.notices)
        parts = _open_parts(bag, opened, notices)
        metadata = bag.metadata if bag.metadata.file_names else _metadata_within(parts)
        lacks_files = bool(bag.missing) or len(parts) < len(bag.paths)
        recording = RosbagRecording(parts, metadata, notices, name=str(path), lacks_files=lacks_files)
        recording.require_messages()
        recording.leave_out_strays()
        yield recording
        # Some damage is met only in reading.
        recording.require_messages()


def _open_parts(bag: BagFiles, opened: ExitStack, notices: list[str]) -> Sequence[RecordingPart]:
    names = bag.names or [""] * len(bag.paths)
    outcomes = [_try_part(path, name, opened, notices) for path, name in zip(bag.paths, names, strict=True)]
    parts = [outcome for outcome in outcomes if isinstance(outcome, RecordingPart)]
    failures = [outcome for outcome in outcomes if isinstance(outcome, RecordingError)]
    if not parts:
        raise failures[0]
    notices.extend(f"{failure.place}: {failure.cause}" for failure in failures)
    return parts


def _try_part(path: Path, name: str, opened: ExitStack, notices: list[str]) -> RecordingPart | RecordingError:
    try:
        return _open_part(path, name, opened, notices)
    except RecordingError as error:
        if isinstance(error.__cause__, OSError) and error.__cause__.errno in _NO_DESCRIPTOR:
            # Nothing is wrong with the file: numbers without it would be.
            raise
        return error


def _open_part(path: Path, name: str, opened: ExitStack, notices: list[str]) -> RecordingPart:
    try:
        storage_path, whole_bytes, storage = path, None, require_bag_file(path)
        if storage is None or (storage is not Storage.MCAP and is_remote(path)):
            storage_path, whole_bytes = readable_copy(path, opened, notices)
            storage = require_bag_file(storage_path)
        assert storage is not None
        file = open_storage_file(storage_path, storage, whole_bytes)
    except OSError as error:
        cause, remedy = f"cannot be read: {error.strerror}", "check the path and its permissions"
        if error.errno in _NO_DESCRIPTOR:
            remedy = "raise the limit of open files: ulimit -n"
        raise RecordingError(cause, place=str(path), remedy=remedy) from error
    opened.callback(file.close)
    return RecordingPart(path=path, name=name, storage=storage, storage_path=storage_path, file=file)


def _metadata_within(parts: Sequence[RecordingPart]) -> BagMetadata:
    """The metadata that a storage file carries, without its list of files."""
    for part in parts:
        metadata = embedded_metadata(part.storage_path, part.storage)
        if metadata is not None:
            # It counts the messages of all files.
            is_of_one = len(parts) == len(metadata.file_names) == 1
            counts = MessageCounts(total=metadata.counts.total, topics=metadata.counts.topics)
            return replace(metadata, file_names=(), counts=counts if is_of_one else MessageCounts())
    return BagMetadata()


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


def readable_copy(path: Path, opened: ExitStack, notices: list[str]) -> tuple[Path, int | None]:
    """A copy of a file that is packed or remote, which goes with ``opened``, and how long the whole file was.

    Raises ``RecordingError`` for one that cannot be decompressed, and ``OSError``.
    """
    if is_packed(path):
        return _unpacked(path, opened, notices), unpacking.unpacked_file_bytes(path)
    return _fetched(path, opened), None


def _fetched(path: Path, opened: ExitStack) -> Path:
    """A copy of a file that cannot be read by ranges, with the log beside it; it goes with ``opened``."""
    folder = opened.enter_context(temporary_folder(prefix="testudo-"))
    for source in (path, path.with_name(f"{path.name}-wal")):
        if source.is_file():
            with source.open("rb") as file, (folder / source.name).open("wb") as copy:
                shutil.copyfileobj(file, copy, _COPIED_BYTES)
    return folder / path.name


def _unpacked(path: Path, opened: ExitStack, notices: list[str]) -> Path:
    try:
        folder = opened.enter_context(temporary_folder(prefix="testudo-"))
        target = folder / path.with_suffix("").name
        is_whole = unpacking.unpack(path, target)
    except OSError as error:
        cause = f"it cannot be decompressed into {gettempdir()}: {error.strerror}"
        remedy = "free some space there, or set TMPDIR to a folder that has more"
        raise RecordingError(cause, place=str(path), remedy=remedy) from error
    except TooLargeError as error:
        raise RecordingError(
            f"it is not decompressed: {error} and than {MAX_RATIO} times the file",
            place=str(path),
            remedy="unpack it with zstd -d if it is right",
        ) from error
    try:
        is_recording = require_bag_file(target) is not None
    except RecordingError:
        is_recording = False
    if not is_recording:
        cause = "its compressed content is no recording" if is_whole else "no part of it can be decompressed"
        raise RecordingError(cause, place=str(path))
    if not is_whole:
        notices.append(f"{path}: its compressed data are truncated or damaged; read as far as possible")
    return target
