# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reads rosbag2 recordings: folders and single files, whole or cut off, in time order and constant memory."""

from __future__ import annotations

import errno
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

from smarttestudo.bags.bag_files import BagFiles, find_bag_files, require_bag_file
from smarttestudo.bags.message_counts import MessageCounts
from smarttestudo.bags.metadata import BagMetadata, embedded_metadata
from smarttestudo.bags.recording import RecordingPart, RosbagRecording
from smarttestudo.bags.remote_path import fetched_in_full, is_remote
from smarttestudo.bags.storage_files import open_storage_file
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import RecordingReader, Storage

_NO_DESCRIPTOR = (errno.EMFILE, errno.ENFILE)


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
            from smarttestudo.bags.file_copies import readable_copy  # noqa: PLC0415  most are read where they are

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
