# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An incident that is being fetched: its files with what is there of them, until they are whole."""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import shutil
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from smarttestudo.domain.errors import LinkError, TestudoError
from smarttestudo.domain.incident import is_incident_folder_name
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.record import from_json, to_json
from smarttestudo.domain.units import BYTES_PER_MB, grouped
from smarttestudo.files.removal import remove
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, OutputFileError, not_written, whole_file
from smarttestudo.link.transfer.order import MOST_HEAD_BYTES, ByteRange, read_head
from smarttestudo.link.transfer.plan import TransferPlan, is_incident_file_name, is_incident_name, no_incident

STATE_NAME = ".fetch.json"
_LOCK_NAME = ".fetch.lock"
_SPARE_BYTES = 50_000_000
_READ_BYTES = 1 << 20
_CONTENT = "what is fetched"
_NOTHING = ByteRange(0, 0, 0)
_OPENED = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW


@dataclass(frozen=True, slots=True, kw_only=True)
class _State:
    """How far a fetch is; ``begun`` is the file, the place and the size of what is left of a range."""

    version: str = ""
    cursor: int = 0
    got_bytes: int = 0
    begun: tuple[int, int, int] = (0, 0, 0)
    files: tuple[str, ...] = ()


class PartialIncident:
    """The folder ``.NAME.partial`` in ``folder``; ``cursor`` says how far its order is there.

    What is there of another plan is deleted first, and nothing else that may be there. Nothing is written
    outside the folder, and no more than the plan says. Raises ``OutputFileError``: something cannot be
    written, another process fetches the same, or there is no room for it; ``LinkError`` for a name that is
    none; ``ForeignFilesError`` where something else has the name of a file of the plan.
    """

    def __init__(self, folder: Path, name: str, plan: TransferPlan) -> None:
        if not is_incident_name(name):
            raise no_incident(name)
        self.path = folder / f".{name}{PARTIAL_SUFFIX}"
        self._target = folder / name
        self._plan = plan
        self._files: list[int] = []
        self._lock = -1
        self._has_lock = False
        self._begun = _NOTHING
        """What is left of the range whose bytes come now."""
        self._head = b""
        """What came of the head of the next one."""
        self.cursor = 0
        self.got_bytes = 0
        """Bytes of files that are there."""
        try:
            for path in (self.path, self.path / STATE_NAME, self.path / _LOCK_NAME):
                if path.is_symlink():
                    raise OutputFileError("is a link", place=str(path), remedy="remove it")
            self.path.mkdir(parents=True, exist_ok=True)
            self._take_lock()
            remove(self.path, self._unfinished_states())
            state = self._read_state()
            self._go_on(state)
            self._require_room()
            if not self.cursor:
                self._clear(state)
                # Whatever happens from here on, the next fetch knows what is of this one.
                self.save()
            for file in plan.files:
                self._files.append(os.open(self.path / file.name, _OPENED, 0o644))
                os.ftruncate(self._files[-1], file.size_bytes)
        except OSError as error:
            self.close()
            raise not_written(self.path, _CONTENT, error) from error
        except TestudoError:
            self.close()
            raise

    def __enter__(self) -> PartialIncident:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def write(self, data: bytes) -> None:
        """Write what follows on ``cursor``. Raises ``LinkError`` where it does not lie in the files."""
        place = 0
        try:
            while place < len(data):
                is_head = not self._begun.size_bytes
                taken = (self._take_head if is_head else self._take_own)(data, place)
                place, self.cursor = place + taken, self.cursor + taken
        except OSError as error:
            raise not_written(self.path, _CONTENT, error) from error

    def _take_head(self, data: bytes, place: int) -> int:
        """Take the head of a range, or some of it; how many bytes that were."""
        begun, head = len(self._head), self._head + data[place : place + MOST_HEAD_BYTES]
        found = read_head(head)
        if found is None:
            self._head = head
            return len(head) - begun
        range_, head_bytes = found
        self._require_within(range_.file, range_.offset, range_.size_bytes)
        if self.got_bytes + range_.size_bytes > self._plan.size_bytes:
            raise LinkError("the robot sends more than the incident has", place=self._target.name)
        self._begun, self._head = range_, b""
        return head_bytes - begun

    def _take_own(self, data: bytes, place: int) -> int:
        """Write what there is of the range that has begun; how many bytes that were."""
        file, offset, size_bytes = self._begun
        own = data[place : place + size_bytes]
        os.pwrite(self._files[file], own, offset)
        self._begun = ByteRange(file, offset + len(own), size_bytes - len(own))
        self.got_bytes += len(own)
        return len(own)

    def save(self) -> None:
        """Write how far the fetch is, for another that goes on from here."""
        state = _State(
            version=self._plan.version.hex(),
            cursor=self.cursor - len(self._head),
            got_bytes=self.got_bytes,
            begun=self._begun,
            files=tuple(file.name for file in self._plan.files),
        )
        with whole_file(self.path / STATE_NAME, "the state of a fetch") as write:
            write(json_text(to_json(state)))

    def finish(self) -> Path:
        """Give the incident its name, if its files are those of the robot: return its path.

        Raises ``LinkError`` where they are not: what was fetched is deleted then.
        """
        wrong = [
            planned.name
            for planned, file in zip(self._plan.files, self._files, strict=True)
            if _sha256(file) != planned.sha256
        ]
        try:
            if wrong:
                self._clear(_State())
                self.cursor = self.got_bytes = 0
                raise LinkError(
                    f"{', '.join(wrong[:3])} is not what the robot has; what was fetched is deleted",
                    place=self._target.name,
                    remedy="fetch it again",
                )
            for file in self._files:
                os.fsync(file)
            remove(self.path, (STATE_NAME, _LOCK_NAME))
            return self.path.rename(self._target)
        except OSError as error:
            raise not_written(self._target, _CONTENT, error) from error

    def close(self) -> None:
        """Leave the folder as it is; none where nothing is in it."""
        if self._has_lock and not self.cursor:
            # Of an earlier plan there may be more: then it stays.
            ours = [planned.name for planned, _ in zip(self._plan.files, self._files, strict=False)]
            with suppress(OSError, TestudoError):
                remove(self.path, dict.fromkeys((*ours, STATE_NAME, _LOCK_NAME)), with_folder=True)
        for file in (*self._files, self._lock):
            if file >= 0:
                os.close(file)
        self._files, self._lock, self._has_lock = [], -1, False

    def _require_within(self, file: int, offset: int, size_bytes: int) -> None:
        is_within = 0 <= file < len(self._plan.files) and min(offset, size_bytes) >= 0
        if not is_within or offset + size_bytes > self._plan.files[file].size_bytes:
            raise LinkError("the robot sends what is in no file of the incident", place=self._target.name)

    def _take_lock(self) -> None:
        self._lock = os.open(self.path / _LOCK_NAME, _OPENED, 0o644)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise OutputFileError(
                "another process fetches this incident", place=str(self.path), remedy="wait for it"
            ) from error
        except OSError:
            # A disk that knows no locks.
            return
        self._has_lock = True

    def _unfinished_states(self) -> list[str]:
        """Names of files left by a process that was killed as it wrote the state."""
        with os.scandir(self.path) as entries:
            return [
                entry.name
                for entry in entries
                if entry.name.startswith(f".{STATE_NAME}-")
                and entry.name.endswith(PARTIAL_SUFFIX)
                and entry.is_file(follow_symlinks=False)
            ]

    def _read_state(self) -> _State:
        """State that an earlier fetch saved; empty where there was none, or where it cannot be read."""
        try:
            return from_json(_State, json.loads((self.path / STATE_NAME).read_bytes()))
        except (OSError, ValueError, RecursionError):
            return _State()

    def _go_on(self, state: _State) -> None:
        """Go on where an earlier fetch of the same plan was, if there was one."""
        plan, begun = self._plan, ByteRange(*state.begun)
        try:
            sizes = [(self.path / file.name).lstat().st_size for file in plan.files]
            self._require_within(begun.file, begun.offset, begun.size_bytes)
        except (OSError, LinkError):
            return
        is_same = state.version == plan.version.hex() and sizes == [file.size_bytes for file in plan.files]
        if is_same and 0 <= state.cursor <= plan.order_bytes and 0 <= state.got_bytes <= plan.size_bytes:
            self.cursor, self.got_bytes, self._begun = state.cursor, state.got_bytes, begun

    def _require_room(self) -> None:
        free_bytes = shutil.disk_usage(self.path).free
        missing_bytes = self._plan.size_bytes - self.got_bytes
        if missing_bytes + _SPARE_BYTES > free_bytes:
            missing, spare, free = (
                grouped(size / BYTES_PER_MB, 1) for size in (missing_bytes, _SPARE_BYTES, free_bytes)
            )
            raise OutputFileError(
                f"there is no room for {missing} MB with {spare} MB to spare: {free} MB are free",
                place=str(self.path.parent),
                remedy="free some space or write to another disk",
            )

    def _clear(self, state: _State) -> None:
        """Remove the files of the plan and of the one in ``state``."""
        former = filter(is_incident_file_name, state.files)
        names = (*(file.name for file in self._plan.files), *former, STATE_NAME)
        remove(self.path, dict.fromkeys(names))


def remove_begun_fetches(folder: Path) -> None:
    """Remove the hidden folders in ``folder`` in which nothing was written before a fetch was killed."""
    for path in folder.glob(f".*{PARTIAL_SUFFIX}"):
        if is_incident_folder_name(path.name[1 : -len(PARTIAL_SUFFIX)]):
            # What holds anything else, or is a link, stays.
            with suppress(OSError, TestudoError):
                remove(path, (STATE_NAME, _LOCK_NAME), with_folder=True)


def incident_there(folder: Path, name: str, files: Sequence[str] = ()) -> Path | None:
    """Where an incident is that was fetched before, with all its ``files``, or with some."""
    path = folder / name
    if not is_incident_name(name) or path.is_symlink() or not path.is_dir():
        return None
    has_all = all((path / file).is_file() for file in files)
    return path if has_all and any(path.iterdir()) else None


def _sha256(file: int) -> str:
    digest, place = hashlib.sha256(), 0
    while data := os.pread(file, _READ_BYTES, place):
        digest.update(data)
        place += len(data)
    return digest.hexdigest()
