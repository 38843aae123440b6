# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings that a text on a command line names: one, those in a folder, or those that match a pattern."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from glob import glob, has_magic
from pathlib import Path

from smarttestudo.bags.bag_files import ROS1_SUFFIX, is_of_recording, ros1_refusal
from smarttestudo.bags.metadata_text import METADATA_NAME
from smarttestudo.bags.remote_path import DEFAULT_TIMEOUT_S, is_url, remote_matches, remote_path
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.units import counted

_WILDCARD = re.compile(r"[*?]|\[[^]]*\]?")


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundRecording:
    """The place of a recording; ``key`` is what a folder or a pattern left open, "" where it names one.

    ``robot`` is the first folder that was left open, as ``r1`` in ``r1/monday``; "" where there is none.
    """

    path: Path
    key: str = ""
    robot: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingPair:
    """A recording with what the operator received of it; ``key`` is what both are called, as of one found."""

    a: Path
    b: Path
    key: str = ""
    robot: str = ""


def find_recordings(
    text: str, *, timeout_s: float = DEFAULT_TIMEOUT_S, noticed: Callable[[str], None] | None = None
) -> tuple[FoundRecording, ...]:
    """The recordings that ``text``, a path or a URL, names, by name.

    A folder that is no recording itself stands for all in it, at any depth. A pattern has ``*``, ``?``,
    ``[…]``, and ``**`` for any depth. What leads to no recording is named as if it was one, so that opening
    it says why. A server has ``timeout_s`` for an answer. ``noticed`` gets what is left out.
    """
    walk = _Walk()
    top = remote_path(text, timeout_s) if is_url(text) else Path(text)
    try:
        found = _matching(text, top, walk) if _is_pattern(text) else _below(top, walk)
    except OSError:
        found = []
    if noticed is not None:
        for notice in walk.notices():
            noticed(f"{text}: {notice}")
    return tuple(found) or (FoundRecording(path=top),)


def _is_pattern(text: str) -> bool:
    return has_magic(text) and (is_url(text) or not os.path.lexists(text))


def _matching(text: str, top: Path, walk: _Walk) -> list[FoundRecording]:
    """Recordings that the pattern ``text`` matches, or that are in folders that it matches."""
    first, *_, last = _WILDCARD.split(str(top))
    matches = remote_matches(top) if is_url(text) else map(Path, sorted(glob(text, recursive=True)))  # noqa: PTH207  pathlib has no patterns with a root
    return [
        FoundRecording(
            path=path,
            key=str(path).removeprefix(first).removesuffix(last),
            robot=_robot(str(path), len(first)),
        )
        for match in _outermost(matches)
        for path in walk.recordings_at(match)
    ]


def _outermost(matches: Iterable[Path]) -> Iterator[Path]:
    """``matches``, sorted, without what lies in a folder that is one: ``**`` gives a folder and all in it."""
    known: set[str] = set()
    for match in matches:
        names = str(match).rstrip("/").split("/")
        folders = {"/".join(names[:end]) for end in range(1, len(names) + 1)}
        if known.isdisjoint(folders):
            known.add("/".join(names))
            yield match


def _below(top: Path, walk: _Walk) -> list[FoundRecording]:
    return [
        FoundRecording(path=path)
        if path == top
        else FoundRecording(
            path=path,
            key=str(path.relative_to(top)),
            robot=_robot(str(path), len(str(path)) - len(str(path.relative_to(top)))),
        )
        for path in walk.recordings_at(top)
    ]


def _robot(path: str, opened: int) -> str:
    """The folder in ``path`` in whose name the place ``opened`` is; "" where that is the recording."""
    start = path.rfind("/", 0, opened) + 1
    end = path.find("/", opened)
    return path[start:end] if end >= 0 else ""


