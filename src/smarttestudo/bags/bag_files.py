# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which storage files a path stands for."""

from __future__ import annotations

import filecmp
import os
import re
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from smarttestudo.bags import magic
from smarttestudo.bags.metadata import BagMetadata, read_metadata, require_known_formats
from smarttestudo.bags.metadata_text import METADATA_NAME
from smarttestudo.bags.remote_path import is_remote
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Storage
from smarttestudo.domain.units import counted
from smarttestudo.files.input_file import require_file

_SUFFIXES = (".db3", ".mcap")
_ROS1_MAGIC = b"#ROSBAG V"
ROS1_SUFFIX = ".bag"
_MAGIC_BYTES = 16
_CONTINUED = " - "
"""An entry that is indented further than the one before goes on with its text, as YAML has it."""
_SPLIT = re.compile(r"(.*_)(0|[1-9]\d{0,3})(\.(?:db3|mcap)(?:\.zstd)?)", re.IGNORECASE)
"""rosbag2 counts the files of a recording from 0 on."""
_MOST_NAMED = 3
_EXPECTED = "give a rosbag2 folder, a .db3 or an .mcap file"


@dataclass(frozen=True, slots=True, kw_only=True)
class BagFiles:
    """The storage files of a bag, those that are gone, what its metadata says, and what is odd about it.

    ``names`` are those of ``paths`` in the metadata, empty where there are none.
    """

    paths: tuple[Path, ...]
    metadata: BagMetadata
    names: tuple[str, ...] = ()
    missing: tuple[Path, ...] = ()
    notices: tuple[str, ...] = ()


def find_bag_files(path: Path) -> BagFiles:
    """The files of the bag at ``path``, a rosbag2 folder or a single storage file.

    Raises ``RecordingError`` where there is none.
    """
    try:
        if path.is_dir():
            return _in_folder(path)
        require_bag_file(path)
    except FileNotFoundError as error:
        raise RecordingError("no such file or folder", place=str(path), remedy=_EXPECTED) from error
    except OSError as error:
        cause = f"cannot be read: {error.strerror}"
        raise RecordingError(cause, place=str(path), remedy="check the path and its permissions") from error
    return BagFiles(paths=(path,), metadata=BagMetadata())


def is_of_recording(path: Path) -> bool:
    """Whether ``path`` has the name of a recording's metadata or of a storage file."""
    return path.name == METADATA_NAME or _has_storage_name(path)


def require_bag_file(path: Path) -> Storage | None:
    """The storage that ``path`` begins as, whatever its name is; ``None`` for a packed one.

    Raises ``RecordingError`` for another file, and ``OSError``.
    """
    require_file(path)
    with path.open("rb") as file:
        start = file.read(_MAGIC_BYTES)
    if not start:
        raise RecordingError("the file is empty", place=str(path), remedy=_EXPECTED)
    if start.startswith(_ROS1_MAGIC):
        raise ros1_refusal(path)
    if start.startswith(magic.MCAP):
        return Storage.MCAP
    if start.startswith(magic.SQLITE):
        return Storage.SQLITE3
    if start.startswith(magic.ZSTD) and is_packed(path):
        return None
    cause = "not a recording: unknown file header"
    if not _has_storage_name(path):
        cause = f"unknown storage {path.suffix!r}" if path.suffix else "unknown storage"
    raise RecordingError(cause, place=str(path), remedy=_EXPECTED)


def ros1_refusal(path: Path) -> RecordingError:
    """Why the bag of ROS 1 at ``path`` is not read, and the command that converts it."""
    remedy = f"convert it: rosbags-convert --src {path.name} --dst {path.stem}"
    return RecordingError("a ROS 1 bag, not a rosbag2", place=str(path), remedy=remedy)


def is_packed(path: Path) -> bool:
    """Whether ``path`` is a whole storage file compressed with Zstandard."""
    return path.suffix.lower() == magic.ZSTD_SUFFIX


def _has_storage_name(path: Path) -> bool:
    return _storage_suffix(path) in _SUFFIXES


def _storage_suffix(path: Path) -> str:
    return (path.with_suffix("") if is_packed(path) else path).suffix.lower()


def _in_folder(folder: Path) -> BagFiles:
    try:
        metadata = read_metadata(folder)
    except RecordingError as error:
        paths, doubled = _once(_storage_files(folder))
        missing = tuple(_missing_splits(paths))
        notice = f"{folder}: {error.cause}; the files in the folder were read instead"
        gaps = (f"{path}: missing, by the numbers of the other files" for path in missing[:_MOST_NAMED])
        more = missing[_MOST_NAMED:] and [
            f"{folder}: {counted(len(missing), 'file')} missing, by their numbers"
        ]
        notices = (notice, *doubled, *gaps, *more)
        return BagFiles(paths=paths, metadata=BagMetadata(), missing=missing, notices=notices)
    require_known_formats(metadata, folder)
    present, missing, doubled = _named_files(folder, metadata.file_names)
    # Paths behind a URL are equal only as texts.
    named = set(map(str, present.values()))
    others = (
        f"{path}: not read, as the metadata do not name it"
        for path in sorted(folder.iterdir())
        if named and str(path) not in named and _has_storage_name(path)
    )
    paths, same = _once(present.values() or _storage_files(folder))
    kept = set(map(str, paths))
    lost = (f"{path}: missing, but named in the metadata" for path in missing)
    return BagFiles(
        paths=paths,
        names=tuple(name for name, path in present.items() if str(path) in kept),
        missing=missing,
        metadata=metadata,
        notices=(*(f"{folder}: {notice}" for notice in metadata.notices), *doubled, *same, *lost, *others),
    )


