# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A folder of incidents on disk: what it holds, and taking something out of it."""

from __future__ import annotations

import os
import re
import shutil
import stat
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from smarttestudo.bags.incident_record import RECORD_NAME, errors_at, read_record
from smarttestudo.bags.metadata_text import METADATA_NAME
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.incident import (
    IncidentRecord,
    RemoteIncident,
    incident_folder_name,
    is_incident_folder_name,
)
from smarttestudo.files.removal import ForeignFilesError, remove, temporary_folder
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, not_written

READ_NAME = "read"
"""An empty file in the folder of an incident that somebody looked at."""
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,99}\Z")
_MAX_LISTED = 100_000
_INCIDENTS_ARE_LISTED = "'testudo incidents list' names them"
_RECORDING = re.compile(r"((.+?)(?:-\d+)?)_\d+\.mcap\Z", re.ASCII)
"""A recording begins with the name that its folder had first, with a number where others had that name."""
_UNFINISHED = re.compile(r"\.(incident\.json|metadata\.yaml)-\w{8}\.partial\Z", re.ASCII)
"""What ``whole_file`` leaves where a run was killed."""
RESERVE_NAME = "reserve"
"""Room on the disk in the folder of an incident that is being recorded, to end it with."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredIncident:
    """An incident by the name of its folder; ``size_bytes`` is what its files take.

    ``is_read`` says that somebody looked at it.
    """

    name: str
    path: Path
    size_bytes: int
    is_read: bool
    record: IncidentRecord

    def listed(self) -> RemoteIncident:
        """As a list names it; on no robot."""
        return RemoteIncident(
            robot="",
            name=self.name,
            label=self.record.name,
            rule=self.record.rule,
            triggered_ns=self.record.triggered_ns,
            from_ns=self.record.from_ns,
            to_ns=self.record.to_ns,
            messages=sum(topic.messages for topic in self.record.topics.values()),
            size_bytes=self.size_bytes,
            is_read=self.is_read,
            missing=tuple(dict.fromkeys(missing.reason.value for missing in self.record.missing)),
            moments=self.record.moments,
        )


class IncidentStore:
    """The incidents in one folder; nothing outside it is read, copied or deleted, wherever links lead.

    Raises ``RecordingError`` where ``folder`` is not a folder that can be read.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        if not folder.is_dir():
            raise RecordingError(
                "is not a folder" if folder.exists() else "no such folder",
                place=str(folder),
                remedy="name the one that 'testudo run --incidents DIR' wrote into",
            )

    def incidents(self) -> Iterator[StoredIncident | RecordingError]:
        """All incidents, oldest first; for one whose record cannot be read, why."""
        with errors_at(self._folder):
            names = sorted(path.name for path in self._folder.iterdir() if _is_folder(path))
        for name in names[:_MAX_LISTED]:
            if name.startswith("."):
                continue
            try:
                yield self._stored(self._folder / name)
            except RecordingError as error:
                yield error

    def incident(self, name: str) -> StoredIncident:
        """The incident in the folder ``name``. Raises ``RecordingError`` where it cannot be read."""
        return self._stored(self._path(name))

    def size_bytes(self, name: str) -> int:
        """Size in bytes of an incident's files, whether its record can be read or not."""
        path = self._path(name)
        with errors_at(path):
            return sum(file.lstat().st_size for file in _files(path))

    def files(self, name: str) -> list[Path]:
        """The files of an incident, by name."""
        path = self._path(name)
        with errors_at(path):
            return list(_files(path))

    def mark_read(self, name: str) -> None:
        """Somebody looked at the incident: it is among those that give way first. No error if that fails."""
        with suppress(OSError):
            (self._path(name) / READ_NAME).touch(exist_ok=True)

    def export(self, name: str, target: Path) -> int:
        """Copy an incident to the new folder ``target``, which appears whole; how many files it has."""
        files = self.files(name)
        if target.exists() or target.is_symlink():
            raise RecordingError("exists already", place=str(target), remedy="name another output")
        with errors_at(target):
            target.parent.mkdir(parents=True, exist_ok=True)
            with temporary_folder(target.parent, suffix=PARTIAL_SUFFIX) as workshop:
                copies = workshop / target.name
                copies.mkdir()
                for file in files:
                    shutil.copyfile(file, copies / file.name, follow_symlinks=False)
                copies.rename(target)
        return len(files)

    def delete(self, name: str) -> None:
        """Delete an incident as ``remove_incident``. Raises ``RecordingError`` where it stays."""
        path = self._path(name)
        with errors_at(path):
            remove_incident(path)

    def _stored(self, path: Path) -> StoredIncident:
        self._require_record(path)
        name, size_bytes = path.name, self.size_bytes(path.name)
        with errors_at(path):
            is_read = (path / READ_NAME).exists()
        return StoredIncident(
            name=name, path=path, size_bytes=size_bytes, is_read=is_read, record=read_record(path)
        )

    @staticmethod
    def _require_record(folder: Path) -> None:
        """Raise ``RecordingError`` where ``folder`` has no record, or a name that no command takes."""
        with errors_at(folder):
            has_record = _mode(folder / RECORD_NAME) != 0
        if not has_record:
            remedy = "name this folder itself if there are incidents in it"
            raise RecordingError(f"is no incident: it has no {RECORD_NAME}", place=str(folder), remedy=remedy)
        if _NAME.match(folder.name) is None:
            cause = "the name of an incident has at most 100 letters from a to z, digits, - and _"
            raise RecordingError(cause, place=str(folder), remedy="rename the folder")

    def _path(self, name: str) -> Path:
        path = self._folder / name
        if _NAME.match(name) is None or not _is_folder(path):
            raise RecordingError(
                f"there is no incident {name!r:.80}", place=str(self._folder), remedy=_INCIDENTS_ARE_LISTED
            )
        return path


