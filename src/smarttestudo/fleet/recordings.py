# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings that a text on a command line names: one, those in a folder, or those that match a pattern."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from glob import glob, has_magic
from pathlib import Path

from smarttestudo.bags.bag_files import is_recording
from smarttestudo.bags.metadata_text import METADATA_NAME
from smarttestudo.bags.remote_path import DEFAULT_TIMEOUT_S, is_url, remote_matches, remote_path
from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.errors import RecordingError

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


def find_recordings(text: str, *, timeout_s: float = DEFAULT_TIMEOUT_S) -> tuple[FoundRecording, ...]:
    """The recordings that ``text``, a path or a URL, names, by name.

    A folder that is no recording itself stands for all in it, at any depth. A pattern has ``*``, ``?``,
    ``[…]``, and ``**`` for any depth. What leads to no recording is named as if it was one, so that opening
    it says why. A server has ``timeout_s`` for an answer.
    """
    top = remote_path(text, timeout_s) if is_url(text) else Path(text)
    try:
        found = _matching(text, top) if _is_pattern(text) else _below(top)
    except OSError:
        found = []
    return tuple(found) or (FoundRecording(path=top),)


def _is_pattern(text: str) -> bool:
    return has_magic(text) and (is_url(text) or not os.path.lexists(text))


def _matching(text: str, top: Path) -> list[FoundRecording]:
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
        for path in _recordings_at(match)
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


def _below(top: Path) -> list[FoundRecording]:
    return [
        FoundRecording(path=path)
        if path == top
        else FoundRecording(
            path=path,
            key=str(path.relative_to(top)),
            robot=_robot(str(path), len(str(path)) - len(str(path.relative_to(top)))),
        )
        for path in _recordings_at(top)
    ]


def _robot(path: str, opened: int) -> str:
    """The folder in ``path`` in whose name the place ``opened`` is; "" where that is the recording."""
    start = path.rfind("/", 0, opened) + 1
    end = path.find("/", opened)
    return path[start:end] if end >= 0 else ""


def pair_recordings(
    a: str, b: str, *, timeout_s: float = DEFAULT_TIMEOUT_S
) -> tuple[RecordingPair | RecordingError, ...]:
    """Pair each recording that ``a`` names with the one of ``b`` that has its name in the folder or pattern.

    One without a partner is an error in its place.
    """
    first, second = (find_recordings(text, timeout_s=timeout_s) for text in (a, b))
    if len(first) == len(second) == 1:
        return (RecordingPair(a=first[0].path, b=second[0].path),)
    partners = _by_key(second)
    pairs: list[RecordingPair | RecordingError] = []
    for one in first:
        partner = partners.pop(one.key, None)
        pairs.append(
            _alone(one, b)
            if partner is None
            else RecordingPair(a=one.path, b=partner.path, key=one.key, robot=one.robot)
        )
    return (*pairs, *(_alone(one, a) for one in partners.values()))


def _by_key(found: Sequence[FoundRecording]) -> dict[str, FoundRecording]:
    return {one.key: one for one in found}


def _alone(one: FoundRecording, other: str) -> RecordingError:
    return RecordingError(
        f"{other} has no recording {one.key or one.path.name}",
        place=str(one.path),
        remedy="recordings are paired by their names below the folder, or by what the pattern leaves open",
    )


def _recordings_at(path: Path) -> Iterator[Path]:
    """The recordings in ``path``; itself where there is none, so that opening it says why."""
    yield from [*_recordings_in(path)] or [path]


def _recordings_in(folder: Path) -> Iterator[Path]:
    """``folder``, if it is a recording, and those in it; a whole rosbag2 holds no other.

    A link to another folder is one at most, so that no circle is walked.
    """
    if is_recording(folder):
        yield folder
        if (folder / METADATA_NAME).exists():
            return
    for path in _folders_in(folder):
        if not path.is_symlink():
            yield from _recordings_in(path)
        elif is_recording(path):
            yield path


def _folders_in(folder: Path) -> Sequence[Path]:
    """The folders in ``folder``; none where there is no folder that can be listed."""
    try:
        return sorted(entry for entry in folder.iterdir() if entry.is_dir())
    except OSError:
        return ()
