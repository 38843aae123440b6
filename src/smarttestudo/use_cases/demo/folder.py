# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The folder that a demo leaves: whole or not there, and in place of nothing but what a former demo made."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.units import grouped

MARKER = "demo.json"


class DemoFolderError(TestudoError):
    """The demo's folder cannot be made or may not be replaced."""


@contextmanager
def demo_folder(out: Path, *, needed_bytes: int, made: Collection[str]) -> Iterator[Path]:
    """A new folder next to ``out`` that takes its place when the block ends well, and is removed when not.

    The block must write ``MARKER``, by which a later demo knows that it may replace ``out``. Whatever lies in
    a former demo's folder beside the names in ``made`` moves along.

    Raises:
        DemoFolderError: ``out`` is something else than a former demo's folder, cannot be written, or the
            disk has less than ``needed_bytes`` left.
    """
    out = Path(os.path.realpath(out))
    _refuse_foreign(out)
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        _refuse_small_disk(out.parent, needed_bytes)
        workshop = Path(tempfile.mkdtemp(prefix=f".{out.name}-", suffix=".partial", dir=out.parent))
    except OSError as error:
        raise _not_written(out, error) from error
    try:
        # mkdtemp makes folders for the user alone; what the demo leaves is as open as its other files.
        work = workshop / out.name
        work.mkdir()
        yield work
        _replace(out, work, made)
    except OSError as error:
        raise _not_written(out, error) from error
    finally:
        shutil.rmtree(workshop, ignore_errors=True)


def _refuse_foreign(out: Path) -> None:
    try:
        empty = out.is_dir() and not any(out.iterdir())
        replaceable = empty or not os.path.lexists(out) or (out / MARKER).is_file()
    except OSError as error:
        raise _not_written(out, error) from error
    if not replaceable:
        raise DemoFolderError(
            "exists and was not made by 'testudo demo'",
            place=str(out),
            remedy="name another folder with --out",
        )


def _refuse_small_disk(parent: Path, needed_bytes: int) -> None:
    free_bytes = shutil.disk_usage(parent).free
    if free_bytes < needed_bytes:
        needed, free = grouped(needed_bytes / 1e6), grouped(free_bytes / 1e6)
        raise DemoFolderError(
            f"the demo needs {needed} MB and the disk has {free} MB left",
            place=str(parent),
            remedy="take fewer --seconds, another --out, or leave out --full-images",
        )


def _replace(out: Path, work: Path, made: Collection[str]) -> None:
    """Put ``work`` where ``out`` was, with all of it that is not ``made``; or leave ``out`` as it was."""
    former = work.parent / "former"
    foreign = [one.name for one in out.iterdir() if one.name not in made] if out.exists() else []
    moved: list[str] = []
    try:
        for name in foreign:
            (out / name).rename(work / name)
            moved.append(name)
        if out.exists():
            out.rename(former)
        work.rename(out)
    except BaseException:
        if former.exists():
            former.rename(out)
        for name in moved:
            (work / name).rename(out / name)
        raise


def _not_written(out: Path, error: OSError) -> DemoFolderError:
    culprit = "" if error.filename in (None, str(out)) else f" ({error.filename})"
    return DemoFolderError(
        f"cannot be written: {error.strerror or error}{culprit}",
        place=str(out),
        remedy="name another folder with --out",
    )