def _named_files(
    folder: Path, names: Iterable[str]
) -> tuple[dict[str, Path], tuple[Path, ...], tuple[str, ...]]:
    """The files that metadata in ``folder`` name, the places of those that are missing, and notices."""
    present: dict[str, Path] = {}
    taken: set[str] = set()
    missing: list[Path] = []
    doubled: list[str] = []
    to_find = deque(dict.fromkeys(names))
    while to_find:
        name = to_find.popleft()
        places = [one for one in _places(folder, name) if str(one) not in taken]
        place = next((one for is_there in (Path.is_file, _is_there) for one in places if is_there(one)), None)
        if str(_joined(folder, name.replace("\\", "/"))) in taken:
            doubled.append(f"{folder / name}: named twice in the metadata, and read once")
        elif place is not None:
            present[name] = place
            taken.add(str(place))
        elif _CONTINUED in name:
            to_find.extendleft(reversed(name.split(_CONTINUED)))
        else:
            missing.append(folder / name)
    return present, tuple(missing), tuple(doubled)


def _is_there(path: Path) -> bool:
    """Whether there is something at ``path``, of which opening it tells why it is no file."""
    return not is_remote(path) and os.path.lexists(path)


def _once(paths: Iterable[Path]) -> tuple[tuple[Path, ...], tuple[str, ...]]:
    """``paths`` without those that are the file of an earlier one, or a copy of it, and notices of these."""
    by_size: dict[int, list[Path]] = {}
    kept: list[Path] = []
    notices: list[str] = []
    for path in paths:
        alike: list[Path] = []
        with suppress(OSError):
            alike = (
                by_size.setdefault(path.stat().st_size, []) if path.is_file() and not is_remote(path) else []
            )
        same = next((known for known in alike if filecmp.cmp(known, path, shallow=False)), None)
        if same is None:
            kept.append(path)
            alike.append(path)
        else:
            notices.append(f"{path}: the same file as {same.name}, and read once")
    return tuple(kept), tuple(notices)


def _missing_splits(paths: Iterable[Path]) -> Iterator[Path]:
    """Files of which the numbers of the others tell: ``a_1.mcap`` between ``a_0.mcap`` and ``a_2.mcap``."""
    found: dict[tuple[str, str], dict[int, Path]] = {}
    for path in paths:
        if named := _SPLIT.fullmatch(path.name):
            found.setdefault((named[1], named[3]), {})[int(named[2])] = path
    for (prefix, suffix), numbered in found.items():
        first, *others = sorted(numbered)
        # A number that is no less than their count, as a year, says nothing of what was before.
        start = 0 if first < len(numbered) else first
        for number in range(start, max(others, default=start)):
            if number not in numbered:
                yield numbered[first].with_name(f"{prefix}{number}{suffix}")


def _places(folder: Path, name: str) -> Iterator[Path]:
    """Where the file that the metadata in ``folder`` call ``name`` may be, the likeliest place first."""
    plain = name.replace("\\", "/")
    # Up to version 3, names began with the bag's folder, which may have another name by now.
    places = (
        _joined(folder, name),
        _joined(folder, plain),
        folder / PurePosixPath(plain).name,
        _joined(folder.parent, plain),
    )
    yield from places
    for place in places:
        # It was packed or unpacked since.
        yield place.with_suffix("") if is_packed(place) else place.with_name(place.name + magic.ZSTD_SUFFIX)


def _joined(folder: Path, name: str) -> Path:
    if not is_remote(folder):
        return folder / name
    for part in PurePosixPath(name).parts:
        folder = folder.parent if part == ".." else folder / part
    return folder


def _storage_files(folder: Path) -> tuple[Path, ...]:
    """The storage files in ``folder``; of a file and its packed copy, the file."""
    files = sorted(
        path for path in folder.iterdir() if path.is_file() or (_is_there(path) and not path.is_dir())
    )
    found = [path for path in files if _has_storage_name(path)]
    paths = tuple(path for path in found if not (is_packed(path) and path.with_suffix("") in found))
    if not paths:
        for path in files:
            if path.suffix == ROS1_SUFFIX and path.is_file():
                # Files of ROS 1 are refused with the command that converts them.
                require_bag_file(path)
        raise RecordingError("the folder holds no .db3 or .mcap file", place=str(folder), remedy=_EXPECTED)
    if len(set(map(_storage_suffix, paths))) > 1:
        cause = "the folder holds .db3 and .mcap files, and no metadata name those of the recording"
        raise RecordingError(cause, place=str(folder), remedy="name one of the files")
    return paths
