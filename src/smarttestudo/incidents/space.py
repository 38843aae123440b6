# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Space that incidents take on disk, and making room for new ones."""

from __future__ import annotations

import os
import stat
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from smarttestudo.bags.incident_record import RECORD_NAME
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.incident import is_incident_folder_name
from smarttestudo.files.whole_file import not_written
from smarttestudo.incidents.store import READ_NAME, remove_incident

_FileKey = tuple[int, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class RemovedIncident:
    """An incident that was deleted to make room, and whether somebody had read it.

    One with a ``problem`` could not be, and stays.
    """

    name: str
    was_read: bool
    problem: RecordingError | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class _Folder:
    path: Path
    is_read: bool
    written_ns: int
    files: dict[_FileKey, int]


def make_room(folder: Path, max_bytes: int, newest: str | None = None) -> Iterator[RemovedIncident]:
    """Delete incidents until all of ``folder`` takes at most ``max_bytes`` on disk, or one is left.

    Those that were read go first, then the others, the one first that was written first: names have the clock
    of the robot, which may have been set back. The one called ``newest``, or else the one written last,
    stays. What several share counts once, and is freed with the last of them. What is not an incident, not
    whole, or renamed counts and stays, and so does an incident with something else in its folder. Each is
    told when it is gone, or stays though it is its turn. Raises ``OutputFileError`` where one cannot be
    deleted.
    """
    holders: Counter[_FileKey] = Counter()
    sizes: dict[_FileKey, int] = {}
    incidents: list[_Folder] = []
    try:
        for path in sorted(folder.iterdir()):
            files = _files(path)
            holders.update(files.keys())
            sizes |= files
            # What was given another name is somebody's by now.
            if (
                is_incident_folder_name(path.name)
                and (path / RECORD_NAME).is_file()
                and not path.is_symlink()
            ):
                incidents.append(_folder(path, files))
        taken = sum(sizes.values())
        incidents.sort(key=lambda one: (one.path.name == newest, one.written_ns))
        # The newest stays: it is what just happened.
        for one in sorted(incidents[:-1], key=lambda one: not one.is_read):
            if taken <= max_bytes:
                return
            try:
                remove_incident(one.path)
            except RecordingError as error:
                yield RemovedIncident(name=one.path.name, was_read=one.is_read, problem=error)
                continue
            holders.subtract(one.files.keys())
            taken -= sum(size for key, size in one.files.items() if not holders[key])
            yield RemovedIncident(name=one.path.name, was_read=one.is_read)
    except OSError as error:
        raise not_written(folder, "room for more incidents", error) from error


def _folder(path: Path, files: dict[_FileKey, int]) -> _Folder:
    return _Folder(
        path=path,
        is_read=(path / READ_NAME).exists(),
        written_ns=(path / RECORD_NAME).stat().st_mtime_ns,
        files=files,
    )


def _files(folder: Path) -> dict[_FileKey, int]:
    """Bytes on disk of each file in ``folder``, by what it is rather than by its name."""
    found: dict[_FileKey, int] = {}
    if folder.is_symlink() or not folder.is_dir():
        return found
    with os.scandir(folder) as entries:
        for entry in entries:
            state = entry.stat(follow_symlinks=False)
            if stat.S_ISREG(state.st_mode):
                found[state.st_dev, state.st_ino] = state.st_blocks * 512
    return found
