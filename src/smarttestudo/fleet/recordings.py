# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings that a text on a command line names: one, those in a folder, or those that match a pattern."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from glob import glob, has_magic
from pathlib import Path

from smarttestudo.bags.bag_files import is_recording
from smarttestudo.domain.errors import RecordingError

_WILDCARD = re.compile(r"[*?]|\[[^]]*\]?")


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundRecording:
    """The place of a recording; ``key`` is what a folder or a pattern left open, "" where it names one."""

    path: Path
    key: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingPair:
    """A recording with what the operator received of it."""

    a: Path
    b: Path


def find_recordings(text: str) -> tuple[FoundRecording, ...]:
    """The recordings that ``text`` names, by name.

    A folder that is no recording itself stands for all in it, at any depth. A pattern has ``*``, ``?``,
    ``[…]``, and ``**`` for any depth. What leads to no recording is named as if it was one, so that opening
    it says why.
    """
    if has_magic(text) and not os.path.lexists(text):
        matches = sorted(glob(text, recursive=True))  # noqa: PTH207  pathlib has no patterns with a root
        first, *_, last = _WILDCARD.split(text)
        found = [
            FoundRecording(path=path, key=str(path).removeprefix(first).removesuffix(last))
            for match in matches
            for path in _recordings_at(Path(match))
        ]
    else:
        top = Path(text)
        found = [
            FoundRecording(path=path, key="" if path == top else str(path.relative_to(top)))
            for path in _recordings_at(top)
        ]
    return tuple(found) or (FoundRecording(path=Path(text)),)


def pair_recordings(a: str, b: str) -> tuple[RecordingPair | RecordingError, ...]:
    """Each recording that ``a`` names with the one of ``b`` of the same name in its folder or pattern.

    One without a partner is an error in its place.
    """
    first, second = find_recordings(a), find_recordings(b)
    if len(first) == len(second) == 1:
        return (RecordingPair(a=first[0].path, b=second[0].path),)
    partners = _by_key(second)
    pairs: list[RecordingPair | RecordingError] = []
    for one in first:
        partner = partners.pop(one.key, None)
        pairs.append(_alone(one, b) if partner is None else RecordingPair(a=one.path, b=partner.path))
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
    """``path`` itself, or, where it is a folder that is none, the recordings in it."""
    below = [] if is_recording(path) else [*_recordings_below(path)]
    yield from below or [path]


def _recordings_below(folder: Path) -> Iterator[Path]:
    """The recordings in ``folder``; a link to another folder is one at most, so that no circle is walked."""
    for name in _folders_in(folder):
        path = folder / name
        if is_recording(path):
            yield path
        elif not path.is_symlink():
            yield from _recordings_below(path)


def _folders_in(folder: Path) -> Sequence[str]:
    """Names of the folders in ``folder``; none where there is no folder that can be listed."""
    try:
        with os.scandir(folder) as entries:
            return sorted(entry.name for entry in entries if entry.is_dir())
    except OSError:
        return ()
