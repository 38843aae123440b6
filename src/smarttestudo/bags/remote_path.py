# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Files behind a URL, read by ranges: the only importer of ``fsspec``."""

from __future__ import annotations

import io
import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Any, BinaryIO, TypeVar, cast

from smarttestudo.domain.errors import RecordingError

DEFAULT_TIMEOUT_S = 60.0
_LEAST_BYTES = 1 << 14
"""Bytes fetched at once where records are hopped over."""
_MOST_BYTES = 1 << 23
"""The same where a file is read from end to end."""
_HOP_BYTES = 1 << 19
"""Up to so many bytes take less time than another request, so they are fetched where they are hopped over."""

_T = TypeVar("_T")


def is_url(text: str) -> bool:
    """Whether ``text`` names something that fsspec opens."""
    return "://" in text


def remote_path(url: str, timeout_s: float) -> Path:
    """The place ``url`` as all that reads recordings takes it; nothing is asked yet."""
    return cast("Path", RemotePath(url, timeout_s))


def remote_matches(pattern: Path) -> list[Path]:
    """Places that the URL ``pattern`` matches, by name. Raises ``OSError``."""
    return cast("list[Path]", cast("RemotePath", pattern).matches())


class RemotePath:
    """As far as recordings need it, a ``pathlib.Path`` of a file or folder behind a URL.

    A failure is an ``OSError``, and is kept, since who reads a recording takes it for damage.
    """

    def __init__(
        self,
        url: str,
        timeout_s: float,
        *,
        found: dict[str, Any] | None = None,
        failures: list[OSError] | None = None,
    ) -> None:
        self._url = url
        self._timeout_s = timeout_s
        self._found = found
        self._failures = [] if failures is None else failures

    def __str__(self) -> str:
        return self._url

    def __lt__(self, other: RemotePath) -> bool:
        return self._url < other._url

    def __truediv__(self, name: str) -> RemotePath:
        return self._at(f"{self._url.rstrip('/')}/{name}")

    @property
    def name(self) -> str:
        return self._url.rstrip("/").rpartition("/")[2]

    @property
    def parent(self) -> RemotePath:
        return self._at(self._url.rstrip("/").rpartition("/")[0])

    @property
    def stem(self) -> str:
        return Path(self.name).stem

    @property
    def suffix(self) -> str:
        return Path(self.name).suffix

    def with_name(self, name: str) -> RemotePath:
        return self._at(f"{self._url.rstrip('/').rpartition('/')[0]}/{name}")

    def with_suffix(self, suffix: str) -> RemotePath:
        return self.with_name(Path(self.name).with_suffix(suffix).name)

    def is_absolute(self) -> bool:
        """Always: a URL means the same wherever it is read."""
        return True

    def is_symlink(self) -> bool:
        """Never: there are no links."""
        return False

    def exists(self) -> bool:
        return self.is_file() or self.is_dir()

    def is_file(self) -> bool:
        return self._kind() == "file"

    def is_dir(self) -> bool:
        return self._kind() == "directory"

    def stat(self) -> os.stat_result:
        """Kind and size; all else is 0."""
        found = self._info()
        mode = stat.S_IFDIR if found["type"] == "directory" else stat.S_IFREG
        return os.stat_result((mode, 0, 0, 0, 0, 0, found.get("size") or 0, 0, 0, 0))

    lstat = stat

    def iterdir(self) -> Iterator[RemotePath]:
        # An object store may list the folder itself.
        for found in self._call(
            lambda fs, path: [
                entry for entry in fs.ls(path, detail=True) if entry["name"].strip("/") != path.strip("/")
            ]
        ):
            name = found["name"].rstrip("/").rpartition("/")[2]
            yield self._at(f"{self._url.rstrip('/')}/{name}", found)

    def relative_to(self, folder: RemotePath) -> PurePosixPath:
        return PurePosixPath(self._url.removeprefix(folder._url).lstrip("/"))

    def matches(self) -> list[RemotePath]:
        """Places that the URL, a pattern, matches."""
        return self._call(
            lambda fs, path: [self._at(fs.unstrip_protocol(found)) for found in sorted(fs.glob(path))]
        )

    def open(self, _mode: str = "rb") -> BinaryIO:
        size_bytes = self.stat().st_size

        def fetch(start: int, end: int) -> bytes:
            return self._call(lambda fs, path: bytes(fs.cat_file(path, start=start, end=end)))

        return io.BufferedReader(_Ranges(fetch, size_bytes), _LEAST_BYTES)

    def read_bytes(self) -> bytes:
        with self.open() as file:
            return file.read()

    def read_text(self, encoding: str | None = None) -> str:
        return self.read_bytes().decode(encoding or "utf-8")

    def refuse_failures(self) -> None:
        """Raise ``RecordingError`` if something could not be fetched."""
        for error in self._failures:
            raise RecordingError(
                f"cannot be fetched: {error.strerror}",
                place=self._url,
                remedy="check the URL, the credentials and the network",
            ) from error

    def _at(self, url: str, found: dict[str, Any] | None = None) -> RemotePath:
        return RemotePath(url, self._timeout_s, found=found, failures=self._failures)

    def _kind(self) -> str:
        try:
            return str(self._info()["type"])
        except (FileNotFoundError, NotADirectoryError):
            return ""

    def _info(self) -> dict[str, Any]:
        if self._found is None:
            self._found = self._call(lambda fs, path: dict(fs.info(path)))
        return self._found

    def _call(self, ask: Callable[[Any, str], _T]) -> _T:
        """The answer of the file system to ``ask``; nobody waits for it longer than the timeout."""
        if self._failures:
            raise self._failures[0]
        answers: SimpleQueue[_T | Exception] = SimpleQueue()

        def work() -> None:
            from fsspec.core import url_to_fs  # noqa: PLC0415  most recordings are files

            try:
                answers.put(ask(*url_to_fs(self._url)))
            except Exception as error:  # noqa: BLE001 - each file system has its own
                answers.put(error)

        Thread(target=work, daemon=True).start()
        try:
            answer = answers.get(timeout=self._timeout_s)
        except Empty:
            answer = OSError(None, f"no answer for {self._timeout_s:g} s")
        if isinstance(answer, (FileNotFoundError, NotADirectoryError)):
            raise answer
        if isinstance(answer, Exception):
            cause = getattr(answer, "strerror", None) or str(answer) or type(answer).__name__
            failure = OSError(None, " ".join(cause.split()))
            self._failures.append(failure)
            raise failure from answer
        return answer