def remove_incident(folder: Path) -> None:
    """Remove the folder of an incident with its files, if it holds nothing else.

    These are its record, what names its recordings, the mark that somebody looked at it, and the recordings
    that are called as the record says. Where that cannot be read, they are called as the folder is.

    Raises ``RecordingError`` for a folder without the record of an incident or with other things, which stays
    as it was, and ``OSError`` where something cannot be removed.
    """
    if not stat.S_ISREG(_mode(folder / RECORD_NAME)):
        raise RecordingError(
            f"is no incident: it has no {RECORD_NAME}", place=str(folder), remedy=_INCIDENTS_ARE_LISTED
        )
    stems = [folder.name] if is_incident_folder_name(folder.name) else []
    try:
        record = read_record(folder)
        stems.append(incident_folder_name(record.name, record.triggered_ns))
    except RecordingError as error:
        if not stems:
            remedy = "look at what the folder is, and remove it yourself"
            raise RecordingError(error.cause, place=error.place, remedy=remedy) from error
    names = sorted(file.name for file in folder.iterdir())
    ours = [name for name in names if _is_of_incident(name, stems)]
    try:
        # As long as something is there, it is the folder of an incident, and can be removed once more.
        remove(folder, sorted(ours, key=lambda name: name == RECORD_NAME), with_folder=True)
    except ForeignFilesError as error:
        raise RecordingError(error.cause, place=error.place, remedy=error.remedy) from error


def remove_begun(folder: Path) -> bool:
    """Remove the hidden folder of an incident that has no record and no data yet; whether it is gone.

    Raises ``OSError`` where it cannot be removed.
    """
    name = folder.name.removeprefix(".").removesuffix(PARTIAL_SUFFIX)
    if folder.is_symlink() or not is_incident_folder_name(name):
        return False
    names = [one.name for one in folder.iterdir()]
    ours = [one for one in names if one == RESERVE_NAME or _UNFINISHED.match(one)]
    ours += [one for one in names if _is_of_incident(one, [name]) and not (folder / one).lstat().st_size]
    try:
        remove(folder, dict.fromkeys(ours), with_folder=True)
    except ForeignFilesError:
        return False
    return True


def _is_of_incident(name: str, stems: Iterable[str]) -> bool:
    """Whether it is the name of a file of an incident whose recordings begin with one of ``stems``."""
    if name in {RECORD_NAME, METADATA_NAME, READ_NAME, RESERVE_NAME} or _UNFINISHED.match(name):
        return True
    stem = _RECORDING.match(name)
    return stem is not None and any(stem[1] == own or stem[2] == own for own in stems)


def _mode(path: Path) -> int:
    try:
        return path.lstat().st_mode
    except FileNotFoundError:
        return 0


def _is_folder(path: Path) -> bool:
    """Whether it is a folder itself, not a link to one."""
    return path.is_dir() and not path.is_symlink()


def _files(path: Path) -> Iterator[Path]:
    """The files in a folder; an incident has no folders in it, and a link or a mark is none of its files."""
    files = (one for one in sorted(path.iterdir()) if stat.S_ISREG(one.lstat().st_mode))
    return (file for file in files if file.name != READ_NAME)


_FileKey = tuple[int, int]


@dataclass(frozen=True, slots=True, kw_only=True)
class RemovedIncident:
    """An incident that was deleted to make room, and whether somebody had read it.

    An incident with a ``problem`` could not be deleted, and stays.
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

    Incidents that were read go first, then the others, the one first that was written first: names have the
    clock of the robot, which may have been set back. The incident called ``newest``, or else what was written
    last, stays. What several share counts once, and is freed with the last of them. What is not an incident,
    not whole, or renamed counts and stays, and so does an incident with something else in its folder. Each is
    told when it is gone, or stays though it is its turn. Raises ``OutputFileError`` where one cannot be
    deleted.
    """
    holders: Counter[_FileKey] = Counter()
    sizes: dict[_FileKey, int] = {}
    incidents: list[_Folder] = []
    try:
        for path in sorted(folder.iterdir()):
            files = _disk_files(path)
            holders.update(files.keys())
            sizes |= files
            # What was given another name is somebody's by now.
            if (
                is_incident_folder_name(path.name)
                and (path / RECORD_NAME).is_file()
                and not path.is_symlink()
            ):
                written_ns = (path / RECORD_NAME).stat().st_mtime_ns
                is_read = (path / READ_NAME).exists()
                incidents.append(_Folder(path=path, is_read=is_read, written_ns=written_ns, files=files))
        taken = sum(sizes.values())
        incidents.sort(key=lambda one: (one.path.name == newest, one.written_ns))
        # The newest stays: it is what just happened.
        for incident in sorted(incidents[:-1], key=lambda incident: not incident.is_read):
            if taken <= max_bytes:
                return
            try:
                remove_incident(incident.path)
            except RecordingError as error:
                yield RemovedIncident(name=incident.path.name, was_read=incident.is_read, problem=error)
                continue
            holders.subtract(incident.files.keys())
            taken -= sum(size for key, size in incident.files.items() if not holders[key])
            yield RemovedIncident(name=incident.path.name, was_read=incident.is_read)
    except OSError as error:
        raise not_written(folder, "room for more incidents", error) from error


def _disk_files(folder: Path) -> dict[_FileKey, int]:
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
