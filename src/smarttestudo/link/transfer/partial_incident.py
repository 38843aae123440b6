# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An incident that is being fetched: its files with what is there of them, until they are whole."""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import shutil
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType

from smarttestudo.domain.errors import LinkError, TestudoError
from smarttestudo.domain.incident import is_incident_folder_name
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.units import BYTES_PER_MB, grouped
from smarttestudo.files.removal import remove
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, OutputFileError, not_written, whole_file
from smarttestudo.link.transfer.messages import (
    TransferPiece,
    TransferPlan,
    is_incident_file_name,
    is_incident_name,
    no_incident,
)

STATE_NAME = ".fetch.json"
_LOCK_NAME = ".fetch.lock"
_SPARE_BYTES = 50_000_000
_READ_BYTES = 1 << 20
_CONTENT = "what is fetched"
_OPENED = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW


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
        self.cursor = 0
        try:
            for path in (self.path, self.path / STATE_NAME, self.path / _LOCK_NAME):
                if path.is_symlink():
                    raise OutputFileError("is a link", place=str(path), remedy="remove it")
            self.path.mkdir(parents=True, exist_ok=True)
            self._take_lock()
            remove(self.path, self._unfinished_states())
            state = self._read_state()
            self.cursor = self._known_cursor(state)
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

    def write(self, piece: TransferPiece) -> None:
        """Write what follows on ``cursor``. Raises ``LinkError`` where it does not lie in the files."""
        place = 0
        for part in piece.parts:
            whole, size = part.whole, part.size_bytes
            self._require_within(whole.file, whole.offset, whole.size_bytes)
            start = whole.offset + part.skipped_bytes
            try:
                if whole.copy_of is None:
                    data, place = piece.body[place : place + size], place + size
                else:
                    source, source_start = whole.copy_of
                    self._require_within(source, source_start, whole.size_bytes)
                    data = os.pread(self._files[source], size, source_start + part.skipped_bytes)
                os.pwrite(self._files[whole.file], data, start)
            except OSError as error:
                raise not_written(self.path, _CONTENT, error) from error
        self.cursor += piece.covered_bytes

    def save(self) -> None:
        """Write how far the fetch is, for another that goes on from here."""
        files = [file.name for file in self._plan.files]
        state = {"token": self._plan.token.hex(), "cursor": self.cursor, "files": files}
        with whole_file(self.path / STATE_NAME, "the state of a fetch") as write:
            write(json_text(state))

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
                self._clear({})
                self.cursor = 0
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
        if not 0 <= file < len(self._files) or offset + size_bytes > self._plan.files[file].size_bytes:
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

    def _read_state(self) -> Mapping[str, object]:
        """State that an earlier fetch saved; empty where there was none, or where it cannot be read."""
        try:
            state = json.loads((self.path / STATE_NAME).read_bytes())
        except (OSError, ValueError, RecursionError):
            return {}
        return state if isinstance(state, dict) else {}

    def _known_cursor(self, state: Mapping[str, object]) -> int:
        """How far an earlier fetch of the same plan got; 0 where there was none."""
        try:
            cursor = int(str(state["cursor"]))
            is_same = state["token"] == self._plan.token.hex() and 0 <= cursor <= self._plan.size_bytes
            sizes = [(self.path / file.name).lstat().st_size for file in self._plan.files]
        except (OSError, ValueError, LookupError):
            return 0
        return cursor if is_same and sizes == [file.size_bytes for file in self._plan.files] else 0

    def _require_room(self) -> None:
        free_bytes = shutil.disk_usage(self.path).free
        missing_bytes = self._plan.size_bytes - self.cursor
        if missing_bytes + _SPARE_BYTES > free_bytes:
            missing, spare, free = (
                grouped(size / BYTES_PER_MB, 1) for size in (missing_bytes, _SPARE_BYTES, free_bytes)
            )
            raise OutputFileError(
                f"there is no room for {missing} MB with {spare} MB to spare: {free} MB are free",
                place=str(self.path.parent),
                remedy="free some space or write to another disk",
            )

    def _clear(self, state: Mapping[str, object]) -> None:
        """Remove the files of the plan and of the one in ``state``."""
        former = state.get("files")
        names = [file.name for file in self._plan.files]
        if isinstance(former, list):
            names += [
                former_name
                for former_name in former
                if isinstance(former_name, str) and is_incident_file_name(former_name)
            ]
        remove(self.path, dict.fromkeys((*names, STATE_NAME)))


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
