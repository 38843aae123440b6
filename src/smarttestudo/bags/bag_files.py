# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which storage files a path stands for."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from smarttestudo.bags import magic
from smarttestudo.bags.metadata import BagMetadata, read_metadata, require_known_formats
from smarttestudo.bags.metadata_text import METADATA_NAME
from smarttestudo.bags.remote_path import is_remote
from smarttestudo.domain.errors import RecordingError
from smarttestudo.files.input_file import require_file

_MAGIC_BY_SUFFIX = {".db3": magic.SQLITE, ".mcap": magic.MCAP}
_ROS1_MAGIC = b"#ROSBAG V"
ROS1_SUFFIX = ".bag"
_MAGIC_BYTES = 16
_CONTINUED = " - "
"""An entry that is indented further than the one before goes on with its text, as YAML has it."""
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
    return path.name == METADATA_NAME or _expected_magic(path) is not None


def require_bag_file(path: Path) -> None:
    """Raise ``RecordingError`` unless ``path`` begins as a storage file of its suffix must."""
    require_file(path)
    with path.open("rb") as file:
        magic = file.read(_MAGIC_BYTES)
    if not magic:
        raise RecordingError("the file is empty", place=str(path), remedy=_EXPECTED)
    if magic.startswith(_ROS1_MAGIC):
        raise ros1_refusal(path)
    expected = _expected_magic(path)
    if expected is None:
        cause = f"unknown storage {path.suffix!r}" if path.suffix else "unknown storage"
        raise RecordingError(cause, place=str(path), remedy=_EXPECTED)
    if not magic.startswith(expected):
        raise RecordingError("not a recording: unknown file header", place=str(path), remedy=_EXPECTED)


def ros1_refusal(path: Path) -> RecordingError:
    """Why the bag of ROS 1 at ``path`` is not read, and the command that converts it."""
    remedy = f"convert it: rosbags-convert --src {path.name} --dst {path.stem}"
    return RecordingError("a ROS 1 bag, not a rosbag2", place=str(path), remedy=remedy)


def is_packed(path: Path) -> bool:
    """Whether ``path`` is a whole storage file compressed with Zstandard."""
    return path.suffix == magic.ZSTD_SUFFIX


def _expected_magic(path: Path) -> bytes | None:
    if is_packed(path):
        return magic.ZSTD if path.with_suffix("").suffix in _MAGIC_BY_SUFFIX else None
    return _MAGIC_BY_SUFFIX.get(path.suffix)


def _in_folder(folder: Path) -> BagFiles:
    try:
        metadata = read_metadata(folder)
    except RecordingError as error:
        paths = _storage_files(folder)
        notice = f"{folder}: {error.cause}; the files in the folder were read instead"
        return BagFiles(paths=paths, metadata=BagMetadata(), notices=(notice,))
    require_known_formats(metadata, folder)
    present, missing = _named_files(folder, metadata.file_names)
    lost = (f"{path}: missing, but named in the metadata" for path in missing)
    # Paths behind a URL are equal only as texts.
    named = set(map(str, present.values()))
    others = (
        f"{path}: not read, as the metadata do not name it"
        for path in sorted(folder.iterdir())
        if named and str(path) not in named and _expected_magic(path) is not None
    )
    return BagFiles(
        paths=tuple(present.values()) or _storage_files(folder),
        names=tuple(present),
        missing=missing,
        metadata=metadata,
        notices=(*(f"{folder}: {notice}" for notice in metadata.notices), *lost, *others),
    )


def _named_files(folder: Path, names: Iterable[str]) -> tuple[dict[str, Path], tuple[Path, ...]]:
    """The files that metadata in ``folder`` name, and the places of those that are missing."""
    present: dict[str, Path] = {}
    taken: set[str] = set()
    missing: list[Path] = []
    to_find = deque(dict.fromkeys(names))
    while to_find:
        name = to_find.popleft()
        places = (one for one in _places(folder, name) if str(one) not in taken and one.is_file())
        place = next(places, None)
        if place is not None:
            present[name] = place
            taken.add(str(place))
        elif _CONTINUED in name:
            to_find.extendleft(reversed(name.split(_CONTINUED)))
        else:
            missing.append(folder / name)
    return present, tuple(missing)


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
    files = sorted(path for path in folder.iterdir() if path.is_file())
    found = [path for path in files if _expected_magic(path) is not None]
    paths = tuple(path for path in found if not (is_packed(path) and path.with_suffix("") in found))
    if not paths:
        for path in files:
            if path.suffix == ROS1_SUFFIX:
                # Those of ROS 1 are refused with the command that converts them.
                require_bag_file(path)
        raise RecordingError("the folder holds no .db3 or .mcap file", place=str(folder), remedy=_EXPECTED)
    storages = {path.with_suffix("").suffix if is_packed(path) else path.suffix for path in paths}
    if len(storages) > 1:
        cause = "the folder holds .db3 and .mcap files, and no metadata name those of the recording"
        raise RecordingError(cause, place=str(folder), remedy="name one of the files")
    return paths