def is_remote(path: Path) -> bool:
    """Whether ``path`` is behind a URL."""
    return isinstance(cast("object", path), RemotePath)


@contextmanager
def fetched_in_full(path: Path) -> Iterator[None]:
    """Raise ``RecordingError`` if some of the recording at ``path`` could not be fetched in the block."""
    remote = cast("object", path)
    if not isinstance(remote, RemotePath):
        yield
        return
    try:
        yield
    except Exception:
        remote.refuse_failures()
        raise
    remote.refuse_failures()


class _Ranges(io.RawIOBase):
    """A file of which ``fetch`` gets the bytes from one place to before another.

    The longer it is read on, the more is fetched at once.
    """

    def __init__(self, fetch: Callable[[int, int], bytes], size_bytes: int) -> None:
        super().__init__()
        self._fetch = fetch
        self._size_bytes = size_bytes
        self._position = 0
        self._start = 0
        self._block = b""
        self._next_bytes = _LEAST_BYTES

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        origin = {io.SEEK_SET: 0, io.SEEK_CUR: self._position, io.SEEK_END: self._size_bytes}[whence]
        if origin + offset < 0:
            raise OSError(None, "before the beginning of the file")
        self._position = origin + offset
        return self._position

    def tell(self) -> int:
        return self._position

    def readinto(self, buffer: Any) -> int:
        wanted = min(len(buffer), self._size_bytes - self._position)
        if wanted <= 0:
            return 0
        if not self._start <= self._position < self._start + len(self._block):
            self._load(wanted)
        at = self._position - self._start
        piece = self._block[at : at + wanted]
        buffer[: len(piece)] = piece
        self._position += len(piece)
        return len(piece)

    def _load(self, wanted: int) -> None:
        ahead = self._position - self._start - len(self._block)
        goes_on = bool(self._block) and 0 <= ahead <= _HOP_BYTES
        self._next_bytes = min(2 * self._next_bytes, _MOST_BYTES) if goes_on else _LEAST_BYTES
        end = min(self._position + max(wanted, self._next_bytes), self._size_bytes)
        block = self._fetch(self._position, end)
        if not block:
            raise OSError(None, "the file became shorter")
        self._start, self._block = self._position, block