def pair_recordings(
    a: str, b: str, *, timeout_s: float = DEFAULT_TIMEOUT_S, noticed: Callable[[str], None] | None = None
) -> tuple[RecordingPair | RecordingError, ...]:
    """Pair each recording that ``a`` names with the one of ``b`` that has its name in the folder or pattern.

    A recording without a partner is an error in its place. ``noticed`` gets what is left out.
    """
    first, second = (find_recordings(text, timeout_s=timeout_s, noticed=noticed) for text in (a, b))
    if len(first) == len(second) == 1:
        return (RecordingPair(a=first[0].path, b=second[0].path),)
    partners = _by_key(second)
    pairs: list[RecordingPair | RecordingError] = []
    for recording in first:
        partner = partners.pop(recording.key, None)
        pairs.append(
            _alone(recording, b)
            if partner is None
            else RecordingPair(a=recording.path, b=partner.path, key=recording.key, robot=recording.robot)
        )
    return (*pairs, *(_alone(recording, a) for recording in partners.values()))


def _by_key(found: Sequence[FoundRecording]) -> dict[str, FoundRecording]:
    return {recording.key: recording for recording in found}


def _alone(recording: FoundRecording, other: str) -> RecordingError:
    return RecordingError(
        f"{other} has no recording {recording.key or recording.path.name}",
        place=str(recording.path),
        remedy="recordings are paired by their names below the folder, or by what the pattern leaves open",
    )


class _Walk:
    """A walk through folders that finds recordings, and notes what it leaves out."""

    def __init__(self) -> None:
        self._ros1_bags: list[tuple[Path, Path]] = []
        self._unread: list[tuple[Path, OSError]] = []

    def recordings_at(self, path: Path) -> Sequence[Path]:
        """The recordings in ``path``; itself where there is none, so that opening it says why."""
        if found := [*self._recordings_in(path)]:
            return found
        self._ros1_bags = [(folder, bag) for folder, bag in self._ros1_bags if folder is not path]
        self._unread = [(folder, error) for folder, error in self._unread if folder is not path]
        return [path]

    def notices(self) -> Iterator[str]:
        """Notices of all that was left out, a line for each kind."""
        if self._ros1_bags:
            bags = [bag for _, bag in self._ros1_bags]
            are = "is" if len(bags) == 1 else "are"
            yield f"{_counted(bags, 'ROS 1 bag')} {are} left out; {ros1_refusal(bags[0]).remedy}"
        if self._unread:
            folders, errors = zip(*self._unread, strict=True)
            yield f"{_counted(folders, 'folder')} cannot be read: {errors[0].strerror}"

    def _recordings_in(self, folder: Path, *, is_link: bool = False) -> Iterator[Path]:
        """``folder``, if it is a recording, and those in it; a whole rosbag2 holds no other.

        A link to another folder is one at most, so that no circle is walked.
        """
        entries, folders = self._listed(folder)
        if is_recording := any(map(is_of_recording, entries)):
            yield folder
        if is_link or (is_recording and (folder / METADATA_NAME).exists()):
            return
        names = {path.name for path in folders}
        self._ros1_bags += (
            # What its conversion made of it is beside it.
            (folder, entry)
            for entry in entries
            if entry.suffix == ROS1_SUFFIX and names.isdisjoint((entry.name, entry.stem))
        )
        for path in folders:
            yield from self._recordings_in(path, is_link=path.is_symlink())

    def _listed(self, folder: Path) -> tuple[Sequence[Path], Sequence[Path]]:
        """Entries of ``folder``, and the folders among them; none where there is no folder."""
        try:
            entries = sorted(folder.iterdir())
            return entries, [entry for entry in entries if entry.is_dir()]
        except (FileNotFoundError, NotADirectoryError):
            pass
        except OSError as error:
            self._unread.append((folder, error))
        return (), ()


def _counted(paths: Sequence[Path], word: str) -> str:
    """How many ``paths`` there are, and the first of them."""
    return f"{counted(len(paths), word)} ({'' if len(paths) == 1 else 'first '}{paths[0]})"
